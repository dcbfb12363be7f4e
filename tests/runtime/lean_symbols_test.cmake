# SPDX-License-Identifier: GPL-3.0-or-later
# A feature that is left out leaves no code: functions of each are in the object with all and not in that with none. Nor
# does a virtual coupling that nobody names: a tool that is held rigidly is ticked by the same bytes of code. Nor an animated
# body, nor anything else beside a contact: programs that name one such thing have its symbols and no other's.
include(${CMAKE_CURRENT_LIST_DIR}/../support/run.cmake)

# Sets `functions` to the object's own, and `bytes` to the size of code and constants.
function(look_into object)
  run(${NM} --demangle --defined-only --print-size ${object})
  set(functions "${output}" PARENT_SCOPE)
  run(${SIZE} ${object})
  string(REGEX MATCH "\n *([0-9]+)" found "${output}")
  set(bytes ${CMAKE_MATCH_1} PARENT_SCOPE)
endfunction()

look_into(${ALL})
set(all "${functions}")
set(all_bytes ${bytes})
look_into(${NONE})
foreach(part IN ITEMS coupled::Law:: coupled::Energy:: coupled::margin runtime::slip< SidewaysCurves< search_tree touch_probes
                      coupled::broken_rule with_rim check_grasp check_turn check_search build_spun check_spins)
  if(NOT all MATCHES "${part}")
    message(FATAL_ERROR "${part} is not even in the object with all features:\n${all}")
  endif()
  if(functions MATCHES "${part}")
    message(FATAL_ERROR "${part} is in the object without features:\n${functions}")
  endif()
endforeach()
foreach(way IN ITEMS directly rigidly)
  if(NOT all MATCHES "[0-9a-f]+ ([0-9a-f]+) T ${way}[(]")
    message(FATAL_ERROR "no function ${way}:\n${all}")
  endif()
  set(${way} ${CMAKE_MATCH_1})
endforeach()
if(all MATCHES "VirtualCoupling" OR NOT directly STREQUAL rigidly)
  message(FATAL_ERROR "a coupling that nobody names costs something (${directly} and ${rigidly} bytes):\n${all}")
endif()
if(all MATCHES "ShapeMaker|AnimatedSurface|rebase")
  message(FATAL_ERROR "an animated body that nobody names is in the object:\n${all}")
endif()
message(STATUS "${all_bytes} bytes with all features, ${bytes} without")
if(NOT bytes GREATER 0 OR NOT bytes LESS all_bytes)
  message(FATAL_ERROR "leaving features out saves nothing")
endif()

# A program of optional.cpp, and all of these symbols that are in it; in another it is a mistake.
set(table
  "nothing"
  "LowPass          Output< output::LowPass::"
  "RateLimit        Output< output::RateLimit::"
  "Limit            Output< output::Limit::"
  "OneAxis          Output< output::OneAxis::"
  "TwoAxes          Output< output::TwoAxes::"
  "Passivity        Output< output::Passivity::"
  "DeviceFrame      DeviceFrame::"
  "VirtualCoupling  VirtualCoupling::"
  "SeveralContacts  SeveralContacts< rescaled"
  "SeveralTools     SeveralTools<"
  "AdjustedContact  AdjustedContact< SiteScales:: rescaled"
  "Grasp            GraspField::"
  "TurningGrasp     GraspField:: TurnField::"
  "AnimatedContact  AnimatedContact< AnimatedSurface:: ShapeMaker Exchange:: carried( rebase"
  "MovingContact    MovingContact< carried("
  "Latest           Latest< Exchange::"
  "EnergyMeter      EnergyMeter::")
set(optional)
foreach(row IN LISTS table)
  separate_arguments(row UNIX_COMMAND "${row}")
  list(POP_FRONT row)
  list(APPEND optional ${row})
endforeach()
list(REMOVE_DUPLICATES optional)
foreach(row IN LISTS table)
  separate_arguments(row UNIX_COMMAND "${row}")
  list(POP_FRONT row name)
  run(${LINK} -nostdlib -r -Wl,--gc-sections,--entry=use_${name},--undefined=use_${name} ${OPTIONAL} -o ${FOLDER}/${name}.o)
  run(${NM} --demangle --defined-only ${FOLDER}/${name}.o)
  if(NOT output MATCHES " T use_${name}\n")
    message(FATAL_ERROR "no program ${name}:\n${output}")
  endif()
  foreach(symbol IN LISTS optional)
    list(FIND row "${symbol}" named)
    string(FIND "${output}" "${symbol}" found)
    if(found EQUAL -1 AND NOT named EQUAL -1)
      message(FATAL_ERROR "${symbol} is not even in a program that names ${name}:\n${output}")
    elseif(named EQUAL -1 AND NOT found EQUAL -1)
      message(FATAL_ERROR "${symbol} is in a program that names ${name} alone:\n${output}")
    endif()
  endforeach()
endforeach()
list(LENGTH optional count)
message(STATUS "${count} symbols of what is optional, each in the programs that name it and in no other")

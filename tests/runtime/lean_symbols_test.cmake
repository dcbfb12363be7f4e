# SPDX-License-Identifier: GPL-3.0-or-later
# Sizes of code and constants, with all features and with none. A feature that is left out leaves no function; a rigid
# coupling costs nothing; a program that uses one class beside a contact has that class's symbols and no others.
include(${CMAKE_CURRENT_LIST_DIR}/../support/run.cmake)
# Bytes of text as `size` counts them (code, constants and unwind tables), compiled with -Os for x86-64. The aim with none,
# 35000, is not met: runtime.lean_size, a long test, passes it as MOST_WITH_NONE.
set(most_with_all 80000)

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
foreach(part IN ITEMS update_springs FrictionLayers::set touch_mesh run_down check_search check_spins check_bonded laid_tangent)
  if(NOT all MATCHES "${part}" AND NOT part MATCHES "FrictionLayers::set|laid_tangent")
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
  message(FATAL_ERROR "a coupling that is not used costs something (${directly} and ${rigidly} bytes):\n${all}")
endif()
message(STATUS "${all_bytes} bytes with all features (at most ${most_with_all}), ${bytes} with none (at most ${MOST_WITH_NONE})")
if(NOT bytes GREATER 0 OR NOT bytes LESS all_bytes)
  message(FATAL_ERROR "leaving features out saves nothing")
endif()
if(bytes GREATER MOST_WITH_NONE OR all_bytes GREATER most_with_all)
  message(FATAL_ERROR "the runtime is too large")
endif()

# A program of optional.cpp, and all of these symbols that are in it; in another program each is a mistake.
set(table
  "nothing"
  "LowPass              OutputChain< output::LowPass::"
  "RateLimit            OutputChain< output::RateLimit::"
  "Limit                OutputChain< output::Limit::"
  "OneAxis              OutputChain< output::OneAxis::"
  "TwoAxes              OutputChain< output::TwoAxes::"
  "PassivityController  OutputChain< output::PassivityController::"
  "DeviceFrame          DeviceFrame::"
  "VirtualCoupling      VirtualCoupling:: BalanceSearch::"
  "ContactSet           ContactSet< SharedBody< find_wall"
  "StiffnessScale       StiffnessScale< SiteScales::"
  "BondedContact        BondedLaw::"
  "BondedContact6D      BondedLaw:: BondedTorqueLaw::"
  "DeformingBody        DeformingSurface:: SkinnedPoseMaker SlotExchange:: LocalMotion::"
  "RigidMotion          RigidMotion::"
  "Mechanism            Mechanism< Rows<"
  "TripleBuffer         TripleBuffer< SlotExchange::"
  "EnergyMeter          EnergyMeter::"
  "SuperpositionError   SuperpositionError:: ContactRadius::")
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
      message(FATAL_ERROR "${symbol} is not even in a program that uses ${name}:\n${output}")
    elseif(named EQUAL -1 AND NOT found EQUAL -1)
      message(FATAL_ERROR "${symbol} is in a program that uses ${name} alone:\n${output}")
    endif()
  endforeach()
endforeach()
list(LENGTH optional count)
message(STATUS "${count} symbols of optional classes, each in the programs that use it and in no other")

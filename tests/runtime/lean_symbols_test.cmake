# SPDX-License-Identifier: GPL-3.0-or-later
# A feature that is left out leaves no code: functions of each are in the object with all and not in that with none. Nor
# does a virtual coupling that nobody names: a tool that is held rigidly is ticked by the same bytes of code. Nor an animated
# body.
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
foreach(part IN ITEMS coupled::Law:: coupled::Energy:: coupled::margin runtime::slip< ::sum_sideways search_tree touch_probes
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

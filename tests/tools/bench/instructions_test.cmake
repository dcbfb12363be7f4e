# SPDX-License-Identifier: GPL-3.0-or-later
# tools/instructions.sh counts what `palpate bench` times; needs valgrind.
include(${CMAKE_CURRENT_LIST_DIR}/../../support/run.cmake)
find_program(valgrind valgrind)
if(NOT valgrind)
  message(STATUS "skipped: no valgrind in PATH")
  return()
endif()
set(script ${CMAKE_CURRENT_LIST_DIR}/../../../tools/instructions.sh)
run(${script} ${PALPATE} ${CMAKE_CURRENT_LIST_DIR}/../../goldens/quadratic.palp --contacts 3)
foreach(row press field slide free locate blend random five plain network)
  if(NOT output MATCHES "${row} +([0-9]+) instructions\n")
    message(FATAL_ERROR "no ${row} in\n${output}")
  endif()
  set(${row} ${CMAKE_MATCH_1})
endforeach()
# A tick is more than its force, five are five, and an interpolation is a part of a tick that slides.
math(EXPR four "4 * ${press}")
math(EXPR six "6 * ${press}")
if(field LESS 50 OR NOT field LESS press OR NOT blend LESS slide OR five LESS four OR five GREATER six)
  message(FATAL_ERROR "not counts of what they are called:\n${output}")
endif()

# A file that is none is refused by the program, and in its words.
execute_process(COMMAND ${script} ${PALPATE} ${script} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
if(code EQUAL 0 OR NOT out STREQUAL "" OR NOT err MATCHES "not a Palpate response file")
  message(FATAL_ERROR "a file that is none: ${code}\n${out}${err}")
endif()

# SPDX-License-Identifier: GPL-3.0-or-later
# Runs the embedding example: on a good file, a damaged one, a missing one. It must stay within 30 lines.
set(file ${FOLDER}/embed.palp)
execute_process(COMMAND ${WRITE_SAMPLE} ${file} RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "write_sample ended with ${code}")
endif()

function(expect wanted pattern)
  execute_process(COMMAND ${ARGN} RESULT_VARIABLE code OUTPUT_VARIABLE out ERROR_VARIABLE err)
  if(NOT code EQUAL wanted OR NOT "${out}${err}" MATCHES "${pattern}")
    message(FATAL_ERROR "${ARGN}: code ${code}, expected ${wanted} and '${pattern}':\n${out}${err}")
  endif()
endfunction()

expect(0 "  0 ms: depth 0.00 mm, force 0.000 N.*900 ms: depth [1-9]\\.[0-9]+ mm, force [1-9]" ${EMBED} ${file})
expect(1 "usage" ${EMBED})
expect(4 "No such file" ${EMBED} ${FOLDER}/missing.palp)
file(WRITE ${FOLDER}/bad.palp "not a response file")
expect(2 "truncated" ${EMBED} ${FOLDER}/bad.palp)

file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/../../runtime/examples/embed.cpp lines)
list(LENGTH lines count)
if(count GREATER 30)
  message(FATAL_ERROR "the embedding example has ${count} lines, allowed 30")
endif()

file(READ ${CMAKE_CURRENT_LIST_DIR}/../../runtime/examples/embed.cpp program)
file(READ ${CMAKE_CURRENT_LIST_DIR}/../../runtime/README.md readme)
string(FIND "${readme}" "```cpp\n${program}```" found)
if(found EQUAL -1)
  message(FATAL_ERROR "the program of runtime/README.md is not runtime/examples/embed.cpp")
endif()

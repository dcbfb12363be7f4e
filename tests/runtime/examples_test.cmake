# SPDX-License-Identifier: GPL-3.0-or-later
# The examples beside embed.cpp: what they print, how they refuse a file, how long they are, and that the README names them.
include(${CMAKE_CURRENT_LIST_DIR}/../support/run.cmake)
set(file ${FOLDER}/examples.palp)
run(${WRITE_SAMPLE} ${file})
file(READ ${CMAKE_CURRENT_LIST_DIR}/../../runtime/README.md readme)

function(example name most_lines pattern)
  run(${PROGRAMS}/${name} ${ARGN})
  if(NOT output MATCHES "${pattern}")
    message(FATAL_ERROR "${name}: expected '${pattern}':\n${output}")
  endif()
  file(STRINGS ${CMAKE_CURRENT_LIST_DIR}/../../runtime/examples/${name}.cpp lines)
  list(LENGTH lines count)
  if(count GREATER most_lines)
    message(FATAL_ERROR "${name}.cpp has ${count} lines, allowed ${most_lines}")
  endif()
  if(NOT readme MATCHES "examples/${name}.cpp")
    message(FATAL_ERROR "runtime/README.md does not name examples/${name}.cpp")
  endif()
  if(ARGN)
    execute_process(COMMAND ${PROGRAMS}/${name} ${CMAKE_CURRENT_LIST_FILE} RESULT_VARIABLE code ERROR_VARIABLE error)
    if(NOT code EQUAL 2 OR NOT error MATCHES "first bytes are not PALPATE|aligned")
      message(FATAL_ERROR "${name} on a text file: ${code}\n${error}")
    endif()
  endif()
endfunction()

# Both press, the one that strokes feels friction at its handle, and a warning comes where they are near.
set(felt "0\\.[0-9]*[1-9][0-9]* N")
example(two_tools 45 " 600 ms: left ${felt} 0\\.000 mN m right ${felt} 0\\.[1-9][0-9]* mN m\n.*1000 ms: left ${felt} [^\n]*, near: the sum is up to [12][0-9] % too large"
        ${file})
# Felt while the body is up, and the same on its way down as on its way up.
example(moving_body 30 "   0 ms: [^\n]*force 0.000 N.*1000 ms: [^\n]* (force 0\\.[0-9]+ N)\n.*3000 ms: [^\n]* \\1.*4000 ms: [^\n]*force 0.000 N"
        ${file})
# Felt while it is swollen, and let go again.
example(beating_body 40 "   0 ms: [^\n]* 0.000 N.* 500 ms: [^\n]* 0\\.[1-9][0-9]* N\n.*1000 ms: [^\n]* 0.000 N" ${file})
example(tracker_thread 45 "  0 ms: 0.000 N.*500 ms: 0\\.[1-9]" ${file})
# Presses, then strokes: the force follows the curve of the body.
example(microcontroller 30 "   0 ms: 0.0000 0.0000 0.0000 N.* 500 ms: -0\\.[1-9].*1000 ms: ")

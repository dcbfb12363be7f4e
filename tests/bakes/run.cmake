# SPDX-License-Identifier: GPL-3.0-or-later
# run(ARGUMENTS...): runs palpate in FOLDER, sets `out` to what it prints as its result, and ends the test where it fails.
function(run)
  execute_process(COMMAND ${PALPATE} ${ARGN} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code OUTPUT_VARIABLE out)
  if(NOT code EQUAL 0)
    message(FATAL_ERROR "palpate ${ARGN}: code ${code}\n${out}")
  endif()
  set(out "${out}" PARENT_SCOPE)
endfunction()

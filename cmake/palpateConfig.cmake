# SPDX-License-Identifier: MIT
# find_package(palpate): the command line as palpate_EXECUTABLE and a function for regression tests of forces.
if(NOT palpate_EXECUTABLE)
  find_program(palpate_EXECUTABLE palpate HINTS ${CMAKE_CURRENT_LIST_DIR}/../../../bin)
endif()
if(NOT palpate_EXECUTABLE)
  set(palpate_FOUND FALSE)
  set(palpate_NOT_FOUND_MESSAGE "the executable palpate was not found")
  return()
endif()

# palpate_add_force_test(NAME test FILE x.palp SAMPLES report.json MAX_P95 0.12): adds a test that compares the
# response file with the recorded solves of an earlier `palpate verify --report` and fails beyond the tolerance.
function(palpate_add_force_test)
  cmake_parse_arguments(arg "" "NAME;FILE;SAMPLES;MAX_P95" "" ${ARGN})
  foreach(key IN ITEMS NAME FILE SAMPLES MAX_P95)
    if(NOT DEFINED arg_${key})
      message(FATAL_ERROR "palpate_add_force_test: ${key} is missing")
    endif()
  endforeach()
  if(arg_UNPARSED_ARGUMENTS)
    message(FATAL_ERROR "palpate_add_force_test: unknown arguments ${arg_UNPARSED_ARGUMENTS}")
  endif()
  add_test(NAME ${arg_NAME} COMMAND ${palpate_EXECUTABLE} verify ${arg_FILE} --samples ${arg_SAMPLES}
                                    --max-p95 ${arg_MAX_P95} WORKING_DIRECTORY ${CMAKE_CURRENT_SOURCE_DIR})
endfunction()

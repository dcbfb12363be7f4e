# SPDX-License-Identifier: GPL-3.0-or-later
# need_compiler(): sets `compiler` to the first of NAMES that is in PATH; without one the test is skipped.
macro(need_compiler)
  find_program(compiler NAMES ${NAMES})
  if(NOT compiler)
    list(JOIN NAMES " or " names)
    message(STATUS "skipped: no ${names}")
    return()
  endif()
endmacro()

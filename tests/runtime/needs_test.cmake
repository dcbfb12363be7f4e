# SPDX-License-Identifier: GPL-3.0-or-later
# Symbols that opening and ticking leave to the linker: arithmetic and copies of memory, so no allocation, lock,
# exception or system call can be in them. A file that does more is refused by the same rule.
include(${CMAKE_CURRENT_LIST_DIR}/../support/run.cmake)
set(allowed "^(acos|atan2|ceil|cos|exp|fmaxf?|fminf?|hypot|sin|sincos|sqrt|memcpy|memmove|memset|_GLOBAL_OFFSET_TABLE_)$")

function(needs object result)
  run(${NM} --undefined-only --format=posix ${object})
  string(REGEX MATCHALL "[^\n]+" lines "${output}")
  list(TRANSFORM lines REPLACE " .*" "")
  set(more ${lines})
  list(FILTER more EXCLUDE REGEX ${allowed})
  set(${result} "${more}" PARENT_SCOPE)
  message(STATUS "${object} needs ${lines}")
endfunction()

needs(${TICKS} more)
if(more)
  message(FATAL_ERROR "a tick needs more than arithmetic: ${more}")
endif()
needs(${ALLOCATES} more)
if(NOT more MATCHES "malloc" OR NOT more MATCHES "__cxa_throw")
  message(FATAL_ERROR "an allocation and an exception go unnoticed")
endif()

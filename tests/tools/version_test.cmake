# SPDX-License-Identifier: GPL-3.0-or-later
# One version number: the project's, which `palpate --version` prints, stands in CITATION.cff, in README.md and at the top
# of CHANGELOG.md.
include(${CMAKE_CURRENT_LIST_DIR}/../support/run.cmake)
run(${PALPATE} --version)
string(REGEX MATCH "palpate ([0-9.]+)" ignored "${output}")
set(program ${CMAKE_MATCH_1})
function(version_in file pattern)
  file(READ ${SOURCE}/${file} text)
  if(NOT text MATCHES "${pattern}")
    message(FATAL_ERROR "${file} has no version")
  endif()
  if(NOT CMAKE_MATCH_1 STREQUAL VERSION)
    message(FATAL_ERROR "${file} has version ${CMAKE_MATCH_1}, CMakeLists.txt ${VERSION}")
  endif()
endfunction()
if(NOT program STREQUAL VERSION)
  message(FATAL_ERROR "palpate --version prints '${output}', CMakeLists.txt has version ${VERSION}")
endif()
version_in(CITATION.cff "\nversion: ([0-9.]+)\n")
version_in(README.md "version ([0-9.]+) \\(`palpate --version`\\)")
# The first heading is the newest version.
version_in(CHANGELOG.md "\n## \\[([^]]*)\\]")

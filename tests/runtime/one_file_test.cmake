# SPDX-License-Identifier: GPL-3.0-or-later
# The runtime as one file: warning-free from C++17 to C++23 without exceptions and RTTI under every compiler that is there,
# linked from two translation units, and with the forces of the headers that it was made of.
include(${CMAKE_CURRENT_LIST_DIR}/../support/run.cmake)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})

# Two programs' files as they stand: what they include by name is the one file.
set(embed ${SOURCE}/runtime/examples/embed.cpp)
set(every_tick ${SOURCE}/tests/runtime/every_tick.cpp)
foreach(header IN ITEMS runtime math3)
  file(WRITE ${FOLDER}/palpate/${header}.hpp "#include \"palpate_runtime.hpp\"\n")
endforeach()
file(COPY ${SOURCE}/runtime/include/palpate/mapped_file.hpp DESTINATION ${FOLDER}/palpate)

set(strict -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror -fno-exceptions -fno-rtti
    -I ${FOLDER} -I ${ONE_FILE_FOLDER} -I ${SOURCE})
find_program(CLANG NAMES clang++ clang++-14)
set(compilers ${COMPILER})
if(CLANG)
  list(APPEND compilers ${CLANG})
endif()
foreach(compiler IN LISTS compilers)
  foreach(standard IN ITEMS 20 2b)
    run(${compiler} -std=c++${standard} ${strict} -fsyntax-only ${every_tick})
    message(STATUS "${compiler}, C++${standard}: no warning")
  endforeach()
  run(${compiler} -std=c++17 ${strict} ${embed} ${every_tick} -o ${FOLDER}/embed)
  message(STATUS "${compiler}, C++17: no warning")
endforeach()

run(${WRITE_SAMPLE} ${FOLDER}/ball.palp)
run(${FOLDER}/embed ${FOLDER}/ball.palp)
set(one_file "${output}")
run(${EMBED} ${FOLDER}/ball.palp)
if(NOT one_file STREQUAL output OR NOT output MATCHES "force [1-9]")
  message(FATAL_ERROR "other forces from one file:\n${one_file}\nthan from the headers:\n${output}")
endif()

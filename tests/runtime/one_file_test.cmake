# SPDX-License-Identifier: GPL-3.0-or-later
# The runtime as one file: warning-free from C++17 to C++23 without exceptions and RTTI under every compiler that is there,
# linked from two translation units, and with the forces of the headers that it was made of.
include(${CMAKE_CURRENT_LIST_DIR}/../support/run.cmake)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})

file(READ ${SOURCE}/runtime/examples/embed.cpp program)
string(REPLACE "palpate/runtime.hpp" "palpate_runtime.hpp" program "${program}")
file(WRITE ${FOLDER}/embed.cpp "${program}")
file(WRITE ${FOLDER}/again.cpp "#include \"palpate_runtime.hpp\"\n#include \"palpate/mapped_file.hpp\"\n"
     "double again(const palpate::runtime::View& view) { return palpate::runtime::Contact(view, 0).tick({}).depth; }\n")

set(strict -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror -fno-exceptions -fno-rtti
    -I ${ONE_FILE_FOLDER} -I ${SOURCE}/runtime/include)
find_program(CLANG NAMES clang++ clang++-14)
set(compilers ${COMPILER})
if(CLANG)
  list(APPEND compilers ${CLANG})
endif()
foreach(compiler IN LISTS compilers)
  foreach(standard IN ITEMS 17 20 2b)
    run(${compiler} -std=c++${standard} ${strict} -fsyntax-only ${FOLDER}/again.cpp)
    message(STATUS "${compiler}, C++${standard}: no warning")
  endforeach()
endforeach()

run(${COMPILER} -std=c++17 ${strict} ${FOLDER}/embed.cpp ${FOLDER}/again.cpp -o ${FOLDER}/embed)
run(${WRITE_SAMPLE} ${FOLDER}/ball.palp)
run(${FOLDER}/embed ${FOLDER}/ball.palp)
set(one_file "${output}")
run(${EMBED} ${FOLDER}/ball.palp)
if(NOT one_file STREQUAL output OR NOT output MATCHES "force [1-9]")
  message(FATAL_ERROR "other forces from one file:\n${one_file}\nthan from the headers:\n${output}")
endif()

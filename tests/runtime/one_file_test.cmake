# SPDX-License-Identifier: GPL-3.0-or-later
# The runtime as one file, under one compiler (g++ or clang++) and one standard: warning-free without exceptions and RTTI,
# linked from two translation units, and with the forces of the headers that it was made of.
include(${CMAKE_CURRENT_LIST_DIR}/../support/compiler.cmake)
include(${CMAKE_CURRENT_LIST_DIR}/../support/run.cmake)
need_compiler()
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER})

# Two programs' files unchanged: every header of ours that they include is the one file, and MappedFile is its loader.
foreach(header IN ITEMS palpate math/pose)
  file(WRITE ${FOLDER}/palpate/${header}.hpp "#include \"palpate_runtime.hpp\"\n")
endforeach()
file(WRITE ${FOLDER}/palpate/format/mapped_file.hpp
     "#include \"palpate_runtime.hpp\"\nnamespace palpate::runtime { using MappedFile = LoadedFile; }\n")

# Compilers that precede a standard accept its working title.
set(standard ${STANDARD})
if(standard EQUAL 23)
  execute_process(COMMAND ${compiler} -std=c++23 -x c++ -E /dev/null RESULT_VARIABLE unknown OUTPUT_QUIET ERROR_QUIET)
  if(unknown)
    set(standard 2b)
  endif()
endif()
set(compile ${compiler} -std=c++${standard} -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
    -fno-exceptions -fno-rtti -I ${FOLDER} -I ${ONE_FILE_FOLDER} -I ${SOURCE} ${SOURCE}/runtime/examples/embed.cpp
    ${SOURCE}/tests/runtime/every_tick.cpp)
if(STANDARD EQUAL 20)  # between the two that are linked
  run(${compile} -fsyntax-only)
  return()
endif()
run(${compile} -o ${FOLDER}/embed)
message(STATUS "${compiler} -std=c++${standard}: no warning")

run(${WRITE_SAMPLE} ${FOLDER}/ball.palp)
run(${FOLDER}/embed ${FOLDER}/ball.palp)
set(one_file "${output}")
run(${EMBED} ${FOLDER}/ball.palp)
if(NOT one_file STREQUAL output OR NOT output MATCHES "force [1-9]")
  message(FATAL_ERROR "other forces from one file:\n${one_file}\nthan from the headers:\n${output}")
endif()

# SPDX-License-Identifier: GPL-3.0-or-later
# Compiles a fuzz target (response: the reader of response files; device: the languages of devices; image: label images,
# with ITK and libnifti as they are installed; surface: plain surface files) with clang's libFuzzer and
# sanitizers and runs it for SECONDS, each on its corpus, the reader on the goldens as well:
# cmake -D SOURCE=. -D NAME=response -D FOLDER=build/fuzz -D SECONDS=600 -P tests/fuzz/fuzz.cmake
# New inputs stay in FOLDER/corpus, one that breaks a promise in FOLDER/crash-*. It ends with an error then.
find_program(clang NAMES clang++-14 clang++-19 clang++-18 clang++-17 clang++-16 clang++-15 clang++)
if(NOT clang)
  message(STATUS "skipped: no clang++ in PATH (Debian's clang-14 and libclang-rt-14-dev)")
  return()
endif()
if(NAME STREQUAL "device")
  # Without libusb, which no protocol needs.
  file(GLOB sources ${SOURCE}/runtime/device/*/*_codec.cpp ${SOURCE}/runtime/device/*/*_kinematics.cpp
       ${SOURCE}/runtime/device/*/*_protocol.cpp ${SOURCE}/runtime/device/*/*_boot.cpp)
  set(seeds ${SOURCE}/tests/fuzz/device_corpus)
elseif(NAME STREQUAL "image")
  set(sources)
  foreach(part IN ITEMS gzip image_header label_image nifti_reader)
    list(APPEND sources ${SOURCE}/formats/image/${part}.cpp)
  endforeach()
  set(seeds ${SOURCE}/tests/fuzz/image_corpus)
  file(GLOB itk /usr/include/ITK-5*)
  string(REGEX REPLACE ".*ITK-" "" version "${itk}")
  set(libraries z niftiio znz)
  foreach(part IN ITEMS ITKIONRRD ITKIOMeta ITKIOImageBase ITKCommon itksys)
    list(APPEND libraries ${part}-${version})
  endforeach()
  list(TRANSFORM libraries PREPEND "-l")
  set(options -std=c++20 -isystem /usr/include/eigen3 -isystem /usr/include/nifti)
  # Debian's ITK supports GCC alone. Code that GCC compiles is not watched by the sanitizers.
  file(MAKE_DIRECTORY ${FOLDER})
  execute_process(COMMAND g++ -std=c++20 -O1 -g -I${SOURCE} -isystem ${itk} -c ${SOURCE}/formats/image/itk_reader.cpp
                          -o ${FOLDER}/itk_reader.o RESULT_VARIABLE code)
  if(NOT code EQUAL 0)
    message(STATUS "skipped: no clang++ can do without g++ and ITK (libinsighttoolkit5-dev)")
    return()
  endif()
  list(APPEND sources ${FOLDER}/itk_reader.o)
  set(ENV{ASAN_OPTIONS} detect_leaks=0)  # ITK's NRRD library leaks the texts of errors
elseif(NAME STREQUAL "surface")
  set(sources)
  foreach(part IN ITEMS plain ply polygon vtk vtp)
    list(APPEND sources ${SOURCE}/formats/surface/surface_${part}.cpp)
  endforeach()
  set(seeds ${SOURCE}/tests/fuzz/surface_corpus)
  set(libraries -lz)
  set(options -std=c++20 -isystem /usr/include/eigen3)
else()
  set(sources)
  set(seeds ${SOURCE}/tests/fuzz/corpus ${SOURCE}/tests/goldens)
endif()
file(MAKE_DIRECTORY ${FOLDER}/corpus)
execute_process(
  COMMAND ${clang} -std=c++17 -O1 -g -fno-omit-frame-pointer -fsanitize=fuzzer,address,undefined
          -fno-sanitize-recover=undefined -ffp-contract=off -I${SOURCE} -I${SOURCE}/formats/include
          -I${SOURCE}/runtime -I${SOURCE}/runtime/include ${SOURCE}/tests/fuzz/fuzz_${NAME}.cpp ${sources}
          ${options} -o ${FOLDER}/fuzz_${NAME} ${libraries}
  RESULT_VARIABLE code ERROR_VARIABLE error)
if(NOT code EQUAL 0 AND error MATCHES "libclang_rt")
  message(STATUS "skipped: no clang++ with its run time (Debian's libclang-rt-14-dev)")
  return()
elseif(NOT code EQUAL 0)
  message(FATAL_ERROR "the fuzz target does not compile:\n${error}")
endif()
execute_process(
  COMMAND ${FOLDER}/fuzz_${NAME} -max_total_time=${SECONDS} -max_len=16384 -timeout=20 -rss_limit_mb=2048
          -print_final_stats=1 -artifact_prefix=${FOLDER}/ ${FOLDER}/corpus ${seeds}
  RESULT_VARIABLE code ERROR_VARIABLE log)
file(WRITE ${FOLDER}/log.txt "${log}")
string(REGEX MATCHALL "stat::[^\n]*|SUMMARY[^\n]*|broken invariant[^\n]*|Test unit written[^\n]*" lines "${log}")
list(JOIN lines "\n" text)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "the fuzzer ended with ${code} (whole output: ${FOLDER}/log.txt)\n${text}")
endif()
message(STATUS "nothing found in ${SECONDS} s\n${text}")

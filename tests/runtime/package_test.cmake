# SPDX-License-Identifier: GPL-3.0-or-later
# Configures the runtime alone (both ways), checks that nothing is looked for, installs it, and builds a
# project that finds it there.
include(${CMAKE_CURRENT_LIST_DIR}/../support/run.cmake)
file(REMOVE_RECURSE ${FOLDER})
file(MAKE_DIRECTORY ${FOLDER}/consumer)

# A package that a configure looked for leaves its name in the cache or in the output.
set(precompute CGAL TetGen tetgen Ceres ceres cholmod CHOLMOD SuiteSparse Eigen3 OpenMesh tinygltf)
function(expect_not_sought build)
  file(READ ${build}/CMakeCache.txt cache)
  foreach(name IN LISTS ARGN)
    if("${cache}${output}" MATCHES "${name}_(DIR|FOUND|INCLUDE|LIBRAR)|Found ${name}|Could NOT find ${name}")
      message(FATAL_ERROR "${build}: the configure looks for ${name}")
    endif()
  endforeach()
endfunction()

# The presets as they stand: no flag of the test's own turns anything off.
run(${CMAKE_COMMAND} --preset runtime -G ${GENERATOR} -S ${SOURCE} -B ${FOLDER}/whole -D CMAKE_CXX_COMPILER=${COMPILER})
expect_not_sought(${FOLDER}/whole ${precompute} libusb LIBUSB GTest benchmark)
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE}/runtime -B ${FOLDER}/alone -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_INSTALL_PREFIX=${FOLDER}/prefix)
expect_not_sought(${FOLDER}/alone ${precompute} libusb LIBUSB GTest benchmark)
if(DRIVERS)
  # The device layer needs libusb, and nothing of precompute.
  run(${CMAKE_COMMAND} --preset drivers -G ${GENERATOR} -S ${SOURCE} -B ${FOLDER}/drivers -D CMAKE_CXX_COMPILER=${COMPILER})
  expect_not_sought(${FOLDER}/drivers ${precompute} GTest benchmark)
  # The check finds a package where there is one.
  file(READ ${FOLDER}/drivers/CMakeCache.txt cache)
  if(NOT cache MATCHES "libusb_(DIR|FOUND|INCLUDE|LIBRAR)")
    message(FATAL_ERROR "the check for sought packages does not see libusb where the drivers look for it")
  endif()
endif()
if(PRECOMPUTE)
  # The off-line part alone, as a cluster has it: no device library.
  run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${SOURCE} -B ${FOLDER}/precompute -D CMAKE_CXX_COMPILER=${COMPILER}
      -D PALPATE_PRECOMPUTE=ON -D PALPATE_DRIVERS=OFF -D PALPATE_TESTS=OFF -D PALPATE_BENCH=OFF)
  expect_not_sought(${FOLDER}/precompute libusb LIBUSB GTest benchmark)
endif()
run(${CMAKE_COMMAND} --build ${FOLDER}/alone)
run(${CMAKE_COMMAND} --install ${FOLDER}/alone)

file(WRITE ${FOLDER}/consumer/CMakeLists.txt [=[
cmake_minimum_required(VERSION 3.20)
project(consumer LANGUAGES CXX)
find_package(palpate-runtime 0.1 CONFIG REQUIRED)
add_executable(consumer main.cpp)
target_link_libraries(consumer PRIVATE palpate::runtime)
target_compile_options(consumer PRIVATE -fno-exceptions -fno-rtti -Wall -Wextra -Wpedantic -Werror)
]=])
configure_file(${SOURCE}/runtime/examples/embed.cpp ${FOLDER}/consumer/main.cpp COPYONLY)
run(${CMAKE_COMMAND} -G ${GENERATOR} -S ${FOLDER}/consumer -B ${FOLDER}/consumer/build -D CMAKE_CXX_COMPILER=${COMPILER}
    -D CMAKE_PREFIX_PATH=${FOLDER}/prefix)
run(${CMAKE_COMMAND} --build ${FOLDER}/consumer/build)
run(${WRITE_SAMPLE} ${FOLDER}/ball.palp)
run(${FOLDER}/consumer/build/consumer ${FOLDER}/ball.palp)
if(NOT output MATCHES "force [0-9]")
  message(FATAL_ERROR "the installed runtime printed no force:\n${output}")
endif()

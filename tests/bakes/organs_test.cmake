# SPDX-License-Identifier: GPL-3.0-or-later
# The property test over the shapes of organs: synthetic ones, and the female liver where PALPATE_ORGANS names the
# folder with its file. Their responses are Hertz's everywhere, for the shape counts here: nothing is solved.
cmake_minimum_required(VERSION 3.25)
include(${CMAKE_CURRENT_LIST_DIR}/shapes.cmake)

foreach(organ IN ITEMS liver kidney bladder)
  run(synth ${organ} --out ${organ})
  file(APPEND ${FOLDER}/${organ}/scene.toml "${hertz}")
  run(build ${organ}/scene.toml --output ${organ}.palp)
  list(APPEND files ${organ}.palp)
endforeach()
if(IS_DIRECTORY "${PALPATE_ORGANS}")
  configure_file(${CMAKE_CURRENT_LIST_DIR}/liver.toml.in ${FOLDER}/female_liver.toml @ONLY)
  file(APPEND ${FOLDER}/female_liver.toml "${hertz}")
  run(build female_liver.toml)
  list(APPEND files female_liver.palp)
else()
  message(STATUS "without the female liver: PALPATE_ORGANS names no folder with organ files")
endif()

execute_process(COMMAND ${PROPERTY} ${TICKS} ${files} WORKING_DIRECTORY ${FOLDER} RESULT_VARIABLE code)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "runtime_property: code ${code}")
endif()

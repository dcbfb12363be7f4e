# SPDX-License-Identifier: GPL-3.0-or-later
# The open link's example firmware for a Cortex-M7, by the very command that its README shows, with warnings as errors and
# no library to link: cmake -D SOURCE=. -D OUT=example.elf -P tests/device/open_link/firmware.cmake
file(REMOVE ${OUT})
find_program(compiler arm-none-eabi-g++)
if(NOT compiler)
  message(STATUS "skipped: no arm-none-eabi-g++ in PATH (Debian's gcc-arm-none-eabi)")
  return()
endif()

# From the compiler's name to the output's.
file(READ ${SOURCE}/runtime/device/open_link/firmware/README.md readme)
if(NOT readme MATCHES "    arm-none-eabi-g\\+\\+ (.*) -o example\\.elf\n")
  message(FATAL_ERROR "the README shows no command")
endif()
string(REPLACE "\\\n" " " arguments "${CMAKE_MATCH_1}")
separate_arguments(arguments UNIX_COMMAND "${arguments}")
execute_process(COMMAND ${compiler} ${arguments} -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror
                        -o ${OUT}
                WORKING_DIRECTORY ${SOURCE} RESULT_VARIABLE code ERROR_VARIABLE error)
if(NOT code EQUAL 0)
  message(FATAL_ERROR "it does not compile:\n${error}")
endif()
find_program(size arm-none-eabi-size REQUIRED)
execute_process(COMMAND ${size} ${OUT} OUTPUT_VARIABLE sizes COMMAND_ERROR_IS_FATAL ANY)
if(NOT sizes MATCHES "\n *([0-9]+)[ \t]+([0-9]+)[ \t]+([0-9]+)")
  message(FATAL_ERROR "no sizes in ${sizes}")
endif()
message(STATUS "code ${CMAKE_MATCH_1} B, statics ${CMAKE_MATCH_2} + ${CMAKE_MATCH_3} B")
if(CMAKE_MATCH_1 GREATER 8192 OR CMAKE_MATCH_2 GREATER 0 OR CMAKE_MATCH_3 GREATER 0)
  message(FATAL_ERROR "more than 8 KiB of code, or statics")
endif()

# SPDX-License-Identifier: GPL-3.0-or-later
# The report and its page. The page needs node, npm and a clang for wasm32; without them everything else builds, and
# `palpate report` says what is missing.
option(PALPATE_REPORT_PAGE "Bundle the page of palpate report (node, npm, clang for wasm32)" ON)

set(page_source ${CMAKE_CURRENT_LIST_DIR})
set(page_build ${CMAKE_CURRENT_BINARY_DIR}/report)
set(page_missing "")
if(NOT PALPATE_REPORT_PAGE)
  list(APPEND page_missing "PALPATE_REPORT_PAGE is OFF")
else()
  find_program(PALPATE_NODE node)
  find_program(PALPATE_NPM npm)
  find_program(PALPATE_WASM_CXX clang++)
  foreach(program IN ITEMS NODE:node NPM:npm WASM_CXX:clang)
    string(REPLACE ":" ";" pair ${program})
    list(GET pair 0 variable)
    list(GET pair 1 package)
    if(NOT PALPATE_${variable})
      list(APPEND page_missing "${package} is not installed")
    endif()
  endforeach()
  if(PALPATE_WASM_CXX AND NOT PALPATE_WASM_COMPILES)
    file(WRITE ${page_build}/probe.cpp "#include <cmath>\n#include <vector>\nint main() { return int(std::vector<int>(1).size()); }\n")
    execute_process(COMMAND ${PALPATE_WASM_CXX} --target=wasm32-wasi -fno-exceptions -std=c++17 ${page_build}/probe.cpp
                            -o ${page_build}/probe.wasm RESULT_VARIABLE result OUTPUT_QUIET ERROR_QUIET)
    if(result EQUAL 0)
      set(PALPATE_WASM_COMPILES ON CACHE INTERNAL "clang compiles for wasm32")
    else()
      list(APPEND page_missing "clang does not compile for wasm32 (lld wasi-libc libc++-dev-wasm32 libclang-rt-dev-wasm32)")
    endif()
  endif()
  # Licence texts of the libraries in the module, which the page shows: those of clang's own version.
  set(page_notices "")
  if(PALPATE_WASM_CXX)
    execute_process(COMMAND ${PALPATE_WASM_CXX} -dumpversion OUTPUT_VARIABLE clang_version ERROR_QUIET)
    string(REGEX MATCH "^[0-9]+" clang_major "${clang_version}")
    foreach(library IN ITEMS wasi-libc libc++-${clang_major}-dev-wasm32 libclang-rt-${clang_major}-dev-wasm32)
      list(APPEND page_notices /usr/share/doc/${library}/copyright)
      if(NOT EXISTS /usr/share/doc/${library}/copyright)
        list(APPEND page_missing "the licence text /usr/share/doc/${library}/copyright does not exist")
      endif()
    endforeach()
  endif()
endif()

# Packages as package-lock.json names them, in the build folder.
if(NOT page_missing)
  set_property(DIRECTORY APPEND PROPERTY CMAKE_CONFIGURE_DEPENDS ${page_source}/package-lock.json)
  file(SHA256 ${page_source}/package-lock.json lock)
  if(NOT EXISTS ${page_build}/installed-${lock})
    message(STATUS "palpate: npm ci for the page of palpate report")
    file(COPY ${page_source}/package.json ${page_source}/package-lock.json DESTINATION ${page_build})
    execute_process(COMMAND ${PALPATE_NPM} ci --no-audit --no-fund --silent WORKING_DIRECTORY ${page_build}
                    RESULT_VARIABLE result OUTPUT_QUIET ERROR_VARIABLE problem)
    if(result EQUAL 0)
      file(WRITE ${page_build}/installed-${lock} "")
    else()
      list(APPEND page_missing "npm ci failed in ${page_build}")
      message(STATUS "${problem}")
    endif()
  endif()
endif()

file(GLOB page_sources CONFIGURE_DEPENDS ${page_source}/page/* ${page_source}/build.mjs)
set(template ${page_source}/page_template.cpp)
if(page_missing)
  list(JOIN page_missing ", " page_missing)  # a semicolon would split the definition below
  message(STATUS "palpate: report has no page: ${page_missing}")
  set_source_files_properties(${template} PROPERTIES COMPILE_DEFINITIONS "PALPATE_PAGE_MISSING=\"${page_missing}\"")
else()
  set(poke ${page_build}/poke.wasm)
  add_custom_command(
    OUTPUT ${poke}
    COMMAND ${PALPATE_WASM_CXX} --target=wasm32-wasi -mexec-model=reactor -std=c++17 -O2 -fno-exceptions -fno-rtti
            -ffp-contract=off -Wl,--strip-all -I ${PROJECT_SOURCE_DIR} -I ${PROJECT_SOURCE_DIR}/runtime/include
            -I ${PROJECT_SOURCE_DIR}/formats/include -MD -MF ${poke}.d -MT ${poke} ${page_source}/poke/poke.cpp -o ${poke}
    DEPENDS ${page_source}/poke/poke.cpp DEPFILE ${poke}.d COMMENT "The runtime as WebAssembly" VERBATIM)
  set(page ${page_build}/page.html)
  add_custom_command(
    OUTPUT ${page}
    COMMAND ${PALPATE_NODE} ${page_source}/build.mjs ${page_build} ${poke} ${page} ${page_notices}
    DEPENDS ${page_sources} ${poke} ${page_build}/installed-${lock} COMMENT "The page of palpate report" VERBATIM)
  set_source_files_properties(${template} PROPERTIES COMPILE_DEFINITIONS "PALPATE_PAGE=\"${page}\""
                                                     OBJECT_DEPENDS ${page})
endif()
set_source_files_properties(${template} PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON SKIP_PRECOMPILE_HEADERS ON)

set(report_files cost files left_out organ page page_template provenance report run stability)
list(TRANSFORM report_files REPLACE "(.+)" "report/\\1.cpp")

# SPDX-License-Identifier: MIT
# palpate_response: the response file in memory and its writer, which opens the written bytes with the reader.
add_library(palpate_response STATIC
  ${CMAKE_CURRENT_LIST_DIR}/response.cpp
  ${CMAKE_CURRENT_LIST_DIR}/response_check.cpp
  ${CMAKE_CURRENT_LIST_DIR}/response_io.cpp
  ${CMAKE_CURRENT_LIST_DIR}/response_surface.cpp)
target_compile_features(palpate_response PUBLIC cxx_std_20)
target_include_directories(palpate_response PUBLIC
  ${CMAKE_CURRENT_LIST_DIR}/../.. ${CMAKE_CURRENT_LIST_DIR}/../include)
target_link_libraries(palpate_response PRIVATE palpate_file palpate_settings)
if(TARGET palpate_headers)
  target_precompile_headers(palpate_response REUSE_FROM palpate_headers)
endif()

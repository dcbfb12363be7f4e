# SPDX-License-Identifier: GPL-3.0-or-later
# palpate_response for a build without the formats folder (the runtime alone): it needs no other library.
if(NOT TARGET palpate_response)
  if(NOT TARGET palpate_formats)
    add_library(palpate_formats INTERFACE)
    target_include_directories(palpate_formats INTERFACE ${PROJECT_SOURCE_DIR})
    target_compile_features(palpate_formats INTERFACE cxx_std_20)
  endif()
  include(${PROJECT_SOURCE_DIR}/formats/io/file.cmake)
  include(${PROJECT_SOURCE_DIR}/formats/response/response.cmake)
endif()

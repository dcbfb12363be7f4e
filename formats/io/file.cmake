# SPDX-License-Identifier: MIT
# palpate_file: whole files in and out.
add_library(palpate_file STATIC ${CMAKE_CURRENT_LIST_DIR}/descriptor.cpp ${CMAKE_CURRENT_LIST_DIR}/file.cpp
            ${CMAKE_CURRENT_LIST_DIR}/same_file.cpp)
target_link_libraries(palpate_file PUBLIC palpate_formats PRIVATE palpate_settings)

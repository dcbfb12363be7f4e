# SPDX-License-Identifier: MIT
# palpate_journal: content hashes and the samples journal.
find_path(XXHASH_INCLUDE_DIR xxhash.h REQUIRED)
find_library(XXHASH_LIBRARY xxhash REQUIRED)
mark_as_advanced(XXHASH_INCLUDE_DIR XXHASH_LIBRARY)

add_library(palpate_journal STATIC
  ${CMAKE_CURRENT_LIST_DIR}/../io/hash.cpp ${CMAKE_CURRENT_LIST_DIR}/journal.cpp
  ${CMAKE_CURRENT_LIST_DIR}/journal_record.cpp)
target_include_directories(palpate_journal SYSTEM PRIVATE ${XXHASH_INCLUDE_DIR})
target_include_directories(palpate_journal PRIVATE ${CMAKE_CURRENT_LIST_DIR}/../include)
target_link_libraries(palpate_journal PUBLIC palpate_formats PRIVATE palpate_file palpate_settings ${XXHASH_LIBRARY})
target_precompile_headers(palpate_journal REUSE_FROM palpate_headers)

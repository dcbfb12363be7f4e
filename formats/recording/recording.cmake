# SPDX-License-Identifier: MIT
# palpate_recording: reads contacts recorded with a real tool.
add_library(palpate_recording STATIC recording/recording.cpp)
target_link_libraries(palpate_recording PUBLIC palpate_formats PRIVATE palpate_file palpate_settings)

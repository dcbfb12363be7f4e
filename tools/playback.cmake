# SPDX-License-Identifier: GPL-3.0-or-later
# What play, inspect, compare and bench share with their tests: response files opened, motions read and played, plots,
# timing.
add_library(palpate_playback STATIC motion_file.cpp play.cpp plot.cpp response_input.cpp straight_press.cpp)
target_link_libraries(palpate_playback PUBLIC palpate_runtime palpate_response palpate_file PRIVATE palpate_settings)
if(PALPATE_BENCH)
  find_package(benchmark REQUIRED)
  add_library(palpate_tick_bench STATIC open_bench.cpp tick_bench.cpp)
  target_link_libraries(palpate_tick_bench PUBLIC palpate_runtime PRIVATE palpate_formats benchmark::benchmark
                                                                         palpate_settings)
endif()

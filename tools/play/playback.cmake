# SPDX-License-Identifier: GPL-3.0-or-later
# Code that play, inspect, compare and bench share with their tests: response files opened, motions read and played,
# plots, timing.
add_library(palpate_playback STATIC
  play/closed_motions.cpp play/motion_file.cpp play/play.cpp play/plot.cpp cli/response_input.cpp
  play/indentation_force.cpp)
target_link_libraries(palpate_playback PUBLIC palpate_runtime palpate_response palpate_file PRIVATE palpate_settings)
palpate_together(palpate_playback)
# Code that drive shares with play: runs recorded and replayed, devices placed in scenes and shown.
if(TARGET palpate_device)
  add_library(palpate_drive STATIC drive/drive_device.cpp drive/drive_frame.cpp drive/drive_view.cpp play/play_run.cpp)
  target_link_libraries(palpate_drive PUBLIC palpate_playback palpate_device PRIVATE palpate_settings)
  palpate_together(palpate_drive)
endif()
if(PALPATE_BENCH)
  find_package(benchmark REQUIRED)
  add_library(palpate_tick_bench STATIC bench/bench_rows.cpp bench/open_bench.cpp bench/tick_bench.cpp bench/tick_cases.cpp)
  target_link_libraries(palpate_tick_bench PUBLIC palpate_runtime PRIVATE palpate_formats benchmark::benchmark
                                                                         palpate_settings)
  palpate_together(palpate_tick_bench)
endif()

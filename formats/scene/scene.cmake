# SPDX-License-Identifier: MIT
# palpate_scene: reads scene.toml by toml++.
find_path(TOMLPLUSPLUS_INCLUDE_DIR toml++/toml.h REQUIRED)
find_library(TOMLPLUSPLUS_LIBRARY tomlplusplus REQUIRED)
mark_as_advanced(TOMLPLUSPLUS_INCLUDE_DIR TOMLPLUSPLUS_LIBRARY)

add_library(palpate_scene STATIC
  scene/scene.cpp scene/scene_keys.cpp scene/scene_material.cpp scene/scene_compliance.cpp scene/scene_prestress.cpp
  scene/scene_reference.cpp scene/scene_region.cpp scene/scene_source.cpp scene/scene_sources.cpp
  scene/scene_support.cpp scene/scene_value.cpp scene/tissues.cpp)
target_include_directories(palpate_scene PRIVATE ${CMAKE_CURRENT_LIST_DIR}/../include)
target_include_directories(palpate_scene SYSTEM PRIVATE ${TOMLPLUSPLUS_INCLUDE_DIR})
target_compile_definitions(palpate_scene PRIVATE TOML_HEADER_ONLY=0 TOML_SHARED_LIB=1)
palpate_seldom_run(palpate_scene <toml++/toml.h> <Eigen/Core> <filesystem> <string> <vector>)
target_link_libraries(palpate_scene PUBLIC palpate_formats PRIVATE palpate_file palpate_settings ${TOMLPLUSPLUS_LIBRARY})

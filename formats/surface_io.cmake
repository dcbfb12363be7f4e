# SPDX-License-Identifier: MIT
# Surface files: glTF by tinygltf, the others by readers of their own and written by OpenMesh; surfaces with fields for
# viewers; curves.
find_package(OpenMesh CONFIG REQUIRED)
find_package(TinyGLTF CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(ZLIB REQUIRED)
add_library(palpate_surface_io STATIC
  curve_io.cpp surface_io.cpp surface_openmesh.cpp
  surface_plain.cpp surface_ply.cpp surface_polygon.cpp surface_vtk.cpp surface_vtp.cpp volume_vtu.cpp surface_gltf.cpp surface_gltf_screen.cpp surface_fields_glb.cpp
  surface_fields_vtu.cpp)
target_link_libraries(palpate_surface_io
  PUBLIC palpate_formats
  PRIVATE palpate_settings palpate_file OpenMeshCore TinyGLTF::TinyGLTF nlohmann_json::nlohmann_json ZLIB::ZLIB)
palpate_seldom_run(palpate_surface_io <Eigen/Geometry> <nlohmann/json.hpp> <string> <vector>)
# OpenMesh's property vectors copy default vectors that its constructors leave open; the sanitizers' flow sees it.
set_source_files_properties(surface_openmesh.cpp PROPERTIES COMPILE_OPTIONS -Wno-maybe-uninitialized)

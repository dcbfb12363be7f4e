# SPDX-License-Identifier: MIT
# Surface files: glTF by tinygltf, the others by readers of their own and written by OpenMesh; surfaces with fields for
# viewers; curves.
find_package(OpenMesh CONFIG REQUIRED)
find_package(TinyGLTF CONFIG REQUIRED)
find_package(nlohmann_json CONFIG REQUIRED)
find_package(ZLIB REQUIRED)
add_library(palpate_surface_io STATIC
  surface/curve_io.cpp surface/surface_io.cpp surface/surface_openmesh.cpp surface/surface_plain.cpp
  surface/surface_ply.cpp surface/surface_polygon.cpp surface/surface_vtk.cpp surface/surface_vtp.cpp
  fields/volume_vtu.cpp surface/surface_gltf.cpp surface/surface_gltf_screen.cpp fields/surface_fields_glb.cpp
  fields/surface_fields_vtu.cpp)
target_link_libraries(palpate_surface_io
  PUBLIC palpate_formats
  PRIVATE palpate_settings palpate_file OpenMeshCore TinyGLTF::TinyGLTF nlohmann_json::nlohmann_json ZLIB::ZLIB)
palpate_seldom_run(palpate_surface_io <Eigen/Geometry> <nlohmann/json.hpp> <string> <vector>)
# OpenMesh's property vectors copy default vectors that its constructors leave open; the sanitizers' flow sees it.
set_source_files_properties(surface/surface_openmesh.cpp PROPERTIES COMPILE_OPTIONS -Wno-maybe-uninitialized)

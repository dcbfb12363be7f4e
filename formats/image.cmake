# SPDX-License-Identifier: MIT
# palpate_image: reads label images by ITK. Three of its readers are linked, not the whole of ITK.
enable_language(C)  # ITK's package file looks for HDF5, whose search needs a C compiler
find_package(ITK 5 REQUIRED COMPONENTS ITKIONIFTI ITKIONRRD ITKIOMeta)
find_package(ZLIB REQUIRED)
add_library(palpate_image STATIC image/gzip.cpp image/image_header.cpp image/itk_reader.cpp image/label_image.cpp)
target_include_directories(palpate_image SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
target_link_libraries(palpate_image
  PUBLIC palpate_formats
  PRIVATE palpate_settings palpate_file ITKIONIFTI ITKIONRRD ITKIOMeta ITKIOImageBase ITKCommon ZLIB::ZLIB)
set_source_files_properties(image/itk_reader.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
# Loops over hundreds of millions of voxels: optimised in every release, unlike the readers of small files.

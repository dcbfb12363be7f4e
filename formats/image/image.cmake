# SPDX-License-Identifier: MIT
# palpate_image: reads label images, NIfTI by libnifti and others by ITK. Two of ITK's readers are linked, not the whole.
enable_language(C)  # ITK's package file looks for HDF5, whose search needs a C compiler
find_package(ITK 5 REQUIRED COMPONENTS ITKIONRRD ITKIOMeta)
find_path(PALPATE_NIFTI_INCLUDE nifti1_io.h PATH_SUFFIXES nifti REQUIRED)
find_library(PALPATE_NIFTI niftiio REQUIRED)
find_library(PALPATE_ZNZ znz REQUIRED)  # libnifti's reader of compressed files
find_package(ZLIB REQUIRED)
add_library(palpate_image STATIC image/gzip.cpp image/image_header.cpp image/itk_reader.cpp
            image/label_image.cpp image/nifti_reader.cpp)
target_include_directories(palpate_image SYSTEM PRIVATE ${ITK_INCLUDE_DIRS})
target_link_libraries(palpate_image
  PUBLIC palpate_formats
  PRIVATE palpate_settings palpate_file ${PALPATE_NIFTI} ${PALPATE_ZNZ} ITKIONRRD ITKIOMeta ITKIOImageBase ITKCommon ZLIB::ZLIB)
set_source_files_properties(image/itk_reader.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON)
# Before ITK's folder, which has a copy of libnifti's headers.
set_source_files_properties(image/nifti_reader.cpp PROPERTIES SKIP_UNITY_BUILD_INCLUSION ON
                            INCLUDE_DIRECTORIES ${PALPATE_NIFTI_INCLUDE})
# Loops over hundreds of millions of voxels: optimised in every release, unlike the readers of small files.

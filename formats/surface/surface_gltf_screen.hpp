// SPDX-License-Identifier: MIT
// Checks a glTF file's frame and cross-references before tinygltf sees it.
#pragma once

#include <filesystem>
#include <string>

namespace palpate {

/// A glTF document reduced to scenes, nodes, meshes, accessors and buffers, every reference in it checked,
/// written anew in the container it came in. tinygltf has overrun its memory on crafted lengths and images
/// (its issues 363, 364 and 372), so it is given nothing but this.
/// Throws Error(bad_input) naming the file and the element that is wrong.
std::string screen_gltf(const std::string& bytes, const std::filesystem::path& file, bool binary);

}  // namespace palpate

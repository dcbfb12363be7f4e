// SPDX-License-Identifier: GPL-3.0-or-later
// How long it takes to open a response file in place, and a large file to try it on.
#pragma once

#include <cstddef>
#include <filesystem>
#include <vector>

#include "palpate/palpate.hpp"

namespace palpate::cli {

/// Least size of a file of repeated bodies: both bounds hold.
struct RepeatedSize {
  double bytes = 0, sites = 0;
};

/// A valid file of at least that size: as many copies of the body, its contact surface and all its responses in one
/// place as it takes, one search tree over them all, the tools once. Throws Error(bad_input) where a count would not
/// fit the format.
std::vector<std::byte> repeat_body(const runtime::View& view, const RepeatedSize& size);

struct OpenBench {
  std::size_t bytes = 0;
  std::uint32_t sites = 0, responses = 0;
  std::vector<layout::SectionEntry> parts;
  double validated = 0;       ///< s of processor time, median, mapping included, the file's pages in memory
  double validated_most = 0;  ///< s
  double trusted = 0;         ///< s, median of open_trusted, mapping included
};

/// Maps and opens the file `rounds` times each way, after a first that brings it into memory. Throws Error(io) where it
/// cannot be mapped, Error(bad_input) where it does not open.
OpenBench bench_open(const std::filesystem::path& file, int rounds);

}  // namespace palpate::cli

// SPDX-License-Identifier: MIT
// Small-strain stiffness of tissues, each with its publication.
#pragma once

#include <span>

namespace palpate {

struct Tissue {
  const char* name;    ///< as a scene names it
  double shear;        ///< Pa, shear modulus
  const char* source;  ///< publication and how it was measured
};

/// All of human tissue in the living body, measured by magnetic resonance elastography: waves of tens of hertz, to
/// which tissue is stiffer than to a slow push. Between people and methods they differ by a factor of two and more.
std::span<const Tissue> tissues();

}  // namespace palpate

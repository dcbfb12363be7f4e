// SPDX-License-Identifier: GPL-3.0-or-later
// Works round OpenBLAS taking a recent processor for a very old one, and keeps its threads out of our way.
#pragma once

#include <string>
#include <string_view>

namespace palpate::cli {

/// To be called first in main. Sets one thread for BLAS and OpenMP (we run one solver a thread) and, where
/// OpenBLAS chose kernels without AVX2 on a processor that has it, names the right ones; since these libraries read
/// their environment only while they are loaded, the program then starts itself again, at most once. Variables that
/// the user has set are left as they are. Returns without effect when nothing is to be done or it cannot be.
void use_right_blas_kernels(char** argv);

/// The kernel set (OPENBLAS_CORETYPE) to be used instead of `chosen` on a processor with these abilities; null:
/// the choice is good enough.
const char* better_core_type(std::string_view chosen, bool avx2, bool avx512);

/// Names, with blanks between, of the environment variables that use_right_blas_kernels has set: they are about this
/// processor, and no others than our children on it should have them.
std::string variables_set_here();

/// Name of the kernel set that OpenBLAS runs; empty when OpenBLAS is not loaded.
std::string blas_kernels();

}  // namespace palpate::cli

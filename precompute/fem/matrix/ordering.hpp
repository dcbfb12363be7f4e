// SPDX-License-Identifier: GPL-3.0-or-later
// The order of elimination of a sparse matrix, by METIS under CHOLMOD.
#pragma once

struct cholmod_common_struct;
struct cholmod_factor_struct;
struct cholmod_sparse_struct;

namespace palpate::fem {

/// cholmod_analyze(), one thread at a time. The process's signal handlers stay what they are.
cholmod_factor_struct* order_and_analyse(cholmod_sparse_struct& lower, cholmod_common_struct& common);

}  // namespace palpate::fem

// SPDX-License-Identifier: MIT
// What off-line code uses of the runtime: a file's view, the blend of its responses, the closest point.
#pragma once

#include "palpate/field.hpp"
#include "palpate/format/open.hpp"
#include "palpate/locate.hpp"
#include "palpate/turn.hpp"

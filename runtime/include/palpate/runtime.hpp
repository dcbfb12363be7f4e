// SPDX-License-Identifier: MIT
// Palpate's runtime in one include: open a response file, follow a tool, get newtons.
#pragma once

/// C++17 and the standard library; no allocation, exception, lock or system call. Open a file's bytes once
/// with View::open; then, per tool, a Contact and one tick for every pose. Field and locate are the level
/// below, for a program that finds its contacts itself. Lengths in metres, forces in newtons, body frame.
#include "palpate/adjust.hpp"
#include "palpate/animated.hpp"
#include "palpate/as_one.hpp"
#include "palpate/contact.hpp"
#include "palpate/grasp.hpp"
#include "palpate/latest.hpp"
#include "palpate/moving.hpp"
#include "palpate/open.hpp"
#include "palpate/output.hpp"
#include "palpate/passivity.hpp"
#include "palpate/several.hpp"
#include "palpate/turn.hpp"
#include "palpate/virtual_coupling.hpp"

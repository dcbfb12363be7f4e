# SPDX-License-Identifier: GPL-3.0-or-later
# palpate_settings: what every target of our own is compiled with; warnings are errors in our code only.
add_library(palpate_settings INTERFACE)
target_compile_options(palpate_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion -Werror -ffp-contract=off)

# SPDX-License-Identifier: GPL-3.0-or-later
# palpate_settings: the options of every target of our own. With PALPATE_WERROR warnings are errors, in our code only.
add_library(palpate_settings INTERFACE)
target_compile_options(palpate_settings INTERFACE
  -Wall -Wextra -Wpedantic -Wshadow -Wconversion -Wno-sign-conversion)
if(PALPATE_WERROR)
  target_compile_options(palpate_settings INTERFACE -Werror)
endif()
target_compile_options(palpate_settings INTERFACE -ffp-contract=off)

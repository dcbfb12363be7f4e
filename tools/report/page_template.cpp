// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/page_template.hpp"

#ifdef PALPATE_PAGE
// The assembler includes the file: compilers take minutes for a literal of a megabyte.
__asm__(
    ".section .rodata\n"
    ".global palpate_page_begin\n"
    ".global palpate_page_end\n"
    "palpate_page_begin:\n"
    ".incbin \"" PALPATE_PAGE
    "\"\n"
    "palpate_page_end:\n"
    ".byte 0\n"
    ".text\n");
extern "C" const char palpate_page_begin[];
extern "C" const char palpate_page_end[];
#endif

namespace palpate::report {

PageTemplate page_template() {
#ifdef PALPATE_PAGE
  return {{palpate_page_begin, static_cast<std::size_t>(palpate_page_end - palpate_page_begin)}, {}};
#else
  return {{}, PALPATE_PAGE_MISSING};
#endif
}

}  // namespace palpate::report

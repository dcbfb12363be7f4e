// SPDX-License-Identifier: MIT
// The keys of [compliance]. A scene without the section has no trace of it in its canonical text.
#include "formats/scene/scene_key_kinds.hpp"

namespace palpate::scene_io {
namespace {

using C = ComplianceScene;

/// Affects the file alone, and is shown only where contacts feel each other.
Key<C> where_shared(Key<C> key, const char* example) {
  key.affects = Affects::file;
  key.example = example;
  key.show = [show = key.show](const C& c) { return c.between == C::Between::none ? std::string() : show(c); };
  return key;
}

}  // namespace

const Keys<ComplianceScene>& compliance_keys() {
  static const Keys<C> keys{
      where_shared(choice("between", &C::between, {"none", "contacts"},
                          "Whose forces move the surface under each other; left out in the section: contacts."),
                   "\"contacts\""),
      where_shared(number("tolerance", &C::tolerance, {0, 0.99, true, ""},
                          "Error of the compliance between sites over a site's own, 95th percentile of columns left "
                          "out: it chooses the modes."),
                   "0.03"),
      where_shared(integer("modes", &C::modes, {0, 128, false, ""},
                           "Modes beside the half-space in closed form; 0: as few as the tolerance allows.", 8),
                   "0")};
  return keys;
}

}  // namespace palpate::scene_io

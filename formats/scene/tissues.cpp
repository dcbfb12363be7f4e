// SPDX-License-Identifier: MIT
// The table of tissues.
#include "formats/scene/tissues.hpp"

namespace palpate {

std::span<const Tissue> tissues() {
  static constexpr Tissue all[] = {
      {"liver", 2090, "Venkatesh et al. 2014, J Magn Reson Imaging 39:1, doi 10.1002/jmri.24084: 41 healthy adults"},
      {"kidney", 4900, "J Magn Reson Imaging 2011, 34:880, doi 10.1002/jmri.22670: 10 healthy adults, 45 Hz"},
      {"spleen", 3600, "Talwalkar et al. 2009, AJR 193:122, doi 10.2214/AJR.07.3504: 12 healthy adults"},
      {"fat", 752, "Hatt et al. 2023, J Mech Behav Biomed Mater, doi 10.1016/j.jmbbm.2023.105924: gluteal, 50 Hz"},
      {"muscle", 1000,
       "Hatt et al. 2023, J Mech Behav Biomed Mater, doi 10.1016/j.jmbbm.2023.105924: gluteal, relaxed, 50 Hz"},
      {"liver-tumour", 10100, "AJR 2008, PMC2894569: mean of malignant liver tumours"},
      {"brain", 2370, "Murphy et al. 2011, PMC3217096: median of 14 healthy elderly"}};
  return all;
}

}  // namespace palpate

// SPDX-License-Identifier: GPL-3.0-or-later
// A golden file, open, as the tests of devices take one.
#pragma once

#include <gtest/gtest.h>

#include <string>

#include "palpate/format/mapped_file.hpp"
#include "palpate/palpate.hpp"

namespace palpate::test {

struct Golden {
  runtime::MappedFile file;
  runtime::View view;
  explicit Golden(const std::string& name) : file((std::string(PALPATE_GOLDENS) + "/" + name + ".palp").c_str()) {
    const runtime::OpenResult opened = runtime::View::open(file.data(), file.size());
    EXPECT_TRUE(opened) << opened.error;
    view = opened.view;
  }
};

}  // namespace palpate::test

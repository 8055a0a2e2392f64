// SPDX-License-Identifier: MIT
#include "thermorig/core/label.h"

#include <gtest/gtest.h>

#include "thermorig/core/error.h"

namespace thermorig {
namespace {

TEST(LabelName, IsReadBack) {
  for (const Label label : {Label::commanded, Label::corrected, Label::shaft})
    EXPECT_EQ(label_named(name_of(label)), label);
  EXPECT_EQ(column_of(Label::corrected), "rate_corrected");
}

TEST(LabelName, ThatThereIsNotIsRefusedWithTheNearest) {
  EXPECT_FALSE(find_label("rate_shaft"));
  try {
    label_named("comanded");
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
    EXPECT_EQ(error.what_happened(), "there is no label \"comanded\"");
    EXPECT_EQ(error.advice(), "did you mean \"commanded\"? one of: commanded, corrected, shaft");
  }
}

}  // namespace
}  // namespace thermorig

// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/sync_policy.h"

#include <gtest/gtest.h>

#include "thermorig/core/error.h"

namespace thermorig::rig {
namespace {

TEST(SyncPolicy, IsReadAsItIsWritten) {
  for (const char* text : {"frame", "end", "10", "125", "60000"})
    EXPECT_EQ(to_text(sync_policy_from(text)), text);
  EXPECT_EQ(to_text(SyncPolicy{}), "125");
}

TEST(SyncPolicy, RefusesWhatIsNoTime) {
  for (const char* text : {"", "9", "60001", "125ms", "-1", "never", "1e3"})
    EXPECT_THROW(sync_policy_from(text), Error) << text;
}

}  // namespace
}  // namespace thermorig::rig

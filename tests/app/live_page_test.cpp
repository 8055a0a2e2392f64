// SPDX-License-Identifier: MIT
#include "live/live_page.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>

#include "web/private_folder.h"
#include "web_server/page_client.h"

namespace thermorig::app {
namespace {

TEST(LivePage, ItsOrdersBecomeTheRecordings) {
  const web::PrivateFolder folder;
  ASSERT_EQ(setenv("XDG_STATE_HOME", folder.path().c_str(), 1), 0);
  LivePage page({.serve = true, .port = 0, .control = true});
  unsetenv("XDG_STATE_HOME");
  LiveRun run({}, {}, estimators::Bank({}, {}, RigProfile()));
  const std::string token = web::token_of(page.server().url());
  web::PageClient client(page.server().port());
  EXPECT_EQ(client.post("/start", token, "{}").status, 204);
  EXPECT_EQ(client.post("/mark", token, R"({"note":"a bird"})").status, 204);
  EXPECT_EQ(client.post("/stop", token, "{}").status, 204);
  const std::vector<rig::Order> orders = orders_of(run, &page);
  ASSERT_EQ(orders.size(), 3U);
  EXPECT_EQ(orders[0].kind, rig::OrderKind::start);
  EXPECT_EQ(orders[1].kind, rig::OrderKind::mark);
  EXPECT_EQ(orders[1].note, "a bird");
  EXPECT_EQ(orders[2].kind, rig::OrderKind::stop);
  EXPECT_EQ(orders[2].note, "the page") << "who it was is kept";
  EXPECT_TRUE(orders_of(run, &page).empty()) << "each is carried out once";
}

}  // namespace
}  // namespace thermorig::app

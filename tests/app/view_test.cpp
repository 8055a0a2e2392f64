// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <signal.h>

#include <filesystem>

#include "program.h"
#include "support/file_text.h"
#include "support/hand_clock.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class View : public ProgramTest {
 protected:
  void expect_refused(const std::string& arguments, int code, const std::string& words) const {
    const Outcome outcome = run(arguments);
    EXPECT_EQ(outcome.code, code) << arguments;
    EXPECT_THAT(outcome.err, HasSubstr(words)) << arguments;
  }
};

TEST_F(View, WritesOneFileThatHoldsThePageAndTheSession) {
  const std::string session = record_briefly().string();
  const Outcome outcome = run("inspect --html look.html " + session);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr("rig       SIMULATED"));
  EXPECT_THAT(outcome.out, HasSubstr("written   look.html: "));
  EXPECT_THAT(outcome.out, Not(HasSubstr("left out")));
  const std::string page = file_text(folder() / "look.html");
  EXPECT_LT(page.size(), 5'000'000U);
  for (const char* part : {"data-facts", "data-rows", "data-images-0", "data-packing"})
    EXPECT_THAT(page, HasSubstr(std::string("id=\"") + part + "\">"));
  EXPECT_THAT(page, Not(HasSubstr("src=\"/"))) << "nothing is fetched";
  EXPECT_THAT(page, Not(HasSubstr("href=\"/")));
}

TEST_F(View, WritesThePageToStandardOutputAndNothingElse) {
  const std::string session = record_briefly().string();
  ASSERT_EQ(run("inspect --html look.html " + session).code, 0);
  const Outcome outcome = run("inspect --html - " + session);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.out, file_text(folder() / "look.html"));
  EXPECT_FALSE(std::filesystem::exists(folder() / "-"));
  expect_refused("inspect --json --html - " + session, 2, "leave out --json");
}

TEST_F(View, SaysInJsonWhatItWrote) {
  const std::string session = record_briefly().string();
  const auto written = run("inspect --json --html look.html " + session).lines()[0];
  EXPECT_EQ(written["bytes"], std::filesystem::file_size(folder() / "look.html"));
  EXPECT_EQ(written["image_every"], 1);
  EXPECT_EQ(written["row_every"], 1);
  EXPECT_EQ(written["simulated"], true);
}

TEST_F(View, RefusesWhatItCannotShow) {
  const std::string session = record_briefly().string();
  write("look.html", {});
  expect_refused("inspect --html look.html " + session, 7, "look.html");
  EXPECT_EQ(std::filesystem::file_size(folder() / "look.html"), 0U);
  expect_refused("inspect --html new.html " + session + " " + session, 2, "--html takes one session");
  expect_refused("inspect --html new.html --timing " + session, 2, "leave out --check and --timing");
  expect_refused("inspect --html new.html nowhere.h5", 2, "nowhere.h5");
  expect_refused("view nowhere.h5", 2, "nowhere.h5");
  write("no_session.h5", std::vector<std::uint8_t>(1000, 'x'));
  expect_refused("view no_session.h5", 8, "no_session.h5");
  expect_refused("inspect --html new.html no_session.h5", 8, "no_session.h5");
  EXPECT_FALSE(std::filesystem::exists(folder() / "new.html"));
}

TEST_F(View, SaysInJsonWhereItServes) {
  const std::string session = record_briefly().string();
  const pid_t process = start({"view", "--json", "--page-port", "0", session});
  const auto is_served = [&] { return !file_text(folder() / "background_out.txt").empty(); };
  EXPECT_TRUE(comes_true(is_served));
  kill(process, SIGINT);
  const Outcome outcome = wait(process);
  const auto lines = outcome.lines();
  ASSERT_EQ(lines.size(), 2U) << outcome.out;
  EXPECT_EQ(lines[0]["event"], "ready");
  EXPECT_GT(lines[0]["page_port"], 0);
  EXPECT_EQ(lines[1]["event"], "summary");
  EXPECT_THAT(outcome.err, HasSubstr("page  http://127.0.0.1:"));
}

// As `view > log` of a user whose files others may read: the test's own output is such a file.
TEST_F(View, KeepsItsAddressWhereOnlyItsUserReadsIt) {
  ASSERT_EQ(setenv("XDG_STATE_HOME", folder().c_str(), 1), 0);
  const pid_t process = start({"view", "--page-port", "0", record_briefly().string()});
  unsetenv("XDG_STATE_HOME");
  const std::filesystem::path kept = folder() / "thermorig" / "view.json";
  EXPECT_TRUE(comes_true([&] {
    return file_text(folder() / "background_out.txt").find("Ctrl-C ends it") != std::string::npos;
  }));
  EXPECT_THAT(file_text(kept), HasSubstr("http://127.0.0.1:"));
  kill(process, SIGINT);
  EXPECT_THAT(wait(process).out, HasSubstr("is under \"url\" in " + kept.string()));
}

TEST_F(View, ServesUntilItIsInterrupted) {
  const std::string session = record_briefly().string();
  const pid_t process = start({"view", "--page-port", "0", session});
  const auto is_served = [&] {
    return file_text(folder() / "background_out.txt").find("Ctrl-C ends it") != std::string::npos;
  };
  EXPECT_TRUE(comes_true(is_served));
  kill(process, SIGINT);
  const Outcome outcome = wait(process);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_THAT(outcome.out, HasSubstr(" frames\npage  http://127.0.0.1:"));
}

}  // namespace
}  // namespace thermorig::tests

// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <functional>

#include "program.h"
#include "thermorig/network/model/model.h"

namespace thermorig::tests {
namespace {

using ::testing::HasSubstr;
namespace fs = std::filesystem;

/// What may stand in place of a file.
struct Kind {
  const char* name;
  std::function<void(const fs::path& at)> put;
};

const std::vector<Kind>& kinds() {
  static const std::vector<Kind> all{
      {"pipe", [](const fs::path& at) { ASSERT_EQ(::mkfifo(at.c_str(), 0600), 0); }},
      {"device", [](const fs::path& at) { fs::create_symlink("/dev/zero", at); }},
      {"folder", [](const fs::path& at) { fs::create_directory(at); }},
      {"dangling", [](const fs::path& at) { fs::create_symlink("nowhere", at); }},
      {"loop", [](const fs::path& at) { fs::create_symlink(at.filename(), at); }},
      {"empty", [](const fs::path& at) { std::ofstream(at).flush(); }},
      {"unreadable", [](const fs::path& at) {
         std::ofstream(at) << "something";
         ASSERT_EQ(::chmod(at.c_str(), 0), 0);
       }}};
  return all;
}

/// A command that opens the file X, and its exit codes for the kinds, in their order. A folder may stand for
/// the sessions in it, of which there are none.
struct Opener {
  const char* words;
  std::vector<int> codes;
};

const std::vector<int> of_session{8, 8, 2, 2, 2, 8, 6}, of_model{8, 8, 8, 2, 2, 8, 6},
    of_settings{2, 2, 2, 2, 2, 2, 6};

const std::vector<Opener>& openers() {
  static const std::vector<Opener> all{{"inspect X", of_session},
                                       {"reprocess X", of_session},
                                       {"list X", of_session},
                                       {"train X -o trained.onnx", of_session},
                                       {"evaluate model.onnx X", of_session},
                                       {"evaluate --live X", of_session},
                                       {"inspect --html page.html X", of_session},
                                       {"export X --csv -o exported", of_session},
                                       {"annotate X --note something", of_session},
                                       {"live --replay X --no-page", of_session},
                                       {"export X --c-header -o exported", of_model},
                                       {"evaluate X recordings", of_model},
                                       {"live --simulated --fast --no-page --speeds 40 --model X", of_model},
                                       {"recover X", {8, 8, 0, 2, 2, 8, 6}},
                                       {"dataset verify X", {2, 2, 2, 2, 2, 2, 2}},
                                       {"decode X --device gyro", {2, 2, 2, 2, 2, 4, 6}},
                                       {"record --fast --simulated -e garden --plan ./X", of_settings},
                                       {"record --fast --simulated -e garden --rig ./X", of_settings},
                                       {"doctor --rig ./X", of_settings}};
  return all;
}

class SpecialFiles : public ProgramTest {
 protected:
  void expect_refusals(const Opener& opener) const {
    for (std::size_t i = 0; i < kinds().size(); ++i) {
      const Kind& kind = kinds()[i];
      if (kind.name == std::string("unreadable") && ::geteuid() == 0) continue;  // root reads it
      const std::string name = std::string(kind.name) + ".h5";
      std::string words = opener.words;
      words.replace(words.find('X'), 1, name);
      if (words.starts_with("decode") && kind.name == std::string("pipe")) continue;  // waits for who writes
      const Outcome outcome = run(words + " < /dev/null");
      EXPECT_EQ(outcome.code, opener.codes[i]) << words << "\n" << outcome.err;
      if (opener.codes[i] == 0) continue;
      EXPECT_THAT(outcome.err, HasSubstr(name)) << words;
      EXPECT_THAT(outcome.err, HasSubstr("\n  try: ")) << words;
    }
  }
};

TEST_F(SpecialFiles, AreRefusedByEveryCommandThatOpensOneWithTheSameCodes) {
  model::Model model;
  model.weights = network::initial_weights({.frames = 3, .reduction = 3}, 4);
  model::write_model(folder() / "model.onnx", model);
  for (const Kind& kind : kinds()) kind.put(folder() / (std::string(kind.name) + ".h5"));
  for (const Opener& opener : openers()) expect_refusals(opener);
}

TEST_F(SpecialFiles, InAFolderAreSkippedWhereTheyAreNoFilesAndNamedWhereTheyAreNoSessions) {
  const fs::path session = record_briefly();
  for (const Kind& kind : kinds()) {
    if (kind.name == std::string("unreadable") && ::geteuid() == 0) continue;
    const fs::path at = session.parent_path() / "x.h5";
    kind.put(at);
    const bool is_file = fs::is_regular_file(fs::symlink_status(at));
    const Outcome outcome = run("list recordings");
    EXPECT_EQ(outcome.code == 0, !is_file) << kind.name << outcome.err;
    EXPECT_THAT(outcome.out, HasSubstr("1 session: ")) << kind.name;
    EXPECT_EQ(run("dataset build recordings --title x").code, kind.name == std::string("unreadable") ? 6 : 8)
        << kind.name;
    fs::remove(at);
  }
  EXPECT_EQ(run("dataset build recordings --title x").code, 0);
}

}  // namespace
}  // namespace thermorig::tests

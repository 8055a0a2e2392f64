// SPDX-License-Identifier: MIT
// Files that several programs want: two commands on one session, h5py beside one, a command that was killed.
#include <gmock/gmock.h>
#include <sys/stat.h>

#include <algorithm>

#include "program.h"
#include "support/file_text.h"
#include "support/other_program.h"

namespace thermorig::tests {
namespace {

namespace fs = std::filesystem;
using ::testing::AnyOf;
using ::testing::HasSubstr;

class OneFile : public ProgramTest {
 protected:
  nlohmann::json inspected(const fs::path& session) const {
    return run("inspect --json " + session.string()).lines()[0][0];
  }

  bool has_annotation(const fs::path& session, const std::string& text) const {
    const auto annotations = inspected(session)["annotations"];
    return std::any_of(annotations.begin(), annotations.end(), [&](const nlohmann::json& annotation) {
      return annotation.value("text", annotation.value("environment", "")) == text;
    });
  }

  /// The one session that there is; none of a move is left half done, and no part of any file.
  fs::path only_session() const {
    EXPECT_TRUE(files(".part").empty());
    const auto sessions = files(".h5");
    EXPECT_EQ(sessions.size(), 1U);
    return sessions.empty() ? fs::path() : sessions[0];
  }
};

using PairsOfCommands = OneFile;

TEST_F(PairsOfCommands, OnOneSessionLoseNeitherEdit) {
  struct Command {
    std::vector<std::string> words;
    std::string edit;  // the annotation that it makes, if it does
  };
  const Command note{{"annotate", "--note", "one"}, "one"}, other_note{{"annotate", "--note", "two"}, "two"},
      exclusion{{"annotate", "--exclude", "5..8", "--reason", "a hand"}, "a hand"},
      move{{"annotate", "--environment", "kitchen"}, "kitchen"}, reprocess{{"reprocess"}, ""};
  const std::pair<Command, Command> pairs[] = {{note, other_note},     {note, exclusion}, {note, reprocess},
                                               {reprocess, exclusion}, {note, move},      {move, exclusion},
                                               {reprocess, move},      {move, move}};
  for (auto [one, other] : pairs) {
    const std::string session = record_briefly().string();
    one.words.push_back(session), other.words.push_back(session);
    const pid_t first = start(one.words), second = start(other.words);
    const Outcome ends[] = {wait(first), wait(second)};
    const fs::path left = only_session();
    const Command* const commands[] = {&one, &other};
    for (int i = 0; i < 2; ++i) {
      // 6: it is in use; 2: it has moved away.
      EXPECT_THAT(ends[i].code, AnyOf(0, 6, 2)) << commands[i]->words[1] << ends[i].err;
      if (ends[i].code != 0 || commands[i]->edit.empty()) continue;
      EXPECT_TRUE(has_annotation(left, commands[i]->edit)) << commands[i]->edit << " is lost";
    }
    EXPECT_TRUE(ends[0].code == 0 || ends[1].code == 0) << ends[0].err;
    EXPECT_EQ(run("inspect --check " + left.string()).code, 0);
    fs::remove_all(folder() / "recordings");
  }
}

/// A notebook that has the session open, in each way that h5py knows.
TEST_F(OneFile, ThatH5pyHasOpenToWriteIsRefusedAndItsHolderNamed) {
  if (!python_has("h5py")) GTEST_SKIP();
  struct Row {
    const char *mode, *locks;
    int code;
  };
  for (const Row& row : {Row{"r+", "TRUE", 6}, Row{"r+", "FALSE", 6}, Row{"r", "TRUE", 0}}) {
    const std::string session = record_briefly().string();
    for (const std::string command : {"annotate --note x ", "reprocess "}) {
      const Printed printed = run_other(
          "HDF5_USE_FILE_LOCKING=" + std::string(row.locks) + " /usr/bin/python3 -c '" +
          "import h5py, os, subprocess; f = h5py.File(\"" + session + "\", \"" + row.mode + "\")\n" +
          "r = subprocess.run(\"" + THERMORIG_PROGRAM + " " + command + session +
          "\", shell=True, capture_output=True, text=True)\n" +
          "print(r.returncode, \"its own pid\" if str(os.getpid()) + \" (python3)\" in r.stderr else \"\", "
          "r.stderr)'");
      EXPECT_THAT(printed.text,
                  ::testing::StartsWith(std::to_string(row.code) + (row.code == 0 ? " " : " its own pid")))
          << command << row.mode << row.locks;
    }
    fs::remove_all(folder() / "recordings");
  }
}

/// Whatever is written again is written where it was, for those who could read it.
TEST_F(OneFile, ThatIsWrittenAgainStaysPrivateAndBehindItsLink) {
  const fs::path session = record_briefly();
  ASSERT_EQ(run("simulate --help").code, 0);
  fs::create_directory(folder() / "far");
  struct Row {
    std::string command, file;
  };
  const std::string name = session.filename().string();
  fs::rename(session, folder() / "far" / name);
  fs::create_symlink(folder() / "far" / name, session);
  ASSERT_EQ(run("calibrate bias --world honest --simulated=3 --fast --save ./rig.toml").code, 0);
  fs::rename(folder() / "rig.toml", folder() / "far" / "rig.toml");
  fs::create_symlink("far/rig.toml", folder() / "rig.toml");
  const Row rows[] = {{"annotate --note x " + session.string(), name},
                      {"reprocess " + session.string(), name},
                      {"calibrate bias --world honest --simulated=4 --fast --save ./rig.toml", "rig.toml"}};
  for (const Row& row : rows) {
    const fs::path file = folder() / "far" / row.file;
    fs::permissions(file, fs::perms{0600});
    struct stat before {
    }, after{};
    ASSERT_EQ(::stat(file.c_str(), &before), 0);
    const Outcome outcome = run(row.command);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    ASSERT_EQ(::stat(file.c_str(), &after), 0);
    EXPECT_NE(before.st_ino, after.st_ino) << "it was not written: " << row.command;
    EXPECT_EQ(after.st_mode & ALLPERMS, 0600U) << row.command;
  }
  EXPECT_TRUE(fs::is_symlink(session));
  EXPECT_TRUE(fs::is_symlink(folder() / "rig.toml"));
}

TEST_F(OneFile, OfANameThatLeavesNoRoomForAPartIsRefusedAtTheStart) {
  // However short the host's name and the process's number are, which a part has in its name.
  const fs::path session = record_briefly();
  const fs::path named = folder() / (std::string(250, 'x') + ".h5");
  fs::rename(session, named);
  for (const std::string& command :
       {"annotate --note x " + named.string(), "train . -o " + std::string(245, 'm') + ".onnx",
        "reprocess " + named.string(),
        "live --replay " + named.string() + " --speed max --map " + std::string(250, 'm'),
        "calibrate bias --simulated=3 --fast --save ./" + std::string(245, 'p') + ".toml"}) {
    const Outcome outcome = run(command);
    EXPECT_EQ(outcome.code, 7) << command << outcome.err;
    EXPECT_THAT(outcome.err, HasSubstr("shorter name")) << command;
    EXPECT_EQ(outcome.out, "") << "it has begun: " << command;
  }
}

/// What is built in memory has no disk to blame.
TEST_F(OneFile, ThatNeedsMoreMemoryThanThereIsSaysSo) {
  const std::string session = record_briefly().string(), before = file_text(session);
  const Printed printed =
      run_other("ulimit -v 60000; " + std::string(THERMORIG_PROGRAM) + " annotate --note x " + session);
  EXPECT_EQ(printed.code, 1) << printed.text;
  EXPECT_THAT(printed.text, HasSubstr("not enough memory"));
  EXPECT_EQ(file_text(session), before);
}

class KilledMove : public OneFile {
 protected:
  /// What a command that moves `session` leaves when it is killed before its last step: both files.
  fs::path moved_but_not_gone(const fs::path& session, const std::string& words) const {
    fs::copy_file(session, folder() / "kept");
    const Outcome outcome = run("annotate --json " + session.string() + " " + words);
    EXPECT_EQ(outcome.code, 0) << outcome.err;
    fs::rename(folder() / "kept", session);
    return folder() / std::string(outcome.lines()[0]["file"]);
  }
};

TEST_F(KilledMove, IsEndedByTheSameCommand) {
  const fs::path session = record_briefly();
  const fs::path moved = moved_but_not_gone(session, "--environment kitchen");
  const Outcome again = run("annotate --json " + session.string() + " --environment kitchen");
  EXPECT_EQ(again.code, 0) << again.err;
  EXPECT_EQ(fs::path(std::string(again.lines()[0]["file"])), moved);
  EXPECT_EQ(only_session(), moved);
  EXPECT_EQ(inspected(moved)["acquisition"], 1);
  EXPECT_EQ(inspected(moved)["annotations"].size(), 1U);
}

TEST_F(KilledMove, BackIsEndedByTheSameCommand) {
  const fs::path session = record_briefly();
  const fs::path moved =
      folder() /
      std::string(run("annotate --json " + session.string() + " --environment kitchen").lines()[0]["file"]);
  EXPECT_EQ(moved_but_not_gone(moved, "--undo"), session);
  EXPECT_EQ(run("annotate " + moved.string() + " --undo").code, 0);
  EXPECT_EQ(only_session(), session);
}

TEST_F(KilledMove, ThatLeftAPartHasItsNumberAgain) {
  const fs::path session = record_briefly();
  const std::string host = run_other("hostname").text;
  const auto left_part_at = [&](const fs::path& path) {
    fs::create_directories(path.parent_path());
    write(path.string() + "." + host.substr(0, host.size() - 1) + ".1073741823.part", {});
  };
  fs::path moved = folder() / "recordings" / "kitchen" / session.filename();
  moved.replace_filename("kitchen" + session.filename().string().substr(std::string("garden").size()));
  left_part_at(moved);
  EXPECT_EQ(run("annotate " + session.string() + " --environment kitchen").code, 0);
  EXPECT_EQ(only_session(), moved);
  left_part_at(session);
  EXPECT_EQ(run("annotate " + moved.string() + " --undo").code, 0);
  EXPECT_EQ(only_session(), session);
}

TEST_F(KilledMove, WhoseOldFileWasAnnotatedMeanwhileIsNotEndedSilently) {
  const fs::path session = record_briefly();
  moved_but_not_gone(session, "--environment kitchen");
  EXPECT_EQ(run("annotate " + session.string() + " --note x").code, 0);
  const Outcome again = run("annotate " + session.string() + " --environment kitchen");
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.err, HasSubstr("the same recording is there already, with other annotations"));
  EXPECT_EQ(files(".h5").size(), 2U);
}

/// As version 0.1 left it: what it says is new, its name is not.
TEST_F(KilledMove, OfAnEarlierVersionIsEndedToo) {
  for (const std::string words : {"--environment kitchen", "--undo"}) {
    const fs::path session = record_briefly();
    const fs::path moved = moved_but_not_gone(session, "--environment kitchen");
    fs::rename(moved, session);
    EXPECT_EQ(run("annotate " + session.string() + " " + words).code, 0) << words;
    EXPECT_EQ(only_session(), words == "--undo" ? session : moved);
    fs::remove_all(folder() / "recordings");
  }
}

TEST_F(KilledMove, LeavesAPartThatRecoverRemovesAndNames) {
  const fs::path session = record_briefly();
  const std::string host = run_other("hostname").text;
  const fs::path part = session.string() + "." + host.substr(0, host.size() - 1) + ".1073741823.part";
  fs::copy_file(session, part);
  EXPECT_THAT(run("doctor").out, HasSubstr(part.filename().string()));
  const Outcome outcome = run("recover recordings --json");
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  EXPECT_EQ(outcome.lines()[0].back()["result"], "removed");
  EXPECT_EQ(outcome.lines()[0].back()["source"], part.lexically_relative(folder()).string());
  EXPECT_EQ(only_session(), session);
}

}  // namespace
}  // namespace thermorig::tests

// SPDX-License-Identifier: MIT
#include "program.h"
#include "support/file_text.h"

#include <fcntl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <fstream>
#include <sstream>

namespace thermorig::tests {

namespace {

int code_of(int status) {
  return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
}

void redirect(const std::filesystem::path& file, int descriptor) {
  const int opened = open(file.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
  dup2(opened, descriptor);
}

namespace fs = std::filesystem;

/// Where the sessions of these recordings are kept for the tests of this build of the program.
fs::path kept_recordings(const std::vector<std::string>& recordings) {
  const auto build = std::to_string(fs::last_write_time(THERMORIG_PROGRAM).time_since_epoch().count());
  std::string words;
  for (const std::string& recording : recordings) words += recording + "\n";
  return fs::path(THERMORIG_BINARY_DIR) / "recorded_for_tests" / build /
         std::to_string(std::hash<std::string>{}(words));
}

/// For the tests that come later. Another test may have been faster: a folder that is not empty is not
/// replaced.
void keep(const fs::path& recorded, const fs::path& kept, const std::string& unique) {
  fs::create_directories(kept.parent_path());
  const fs::path copy = kept.string() + unique;
  fs::copy(recorded, copy, fs::copy_options::recursive);
  std::error_code is_there;
  fs::rename(copy, kept, is_there);
  if (is_there) fs::remove_all(copy);
  std::error_code ignored;  // another test removes it, too
  for (const auto& build : fs::directory_iterator(kept.parent_path().parent_path(), ignored))
    if (build.path() != kept.parent_path()) fs::remove_all(build.path(), ignored);  // of older builds
}

}  // namespace

Checked<nlohmann::json> Outcome::lines() const {
  Checked<nlohmann::json> values;
  std::istringstream stream(out);
  for (std::string line; std::getline(stream, line);) {
    values.push_back(nlohmann::json::parse(line, nullptr, false));
    EXPECT_FALSE(values.back().is_discarded()) << line;
  }
  return values;
}

ProgramTest::ProgramTest() {
  std::string name = (std::filesystem::temp_directory_path() / "thermorig-test-XXXXXX").string();
  if (mkdtemp(name.data()) == nullptr) std::abort();
  folder_ = name;
  setenv("COLUMNS", "1000", 1);  // sentences in one piece
}

ProgramTest::~ProgramTest() {
  std::error_code ignored;
  std::filesystem::remove_all(folder_, ignored);
}

Outcome ProgramTest::run(const std::string& arguments) const {
  const std::string command =
      "cd " + folder_.string() + " && " + THERMORIG_PROGRAM + " " + arguments + " >out.txt 2>err.txt";
  const int status = std::system(command.c_str());
  return {code_of(status), file_text(folder_ / "out.txt"), file_text(folder_ / "err.txt")};
}

Outcome ProgramTest::run_with_files_up_to(int kib, const std::string& arguments) const {
  const std::string command = "cd " + folder_.string() + " && ulimit -f " + std::to_string(2 * kib) + " && " +
                              THERMORIG_PROGRAM + " " + arguments + " >out.txt 2>err.txt";
  const int status = std::system(command.c_str());
  return {code_of(status), file_text(folder_ / "out.txt"), file_text(folder_ / "err.txt")};
}

Outcome ProgramTest::run_on_terminal(const std::string& settings, const std::string& arguments) const {
  const std::string command = "cd " + folder_.string() + " && COLUMNS= " + settings + " script -qec '" +
                              THERMORIG_PROGRAM + " " + arguments + "' /dev/null >out.txt 2>err.txt";
  const int status = std::system(command.c_str());
  return {code_of(status), file_text(folder_ / "out.txt"), file_text(folder_ / "err.txt")};
}

pid_t ProgramTest::start(const std::vector<std::string>& arguments) const {
  const pid_t process = fork();
  if (process != 0) return process;
  redirect(folder_ / "background_out.txt", STDOUT_FILENO);
  redirect(folder_ / "background_err.txt", STDERR_FILENO);
  std::vector<char*> words{const_cast<char*>(THERMORIG_PROGRAM)};
  for (const std::string& argument : arguments) words.push_back(const_cast<char*>(argument.c_str()));
  words.push_back(nullptr);
  if (chdir(folder_.c_str()) == 0) execv(THERMORIG_PROGRAM, words.data());
  _exit(127);
}

Outcome ProgramTest::wait(pid_t process) const {
  int status = 0;
  waitpid(process, &status, 0);
  return {code_of(status), file_text(folder_ / "background_out.txt"),
          file_text(folder_ / "background_err.txt")};
}

void ProgramTest::record_once(const std::vector<std::string>& recordings) const {
  const fs::path ours = folder_ / "recordings", kept = kept_recordings(recordings);
  const bool is_first = !fs::exists(ours);
  if (is_first && fs::exists(kept)) return fs::copy(kept, ours, fs::copy_options::recursive);
  for (const std::string& words : recordings) {
    const Outcome outcome = run("record --fast " + words);
    ASSERT_EQ(outcome.code, 0) << outcome.err;
  }
  if (is_first) keep(ours, kept, folder_.filename().string());
}

std::filesystem::path ProgramTest::record_briefly() const {
  const auto before = files(".h5");
  record_once({"--world honest --simulated=3 --environment garden " + brief_plan});
  for (const auto& file : files(".h5"))
    if (std::find(before.begin(), before.end(), file) == before.end()) return file;
  ADD_FAILURE() << "there is no new session";
  return {};
}

std::filesystem::path ProgramTest::write(const std::string& name, std::span<const std::uint8_t> bytes) const {
  std::ofstream file(folder_ / name, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  return folder_ / name;
}

Checked<std::filesystem::path> ProgramTest::files(const std::string& extension) const {
  Checked<std::filesystem::path> found;
  for (const auto& entry : std::filesystem::recursive_directory_iterator(folder_))
    if (entry.path().extension() == extension) found.push_back(entry.path());
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace thermorig::tests

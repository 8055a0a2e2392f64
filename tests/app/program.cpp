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
  const std::string command = "cd " + folder_.string() + " && " + settings + " script -qec '" +
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

std::filesystem::path ProgramTest::record_briefly() const {
  const Outcome outcome =
      run("record --world honest --simulated=3 --fast --environment garden --json " + brief_plan);
  EXPECT_EQ(outcome.code, 0) << outcome.err;
  const auto lines = outcome.lines();
  if (lines.empty()) return {};
  return folder_ / lines.back().value("session", "");
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

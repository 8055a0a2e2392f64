// SPDX-License-Identifier: MIT
#include "session_files.h"

#include <fmt/format.h>
#include <unistd.h>

#include <charconv>
#include <iostream>

#include "print/output.h"
#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"
#include "thermorig/io/files/existing.h"
#include "thermorig/learning/dataset/dataset.h"
#include "thermorig/storage/journal/journal.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::app {

namespace fs = std::filesystem;

std::vector<fs::path> session_files_at(const fs::path& path) {
  files::require_existing(path);
  std::error_code hidden;  // opening it says why
  if (!fs::is_directory(path, hidden)) return {path};
  return dataset::find_sessions({path});
}

std::vector<fs::path> session_files_at(const std::vector<fs::path>& paths) {
  std::vector<fs::path> files;
  for (const fs::path& path : paths) {
    const std::vector<fs::path> there = session_files_at(path);
    files.insert(files.end(), there.begin(), there.end());
  }
  return files;
}

fs::path one_session_at(const fs::path& path) {
  const std::vector<fs::path> files = session_files_at(path);
  if (files.size() == 1) return files.front();
  throw Error(ExitCode::bad_usage,
              fmt::format("the folder holds {} sessions, and one is needed", files.size()), path.string(),
              "name it, e.g. " + shell_word(files.back().string()));
}

fs::path chosen_session_at(const fs::path& path) {
  if (isatty(STDIN_FILENO) == 0 || isatty(STDOUT_FILENO) == 0) return one_session_at(path);
  const std::vector<fs::path> files = session_files_at(path);
  if (files.size() == 1) return files.front();
  for (std::size_t i = 0; i < files.size(); ++i) print("{:>4}  {}\n", i + 1, printable(files[i].string()));
  print("\nWhich one? 1 to {}: ", files.size());
  flush_output();
  std::string answer;
  std::size_t number = 0;
  if (std::getline(std::cin, answer)) std::from_chars(answer.data(), answer.data() + answer.size(), number);
  if (number >= 1 && number <= files.size()) return files[number - 1];
  throw Error(ExitCode::bad_usage, "no session was chosen", path.string(),
              "a number of the list, or name it, e.g. " + shell_word(files.back().string()));
}

files::ReplacedFile locked_session(const fs::path& path) {
  files::ReplacedFile old = session::replaced_session(path);
  old.lock();
  return old;
}

void refuse_journal(const std::filesystem::path& path) {
  if (!std::filesystem::is_regular_file(path) || !journal::is_journal(path)) return;
  throw Error(ExitCode::not_a_session, "this is a journal, not yet a session", path.string(),
              "thermorig recover " + shell_word(path.string()));
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include "thermorig/io/files/process.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <fstream>
#include <optional>
#include <sstream>

namespace thermorig::files {

namespace {

namespace fs = std::filesystem;

/// What may stand in a file's name, on every file system.
std::string safe_word(std::string text) {
  constexpr std::size_t longest = 64;
  text.resize(std::min(text.size(), longest));
  std::replace_if(
      text.begin(), text.end(),
      [](char c) {
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        return !letter && !(c >= '0' && c <= '9') && c != '-' && c != '_' && c != '.';
      },
      '_');
  return text;
}

std::string host_name() {
  std::array<char, 256> name{};
  if (::gethostname(name.data(), name.size() - 1) != 0 || name[0] == '\0') return "unknown";
  return safe_word(name.data());
}

std::string boot_of(const fs::path& proc) {
  std::string boot;
  std::ifstream file(proc / "sys/kernel/random/boot_id");
  std::getline(file, boot);
  return safe_word(boot);
}

/// "pid:[4026531836]" to its number.
std::uint64_t space_of(const fs::path& proc) {
  std::error_code hidden;
  const std::string link = fs::read_symlink(proc / "self/ns/pid", hidden).string();
  const std::size_t digits = link.find_first_of("0123456789");
  std::uint64_t space = 0;
  if (digits != std::string::npos) std::from_chars(link.data() + digits, link.data() + link.size(), space);
  return space;
}

/// A line of /proc/<number>/stat.
struct ProcessStatus {
  char state = '?';
  std::uint64_t start = 0;
};

std::optional<ProcessStatus> status_of(std::uint64_t number, const fs::path& proc) {
  std::ifstream file(proc / std::to_string(number) / "stat");
  std::string line;
  std::getline(file, line);
  const std::size_t name_end = line.rfind(')');  // the program's name may hold anything
  if (name_end == std::string::npos) return std::nullopt;
  std::istringstream fields(line.substr(name_end + 1));
  ProcessStatus status;
  std::string passed_over;
  fields >> status.state;
  constexpr int fields_between = 18;
  for (int i = 0; i < fields_between; ++i) fields >> passed_over;
  if (!(fields >> status.start)) return std::nullopt;
  return status;
}

}  // namespace

std::string text_of(const Process& process) {
  return fmt::format("{}, process {}", process.host, process.number);
}

Process this_process(const fs::path& proc) {
  Process process{.host = host_name(), .boot = boot_of(proc), .space = space_of(proc)};
  process.number = static_cast<std::uint64_t>(::getpid());
  if (const auto status = status_of(process.number, proc)) process.start = status->start;
  return process;
}

Life life_of(const Process& process, const fs::path& proc) {
  const Process own = this_process(proc);
  const bool is_near = !own.boot.empty() && process.boot == own.boot && own.space != 0 &&
                       process.space == own.space && process.host == own.host;
  if (!is_near || process.number == 0) return Life::unknown;
  const auto status = status_of(process.number, proc);
  if (!status)
    return is_unused(process.number) ? Life::ended : Life::unknown;  // those of others may be hidden
  constexpr std::string_view ended = "ZX";                           // its parent has not asked for it yet
  const bool is_it = status->start == process.start && ended.find(status->state) == std::string_view::npos;
  return is_it ? Life::runs : Life::ended;
}

bool has_ended(const Process& process, const fs::path& proc) {
  return life_of(process, proc) == Life::ended;
}

bool is_unused(std::uint64_t number) {
  constexpr std::uint64_t most = 1ULL << 30U;  // the system gives at most 2^22
  if (number == 0 || number > most) return false;
  return ::kill(static_cast<pid_t>(number), 0) != 0 && errno == ESRCH;
}

}  // namespace thermorig::files

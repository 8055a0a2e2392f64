// SPDX-License-Identifier: MIT
#include "thermorig/io/files/holder.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <string>

#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"

namespace thermorig::files {

namespace {

namespace fs = std::filesystem;

/// Of an open file, by its folder in /proc and its number. It ends meanwhile: not.
bool can_write(const fs::path& process, const fs::path& number) {
  std::ifstream info(process / "fdinfo" / number);
  std::string word;
  while (info >> word && word != "flags:") continue;
  unsigned flags = 0;
  return static_cast<bool>(info >> std::oct >> flags) && (flags & O_ACCMODE) != O_RDONLY;
}

bool holds(const fs::path& process, const fs::path& path, Use use) {
  std::error_code error;
  // Processes of other users cannot be looked into: the iterator then starts at its end.
  for (fs::directory_iterator fd(process / "fd", error), end; !error && fd != end; fd.increment(error)) {
    std::error_code gone;
    const fs::path held = fs::read_symlink(fd->path(), gone);
    if (gone || held != path) continue;
    if (use == Use::any || can_write(process, fd->path().filename())) return true;
  }
  return false;
}

std::string command_of(const fs::path& process) {
  std::string name;
  std::ifstream comm(process / "comm");
  std::getline(comm, name);
  return printable(name);
}

bool is_process_folder(const std::string& name) {
  return name.find_first_not_of("0123456789") == std::string::npos;
}

/// The name by which the system knows what is open.
fs::path system_name(const fs::path& path) {
  std::error_code hidden;
  fs::path name = fs::weakly_canonical(path, hidden);
  return hidden ? path : name;
}

}  // namespace

std::optional<std::string> other_holder_of(const fs::path& path, Use use, const fs::path& proc) {
  const std::string own = std::to_string(::getpid());
  const fs::path held = system_name(path);
  std::error_code error;
  for (fs::directory_iterator process(proc, error), end; !error && process != end; process.increment(error)) {
    const std::string name = process->path().filename();
    if (!is_process_folder(name) || name == own || !holds(process->path(), held, use)) continue;
    return fmt::format("process {} ({})", name, command_of(process->path()));
  }
  return std::nullopt;
}

std::string holder_of(const fs::path& path) {
  if (auto other = other_holder_of(path)) return *other;
  return holds("/proc/self", system_name(path), Use::any) ? "this process" : "another program";
}

namespace {

OpenFile opened(const std::filesystem::path& path, Disk& disk) {
  const auto opened = disk.open_to_lock(path);
  if (!opened.good())
    throw Error(ExitCode::storage, std::string("cannot be opened: ") + std::strerror(opened.error_number),
                path.string(), "check its permissions");
  return opened.value;
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& path, Wait wait, Disk& disk)
    : file_(disk, opened(path, disk)) {
  const int result = disk.lock(file_.get(), wait);
  // A file system without locks (some of the network): one program at a time is up to the user there.
  held_ = result != EWOULDBLOCK;
  certain_ = result == 0;
}

}  // namespace thermorig::files

// SPDX-License-Identifier: MIT
#include "file_lock.h"

#include <cerrno>
#include <cstring>
#include <string>

#include "thermorig/core/error.h"

namespace thermorig::rig {

namespace {

files::OpenFile open(const std::filesystem::path& path, files::Disk& disk) {
  const auto opened = disk.open_to_lock(path);
  if (!opened.good())
    throw Error(ExitCode::storage, std::string("cannot be opened: ") + std::strerror(opened.error_number),
                path.string(), "check its permissions");
  return opened.value;
}

}  // namespace

FileLock::FileLock(const std::filesystem::path& path, Wait wait, files::Disk& disk)
    : file_(disk, open(path, disk)) {
  const int result = disk.lock(file_.get(), wait);
  // A file system without locks (some of the network): one program at a time is up to the user there.
  held_ = result != EWOULDBLOCK;
  certain_ = result == 0;
}

}  // namespace thermorig::rig

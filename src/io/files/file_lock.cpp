// SPDX-License-Identifier: MIT
#include "thermorig/io/files/file_lock.h"

#include <cerrno>
#include <cstring>
#include <string>

#include "thermorig/core/error.h"

namespace thermorig::files {

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

// SPDX-License-Identifier: MIT
#include "file_lock.h"

#include <fcntl.h>
#include <sys/file.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "thermorig/core/error.h"

namespace thermorig::rig {

FileLock::FileLock(const std::filesystem::path& path, Wait wait)
    : descriptor_(::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0)
    throw Error(ExitCode::storage, "cannot be opened: " + std::generic_category().message(errno),
                path.string(), "check its permissions");
  const int operation = wait == Wait::yes ? LOCK_EX : LOCK_EX | LOCK_NB;
  int result = 0;
  do {
    result = ::flock(descriptor_, operation);
  } while (result != 0 && errno == EINTR);
  held_ = result == 0;
}

FileLock::~FileLock() {
  ::close(descriptor_);
}

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#include "stored_session.h"

#include <cerrno>
#include <cstring>
#include <string>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/session/trial.h"

namespace thermorig::rig {

namespace {

[[noreturn]] void refuse_storing(int error_number, const std::filesystem::path& path) {
  throw Error(ExitCode::not_a_session, std::string("cannot be read: ") + std::strerror(error_number),
              path.string(), "check the disk (dmesg)");
}

std::vector<std::byte> bytes_of(const std::filesystem::path& path, files::Disk& disk) {
  const auto opened = disk.open(path);
  if (!opened.good()) refuse_storing(opened.error_number, path);
  const files::ClosedOnExit file(disk, opened.value);
  const auto size = disk.size(file.get());
  if (!size.good()) refuse_storing(size.error_number, path);
  if (size.value > session::SealedCopy::bytes_max) refuse_storing(EFBIG, path);
  std::vector<std::byte> bytes(size.value);
  const auto count = disk.read(file.get(), 0, bytes);
  if (!count.good()) refuse_storing(count.error_number, path);
  bytes.resize(count.value);
  return bytes;
}

}  // namespace

session::Session stored_session(const std::filesystem::path& path, files::Disk& disk) {
  return session::read_session(session::tried(session::SealedCopy(bytes_of(path, disk), path)));
}

}  // namespace thermorig::rig

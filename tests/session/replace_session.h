// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "thermorig/storage/session/session.h"

namespace thermorig::session {

/// Writes another session in the place of one; returns what write_again() leaves out.
inline std::vector<std::string> replace_session(const std::filesystem::path& path, const Session& session,
                                                files::Disk& disk = files::real_disk()) {
  files::ReplacedFile old = replaced_session(path, disk);
  old.lock();
  files::PartFile part(std::move(old));
  std::vector<std::string> left_out = write_again(part, path, session, disk);
  part.publish();
  return left_out;
}

}  // namespace thermorig::session

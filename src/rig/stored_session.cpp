// SPDX-License-Identifier: MIT
#include "stored_session.h"

#include "thermorig/session/trial.h"

namespace thermorig::rig {

session::Session stored_session(const std::filesystem::path& path, files::Disk& disk) {
  return session::read_session(session::tried(sandbox::copy_on(disk, path)));
}

}  // namespace thermorig::rig

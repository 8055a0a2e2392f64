// SPDX-License-Identifier: MIT
#include "retire_journal.h"

#include <cerrno>
#include <cstring>
#include <string>

#include "thermorig/core/error.h"

namespace thermorig::rig {

void retire_journal(const std::filesystem::path& journal, files::Disk& disk) {
  const int removed = disk.remove(journal);
  if (removed == 0 || removed == ENOENT) return;
  throw Error(
      ExitCode::storage,
      std::string("the session is complete, but its journal cannot be removed: ") + std::strerror(removed),
      journal.string(), "check the disk (dmesg), then remove the journal");
}

}  // namespace thermorig::rig

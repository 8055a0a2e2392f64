// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "thermorig/files/disk.h"

namespace thermorig::rig {

/// Removes a journal whose session holds every byte of it and is on the disk. Throws Error(storage).
void retire_journal(const std::filesystem::path& journal, files::Disk& disk);

}  // namespace thermorig::rig

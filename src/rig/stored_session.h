// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "thermorig/files/disk.h"
#include "thermorig/session/session.h"

namespace thermorig::rig {

/// session::read_session() of a file on any disk.
session::Session stored_session(const std::filesystem::path& path, files::Disk& disk);

}  // namespace thermorig::rig

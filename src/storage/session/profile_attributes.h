// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <functional>
#include <string>

#include "group_writer.h"
#include "hdf5_handle.h"
#include "thermorig/core/profile.h"

namespace thermorig::session {

/// Group of the rig's profile: a group for each table of the TOML file, an attribute for each key.
inline constexpr const char* profile_group = "/rig/profile";

/// Makes the group and all that is in it. Throws Hdf5Failure.
void write_profile(const std::function<GroupWriter(const std::string& path)>& make_group,
                   const RigProfile& profile);

/// What the groups do not have keeps its standard value. Throws Hdf5Failure if one is of another type, and
/// Error(not_a_session) with the file's `path` for a value that is not allowed.
RigProfile read_profile(hid_t file, const std::filesystem::path& path);

}  // namespace thermorig::session

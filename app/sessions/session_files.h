// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "thermorig/io/files/replaced_file.h"

namespace thermorig::app {

/// What a path of the command line stands for: a file for itself, a folder for the sessions in it, at any
/// depth. Throws Error(bad_usage) if there is nothing at `path`, or no session in the folder.
std::vector<std::filesystem::path> session_files_at(const std::filesystem::path& path);

/// The same of several, in their order.
std::vector<std::filesystem::path> session_files_at(const std::vector<std::filesystem::path>& paths);

/// The session that a path stands for where only one is taken. Throws Error(bad_usage) also of a folder that
/// holds several.
std::filesystem::path one_session_at(const std::filesystem::path& path);

/// The same, but of a folder that holds several one is asked for, where somebody sits at the terminal.
std::filesystem::path chosen_session_at(const std::filesystem::path& path);

/// The session that is there, to be written again: no other program changes it until that is done. Throws
/// what ReplacedFile::lock() throws.
files::ReplacedFile locked_session(const std::filesystem::path& path);

/// Throws Error(not_a_session) for a journal, with how to make a session of it.
void refuse_journal(const std::filesystem::path& path);

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "thermorig/learning/study/study.h"

namespace thermorig::study {

/// Writes a result under its job's name, whole or not at all. Throws Error(storage).
void write_result(const std::filesystem::path& folder, const JobResult& result);

/// Throws Error(not_a_session) for a damaged file.
JobResult read_result(const std::filesystem::path& path);

/// The job's result, if the folder has one. A file of that name which holds another job is damaged.
std::optional<JobResult> find_result(const std::filesystem::path& folder, const Job& job);

/// The files in the folder that hold results, sorted. Throws Error(bad_usage) if it cannot be read.
std::vector<std::filesystem::path> result_files(const std::filesystem::path& folder);

/// Removes what a killed program left half written. Nobody else may be writing: see FolderLock.
void remove_parts(const std::filesystem::path& folder);

}  // namespace thermorig::study

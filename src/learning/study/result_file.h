// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>
#include <vector>

#include "thermorig/learning/study/study.h"

namespace thermorig::study {

/// Writes a result under its job's name, whole or not at all, unless there is one: another program may have
/// been faster, and the first stays. Throws Error(storage).
void write_result(const std::filesystem::path& folder, const JobResult& result);

/// The same over the one that is there.
void replace_result(const std::filesystem::path& folder, const JobResult& result);

/// Throws Error(not_a_session) for a damaged file.
JobResult read_result(const std::filesystem::path& path);

/// The job's result, if the folder has one. A file of that name which holds another job is damaged.
std::optional<JobResult> find_result(const std::filesystem::path& folder, const Job& job);

/// The files in the folder that hold results, sorted. Throws Error(bad_usage) if it cannot be read.
std::vector<std::filesystem::path> result_files(const std::filesystem::path& folder);

/// Throws Error(storage).
void make_results_folder(const std::filesystem::path& folder);

/// Removes what programs of this machine had half written when they were killed.
void remove_litter(const std::filesystem::path& folder);

}  // namespace thermorig::study

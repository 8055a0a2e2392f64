// SPDX-License-Identifier: MIT
#pragma once

#include <filesystem>

#include "thermorig/learning/study/study.h"

namespace thermorig::study {

/// What a job's claim is called: see files/claim.h. It lies beside the result, in the same folder, so that
/// whoever has made a claim sees the results that came before it.
std::filesystem::path claim_name(const std::filesystem::path& folder, const Job& job);

/// Is the claim of another program that may still live?
bool is_held(const files::ClaimSight& claim);

}  // namespace thermorig::study

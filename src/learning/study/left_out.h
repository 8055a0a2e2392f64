// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/learning/study/study.h"

namespace thermorig::study {

/// The acquisition that a job is tested on. Throws Error(bad_usage) if the acquisitions are not those that
/// the job was made of.
const network::Acquisition& left_out_of(const Job& job, std::span<const network::Acquisition> acquisitions);

/// The windows that a job is tested on, of the acquisition that is left out.
std::vector<network::Window> test_windows(const Job& job, const network::Acquisition& left_out);

/// What a result keeps of these windows.
Evaluation evaluation_of(std::span<const JudgedWindow> judged, const network::Acquisition& left_out,
                         double label_scale_dps);

}  // namespace thermorig::study

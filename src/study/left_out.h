// SPDX-License-Identifier: MIT
#pragma once

#include <span>

#include "thermorig/study/study.h"

namespace thermorig::study {

/// The acquisition that a job is tested on. Throws Error(bad_usage) if the acquisitions are not those that
/// the job was made of.
const windows::Acquisition& left_out_of(const Job& job, std::span<const windows::Acquisition> acquisitions);

/// The windows that a job is tested on, of the acquisition that is left out.
std::vector<windows::Window> test_windows(const Job& job, const windows::Acquisition& left_out);

/// What a result keeps of these windows.
Evaluation evaluation_of(std::span<const JudgedWindow> judged, const windows::Acquisition& left_out,
                         double label_scale_dps);

}  // namespace thermorig::study

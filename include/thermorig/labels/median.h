// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

namespace thermorig::labels {

/// The middle value; of an even number, the upper one of the two in the middle. 0 of none.
double median(std::vector<double> values);

/// Standard deviation about `centre` as the middle half of the values has it: 1.4826 times the median
/// absolute deviation.
double robust_deviation(std::vector<double> values, double centre);

}  // namespace thermorig::labels

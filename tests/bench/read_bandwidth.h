// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <vector>

/// Reads all of `values` once, in order, as fast as this machine can: the bound of a layer whose weights do
/// not fit the nearest cache. A multiple of 512 values.
void read_burst(const std::vector<float>& values);

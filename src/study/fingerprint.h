// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "thermorig/windows/acquisition.h"

namespace thermorig::study {

/// SHA-256 of a text, hexadecimal.
std::string fingerprint_of(const std::string& text);

/// Of the hashes of all acquisitions, sorted: which data these are, whatever their order and names.
std::string fingerprint_of(std::span<const windows::Acquisition> acquisitions);

}  // namespace thermorig::study

// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "thermorig/network/acquisition.h"

namespace thermorig::study {

/// SHA-256 of a text, hexadecimal.
std::string fingerprint_of(const std::string& text);

/// Of the hashes of all acquisitions, sorted: which data these are, whatever their order and names.
std::string fingerprint_of(std::span<const network::Acquisition> acquisitions);

}  // namespace thermorig::study

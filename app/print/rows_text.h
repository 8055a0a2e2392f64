// SPDX-License-Identifier: MIT
#pragma once

#include <span>
#include <string>

#include "thermorig/core/raw_recording.h"
#include "thermorig/estimators/odometer/map.h"

namespace thermorig::app {

/// What an odometer has found of the camera's rows, as an event of a live run:
/// "camera rows: read all at once, margin 87 (difference of log-likelihoods)".
std::string rows_text(const odometer::FoundRows& rows);
/// The newest such event, without its first words; empty: none of these is one.
std::string rows_told(std::span<const RecordingEvent> events);

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <span>

#include "thermorig/estimators/table.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::dataset {

/// What the estimators of a bank say of a frame of a session, one an entry.
using FrameEstimates = std::function<void(std::size_t frame, std::span<const RateEstimate> estimates)>;

/// Runs them over a session as it stands in its file, frame by frame. A frame that no recording can hold by
/// its times is left out.
void run_estimators(const session::Session& session, estimators::Bank& bank, const FrameEstimates& told);

}  // namespace thermorig::dataset

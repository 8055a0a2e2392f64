// SPDX-License-Identifier: MIT
#pragma once

#include <vector>

#include "thermorig/network/acquisition.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::dataset {

/// What the estimators that need no network say of each frame, and of windows of more frames where they find
/// one rate of those. They see what a live run sees, in its order, at the times that the finished session
/// knows.
std::vector<network::RateSeries> rates_without_network(const session::Session& session);

/// Acquisition::bound_dps of windows of so many frames.
std::vector<float> rate_bounds(const session::Session& session, int frames);

}  // namespace thermorig::dataset

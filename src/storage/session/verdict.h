// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/storage/session/session.h"

namespace thermorig::session {

/// Fills in `verdict` and `verdict_reasons` from the figures. Rules: docs/recording_format.md, "Verdict".
void judge(const Session& session, Quality& quality);

}  // namespace thermorig::session

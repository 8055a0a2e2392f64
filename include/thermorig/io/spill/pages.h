// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::spill {

/// Gives pages of arrays that lie on a disk back to the system, if more of them are in memory than shall be.
/// A thread does that every two milliseconds; who looks at large arrays quickly calls it now and then.
void give_pages_back();

}  // namespace thermorig::spill

// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::spill {

/// Gives pages of arrays that lie on a disk back to the system, if more of them are in memory than shall be.
/// That happens by itself in the program's first thread; others that look at large arrays call it now and
/// then.
void give_pages_back();

}  // namespace thermorig::spill

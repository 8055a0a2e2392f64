// SPDX-License-Identifier: MIT
#pragma once

namespace thermorig::sandbox {

/// From here on the kernel refuses this process every system call (EPERM) but the few that reading what is
/// already in memory needs: memory that is not executable, time, locks, writing to what is open, the end. The
/// calls of another architecture end it. For good; a process that it makes would be held as well. Where the
/// kernel has no such filters, or on other processors than x86-64 and aarch64, nothing happens: the other
/// limits hold. Needs PR_SET_NO_NEW_PRIVS.
void filter_calls();

}  // namespace thermorig::sandbox

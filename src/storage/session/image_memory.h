// SPDX-License-Identifier: MIT
#pragma once

#include "hdf5_handle.h"

namespace thermorig::session {

/// Properties of access to a file that HDF5 builds in memory from `new`, as all large arrays are: HDF5's own
/// would come from malloc(), and always be memory. Throws Hdf5Failure.
Handle access_in_memory();

}  // namespace thermorig::session

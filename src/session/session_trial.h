// SPDX-License-Identifier: MIT
#pragma once

#include "thermorig/session/sealed_copy.h"

namespace thermorig::session {

/// Everything that reading the copy asks of libhdf5 and of this program, for nothing: throws as
/// read_session() does.
void read_for_nothing(const SealedCopy& copy);

}  // namespace thermorig::session

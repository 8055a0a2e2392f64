// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <optional>

#include "thermorig/core/profile.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::wire {

/// Four bytes that are a reply of the camera: sync, sync, emissivity, sum. It never ends in a sync byte (its
/// emissivity would be above 1), so it cannot swallow a header.
bool is_reply(Bytes rest);

/// Where a reply stands inside a frame that the bridge interrupted for it: taken out, the check sum fits.
/// `bytes` begin with a frame header and are as long as a frame and a reply. None under
/// ChecksumPolicy::ignore, which leaves nothing to decide by.
std::optional<std::size_t> find_reply_inside(Bytes bytes, ChecksumPolicy checksum);

/// Whether the check sum of a whole frame fits. Always, under ChecksumPolicy::ignore.
bool checksum_fits(Bytes frame, ChecksumPolicy checksum);

}  // namespace thermorig::wire

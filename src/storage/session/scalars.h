// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <string>

#include "format.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {

/// The header as it stands in a file that is written: without the profile, which has groups of its own.
std::string header_text(const RecordingHeader& header);

/// CRC-32 of the values that stand in attributes alone, which HDF5 does not protect:
/// root attribute `scalars_crc32`. `header_text`: the header as it stands in the file. `version`: of the
/// format, which decides what is in it.
std::uint32_t scalars_crc32(const Session& session, const std::string& header_text, FormatVersion version);

/// "2026-07-25T14:35:12.000001Z" and so many seconds later; empty if `start` is not of this form.
std::string utc_after(const std::string& start, double seconds);

}  // namespace thermorig::session

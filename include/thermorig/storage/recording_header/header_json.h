// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

#include "thermorig/core/raw_recording.h"

namespace thermorig::recording_header {

/// What people state of their data is a name ("CC-BY-4.0"), an address or a sentence: a line of 1 to 1000
/// bytes of UTF-8.
bool is_line(std::string_view text);

/// 1 to 32 of a-z, 0-9 and '-'.
bool is_environment_name(const std::string& name);

/// Whether profile and plan are part of the text, as in journals and in sessions before format 2.0.
enum class ProfileAndPlan { in_header, elsewhere };

/// The header as one line of JSON; keys are the members' names (docs/journal_format.md, "Header"). Journals
/// and sessions store this text. Text that is not UTF-8 is repaired. Throws Error(bad_usage) if a value could
/// not be read back: an environment outside [a-z0-9-]{1,32}, a licence that is none, or what
/// profile_fields.h does not allow in a profile.
std::string header_to_json_text(const RecordingHeader& header,
                                ProfileAndPlan place = ProfileAndPlan::in_header);

/// The inverse; where they are elsewhere the profile is the standard one, the plan empty. Every value is
/// checked before it is believed. Throws Error(not_a_session) with what is wrong; `where` names the file for
/// the message.
RecordingHeader header_from_json_text(std::string_view text, const std::string& where,
                                      ProfileAndPlan place = ProfileAndPlan::in_header);

}  // namespace thermorig::recording_header

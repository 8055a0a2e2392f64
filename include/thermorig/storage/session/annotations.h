// SPDX-License-Identifier: MIT
#pragma once

#include <optional>
#include <string>

#include "thermorig/storage/session/session.h"

namespace thermorig::session {

inline constexpr std::size_t most_annotations = 1000;

/// Under which environment and number a recording is known.
struct Place {
  std::string environment;
  int acquisition = 0;  // from 1
  bool operator==(const Place&) const = default;
};

/// That of the last annotation that says one, else that of the header.
Place place_of(const Session& session);

/// Why an annotation cannot be stored, as a sentence; nothing if it can.
std::optional<std::string> problem_of(const Annotation& annotation);

/// Marks the frames whose exposure lies in an exclusion (Reason::operator_mark), takes the mark from all
/// others, and numbers the runs of valid frames anew.
void apply_exclusions(Session& session);

}  // namespace thermorig::session

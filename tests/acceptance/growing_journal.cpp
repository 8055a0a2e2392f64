// SPDX-License-Identifier: MIT
#include "growing_journal.h"

#include <algorithm>

#include "thermorig/core/error.h"

namespace thermorig::tests {

std::optional<journal::JournalContents> growing_journal(const std::filesystem::path& path) {
  try {
    return journal::read_journal(path);
  } catch (const Error&) {
    return std::nullopt;
  }
}

bool has_first_leg(const std::filesystem::path& path) {
  const auto contents = growing_journal(path);
  if (!contents) return false;
  const auto& events = contents->recording.events;
  return std::any_of(events.begin(), events.end(),
                     [](const RecordingEvent& event) { return event.kind == EventKind::leg_start; });
}

}  // namespace thermorig::tests

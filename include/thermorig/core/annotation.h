// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <string_view>

#include "thermorig/core/time.h"

namespace thermorig {

/// What somebody may say of a recording when it is over. The numbers are stored in files.
enum class AnnotationKind : std::uint8_t {
  note = 0,
  environment = 1,  // it belongs to another environment, under a number of its own
  exclusion = 2     // its frames from `begin_s` to `end_s` are not to be trusted
};
inline constexpr AnnotationKind last_annotation_kind = AnnotationKind::exclusion;

/// Names in the order of the numbers, as in the file's `flag_meanings`.
inline constexpr std::array<std::string_view, 3> annotation_kind_names{"note", "environment", "exclusion"};

struct Annotation {
  AnnotationKind kind = AnnotationKind::note;
  std::string made_utc;  // ISO 8601
  std::string text;      // the note; the environment's name; why it is excluded, which may be empty
  int acquisition = 0;   // of an environment: the number there; else 0
  double begin_s = 0.0;  // of an exclusion: seconds since the recording's start; else 0
  double end_s = 0.0;
  bool operator==(const Annotation&) const = default;

  /// Of an exclusion: whatever the recording's length, all of its frames.
  void set_all() { begin_s = -(end_s = farthest_time_s); }
  bool is_of_all() const { return begin_s <= -farthest_time_s && end_s >= farthest_time_s; }
};

}  // namespace thermorig

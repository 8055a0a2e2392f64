// SPDX-License-Identifier: MIT
#include "thermorig/storage/session/annotations.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "thermorig/core/validity.h"
#include "thermorig/storage/recording_header/header_json.h"

namespace thermorig::session {

namespace {

bool is_excluded(const Session& session, const LabelledSample& sample) {
  const HostTime reference = session.raw.header.time_reference;
  return std::any_of(session.annotations.begin(), session.annotations.end(),
                     [&](const Annotation& annotation) {
                       return annotation.kind == AnnotationKind::exclusion &&
                              sample.exposure_begin < reference + from_s(annotation.end_s) &&
                              sample.exposure_end > reference + from_s(annotation.begin_s);
                     });
}

/// As the labels number them: one ends with its leg, at an invalid frame and at a gap.
void number_runs(std::vector<LabelledSample>& samples) {
  std::uint32_t run = 0;
  std::optional<std::uint16_t> leg;  // of the run that goes on; none: none does
  for (LabelledSample& sample : samples) {
    if (sample.valid && (breaks_run(sample.reason_bits) || sample.leg != leg)) ++run;
    leg = sample.valid ? std::optional(sample.leg) : std::nullopt;
    sample.run = sample.valid ? run : 0;
  }
}

}  // namespace

Place place_of(const Session& session) {
  const auto last = std::find_if(
      session.annotations.rbegin(), session.annotations.rend(),
      [](const Annotation& annotation) { return annotation.kind == AnnotationKind::environment; });
  if (last != session.annotations.rend()) return {last->text, last->acquisition};
  return {session.raw.header.environment, session.raw.header.acquisition};
}

std::optional<std::string> problem_of(const Annotation& annotation) {
  using recording_header::is_line;
  if (!is_line(annotation.made_utc)) return "it has no date";
  switch (annotation.kind) {
    case AnnotationKind::note:
      if (!is_line(annotation.text)) return "a note is a line of 1 to 1000 bytes of UTF-8";
      break;
    case AnnotationKind::environment:
      if (!recording_header::is_environment_name(annotation.text) || annotation.acquisition < 1)
        return "it names no environment, or no number there";
      break;
    case AnnotationKind::exclusion:
      if (!annotation.text.empty() && !is_line(annotation.text))
        return "the reason of an exclusion is a line of up to 1000 bytes of UTF-8";
      if (!(std::abs(annotation.begin_s) <= farthest_time_s &&
            std::abs(annotation.end_s) <= farthest_time_s && annotation.begin_s < annotation.end_s))
        return "an exclusion ends after it begins";
      break;
  }
  return std::nullopt;
}

void apply_exclusions(Session& session) {
  constexpr std::uint32_t mark = bit(Reason::operator_mark);
  bool is_changed = false;
  for (LabelledSample& sample : session.samples) {
    const bool excluded = is_excluded(session, sample);
    if (excluded == ((sample.reason_bits & mark) != 0)) continue;
    sample.reason_bits ^= mark;
    sample.valid = (sample.reason_bits & ~warning_bits) == 0;
    is_changed = true;
  }
  if (is_changed) number_runs(session.samples);
}

}  // namespace thermorig::session

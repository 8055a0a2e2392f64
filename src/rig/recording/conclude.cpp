// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "thermorig/core/printable.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/rig/sweep/quota.h"

namespace thermorig::rig {

namespace {

std::vector<SpeedQuota> speeds_of(const session::Session& session, const SweepPlan& plan) {
  ValidQuota quota(plan);
  for (const LegRecord& leg : session.raw.legs) quota.leg(leg.leg, leg.rate_dps);
  for (const LabelledSample& sample : session.samples) quota.sample(sample);
  return quota.speeds();
}

std::ptrdiff_t count_short(const std::vector<SpeedQuota>& speeds) {
  return std::count_if(speeds.begin(), speeds.end(),
                       [](const SpeedQuota& speed) { return speed.is_short(); });
}

std::string names_of(const std::vector<Device>& devices) {
  std::string names;
  for (const Device device : devices)
    names += (names.empty() ? "" : " and the ") + std::string(name_of(device));
  return names;
}

/// "the camera was away for 12 s, the servo 5 times for 21 s in all"; empty if none was.
std::string absences_text(const std::vector<DeviceAbsence>& absences) {
  std::string text;
  for (const Device device : all_devices) {
    int times = 0;
    double away_s = 0.0;
    for (const DeviceAbsence& absence : absences)
      if (absence.device == device) {
        ++times;
        away_s += to_s(absence.end - absence.begin);
      }
    if (times == 0) continue;
    text += (text.empty() ? "" : ", ") +
            fmt::format("the {}{}", name_of(device), text.empty() ? " was away" : "");
    if (times > 1) text += fmt::format(" {} times", times);
    text += fmt::format(" for {:.0f} s{}", std::ceil(away_s), times > 1 ? " in all" : "");
  }
  return text;
}

/// "the servo's watchdog tripped 3 times, the servo's board was reset"; empty without troubles.
std::string troubles_text(const std::vector<SweepTrouble>& troubles) {
  std::string text;
  for (const SweepTrouble& trouble : troubles) {
    text += (text.empty() ? "" : ", ") + trouble.what;
    if (trouble.count > 1) text += fmt::format(" {} times", trouble.count);
  }
  return text;
}

/// A plan that was finished in spite of it, and one that was not: either way it is named.
void say_what_interrupted(RecordingResult& result, const RecordingOutcome& outcome) {
  std::string text = absences_text(outcome.absences);
  const std::string troubles = troubles_text(outcome.troubles);
  if (!troubles.empty() && !outcome.failure) {
    text += (text.empty() ? "" : ", ") + troubles;
    if (result.advice.empty()) result.advice = outcome.troubles.front().advice;
  }
  if (text.empty()) return;
  if (result.message.empty())
    result.message = "the plan is complete; " + text + ", and the legs that this cut short were repeated";
  else
    result.message += "; " + text;
}

/// What a recording without a servo should have shown, ready to print.
std::vector<std::string> lacking_by_hand(const session::Session& session) {
  constexpr double least_turn_deg = 360.0;
  std::vector<std::string> lacking;
  if (!session.sync.gyro.bias_dps) return {"a rest of 10 s at the beginning: without it there are no labels"};
  if (session.sync.gyro.bias_course.empty()) lacking.emplace_back("a rest of 5 s at the end");
  double forward_deg = 0.0, backward_deg = 0.0;
  for (const LabelledSample& sample : session.samples) {
    const double turned_deg = static_cast<double>(sample.rate_shaft_dps) * session.frame_period_s;
    if (turned_deg > 0.0) forward_deg += turned_deg;
    if (turned_deg < 0.0) backward_deg -= turned_deg;
  }
  if (std::max(forward_deg, backward_deg) < least_turn_deg)
    lacking.emplace_back("more than a whole turn, for the gyro's scale");
  if (std::min(forward_deg, backward_deg) < least_turn_deg / 4.0)
    lacking.emplace_back(forward_deg > backward_deg ? "turns the other way (negative rates)"
                                                    : "turns the other way (positive rates)");
  return lacking;
}

std::string losses_of(const session::Quality& quality) {
  std::string text;
  for (const Device device : all_devices) {
    const std::string losses = session::losses_text(device, quality.stream[device]);
    if (!losses.empty()) text += (text.empty() ? "" : ", ") + losses;
  }
  return text;
}

void say_how_it_ended(RecordingResult& result, const RecordingOutcome& outcome) {
  if (outcome.failure) {
    const bool is_held = outcome.failure->code() == ExitCode::no_permission;
    result.exit = is_held ? ExitCode::no_permission : ExitCode::device_lost;
    result.message = outcome.failure->where() + ": " + outcome.failure->what_happened();
    result.advice = outcome.failure->advice();
  } else if (outcome.stopped_by) {
    result.exit = ExitCode::interrupted;
    result.message =
        outcome.stopped_by->empty() ? "stopped on request" : "stopped on request of " + *outcome.stopped_by;
    if (outcome.is_kept) result.message += "; everything up to then is in the session";
  } else if (!outcome.gone.empty()) {
    result.exit = ExitCode::finished_lossy;
    result.message = "the plan is complete, in part without the " + names_of(outcome.gone);
    result.advice = outcome.gone_advice;
  } else if (result.quality.verdict == "bad") {
    result.exit = ExitCode::finished_lossy;
    result.message = "the plan is complete, but its quality is bad";
    result.advice = "thermorig inspect " + shell_word(result.session.string());
  } else if (const auto wanting = count_short(result.speeds); wanting > 0) {
    result.exit = ExitCode::finished_lossy;
    result.message = fmt::format("the plan is complete, but {} of {} speeds have too few valid frames",
                                 wanting, result.speeds.size());
    if (outcome.is_kept) result.advice = "thermorig inspect " + shell_word(result.session.string());
  } else if (const std::string losses = losses_of(result.quality); !losses.empty()) {
    result.exit = ExitCode::finished_lossy;
    result.message = "the plan is complete, but " + losses;
    result.advice = "thermorig inspect " + shell_word(result.session.string());
  }
}

void say_what_was_not_read_back(RecordingResult& result, const Finalised& made,
                                const std::filesystem::path& journal) {
  if (made.is_retired) return;
  const std::string text = fmt::format(
      "{} bytes at the end of the journal could not be read back and are not in the session; the "
      "journal is kept: {}",
      made.bytes_ignored, journal.string());
  result.message += (result.message.empty() ? "" : "; ") + text;
  if (result.exit == ExitCode::ok) result.exit = ExitCode::finished_lossy;
  if (result.advice.empty()) result.advice = "check the disk (dmesg)";
}

/// What is said of any recording, kept or not.
void conclude_with(RecordingResult& result, const RecordingOutcome& outcome) {
  result.preflight = outcome.preflight;
  say_how_it_ended(result, outcome);
  say_what_interrupted(result, outcome);
}

RecordingResult conclude_unkept(Recording& recording, HostTime now) {
  const RecordingProgress progress = recording.progress(now);
  recording.close(now);
  RecordingResult result;
  result.state = session::State::partial;
  result.speeds = progress.sweep.speeds;
  result.duration_s = progress.elapsed_s;
  conclude_with(result, recording.outcome(now));
  return result;
}

}  // namespace

RecordingResult conclude(Recording& recording, HostTime now) {
  const RecordingOutcome outcome = recording.outcome(now);
  if (!outcome.was_ready && outcome.failure) {
    recording.discard(now);
    throw Error(*outcome.failure);
  }
  if (!outcome.is_kept) return conclude_unkept(recording, now);
  const SessionFile file = recording.close(now);
  const Finalised made =
      finalise(file.journal, file.session, recording.disk(), WithoutEnd::keep, file.clock_set_ns);
  const session::Session& session = made.session;
  RecordingResult result;
  result.acquisition = file.acquisition;
  result.session = file.session;
  result.state = session.state;
  result.quality = session::quality_of(session);
  result.speeds = speeds_of(session, recording.plan());
  result.duration_s = to_s(now - session.raw.header.time_reference);
  conclude_with(result, recording.outcome(now));
  say_what_was_not_read_back(result, made, file.journal);
  if (!session.raw.header.profile.servo.is_there()) result.lacking = lacking_by_hand(session);
  return result;
}

}  // namespace thermorig::rig

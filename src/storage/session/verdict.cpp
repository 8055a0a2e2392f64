// SPDX-License-Identifier: MIT
#include "verdict.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstdlib>
#include <sstream>
#include <string>
#include <utility>

#include "thermorig/core/validity.h"

namespace thermorig::session {

namespace {

constexpr double lost_share_bad = 0.05;
constexpr double lost_share_usable = 0.005;
constexpr double valid_share_usable = 0.5;
// Two milliseconds are 0.4 degrees at 200 deg/s, an eighth of a pixel; ten are what plain arrival times do.
constexpr double clock_uncertainty_usable_s = 0.002;
constexpr double clock_uncertainty_bad_s = 0.010;
constexpr double link_delay_usable_s = clock_uncertainty_bad_s;
// The label rule's own measure of a steady speed: 1 deg/s.
constexpr double residual_usable_dps = 1.0;
constexpr double residual_bad_dps = 5.0;
constexpr double disagreeing_share_usable = 0.1;
// A bias that equal speeds both ways tell this well, where rests do not: a tenth of the label rule's measure.
constexpr double bias_by_legs_usable_dps = 0.1;

class Verdict {
 public:
  void bad(const std::string& reason) { note(2, reason); }
  void usable(const std::string& reason) { note(1, reason); }
  /// A remark is told beside the verdict, which it does not lower.
  void usable_or_remark(bool usable, const std::string& reason) { note(usable ? 1 : 0, reason); }

  void write_to(Quality& quality) const {
    quality.verdict = level_ == 2 ? "bad" : level_ == 1 ? "usable" : "good";
    quality.verdict_reasons = reasons_;
  }

 private:
  void note(int level, const std::string& reason) {
    level_ = std::max(level_, level);
    reasons_.push_back(reason);
  }
  int level_ = 0;
  std::vector<std::string> reasons_;
};

double share_of(std::uint64_t some, const Quality::Stream& stream) {
  return static_cast<double>(some) / static_cast<double>(stream.lost + stream.bad + stream.received);
}

bool lost_too_many(Device device, const Quality::Stream& stream) {
  if (device != Device::camera) return share_of(stream.lost + stream.bad, stream) > lost_share_bad;
  return share_of(stream.bad, stream) > lost_share_bad || share_of(stream.lost, stream) > most_missing_frames;
}

void judge_stream(Device device, const Quality::Stream& stream, Verdict& verdict) {
  if (stream.received == 0)
    return verdict.bad(fmt::format("the {} sent nothing that can be read", name_of(device)));
  const std::string losses = losses_text(device, stream);
  if (losses.empty()) return;
  lost_too_many(device, stream) ? verdict.bad(losses) : verdict.usable(losses);
}

/// A rest that a calibration asked for: there are no legs in which a frame could be valid.
bool is_rest(const Session& session) {
  return session.raw.legs.empty() && is_for_calibration(session.raw.header) &&
         session.raw.header.plan_toml.find("\nleg_rates_dps = []") != std::string::npos;
}

std::string none_valid_text(const Quality& quality) {
  const auto excluded =
      quality.reason_counts.find(std::string(reason_names[static_cast<std::size_t>(Reason::operator_mark)]));
  const bool by_hand = excluded != quality.reason_counts.end() && excluded->second == quality.swept;
  return by_hand ? "no frame is valid: all were excluded (annotate --exclude)" : "no frame is valid";
}

/// Of a rig without a servo.
void judge_rests(const Session& session, Verdict& verdict) {
  const GyroErrors& gyro = session.sync.gyro;
  if (!gyro.bias_dps)
    verdict.bad(
        gyro.zeroes_itself
            ? "the gyro zeroes itself at rest and so hides its bias: labels from it are refused; "
              "switch that off in the device"
            : "no rest at the beginning, so the gyro's bias is not known: labels from it are refused; record "
              "again, and leave the rig alone for the first 10 s");
  else if (gyro.bias_course.empty())
    verdict.usable_or_remark(false, "no rest at the end, so the drift of the gyro's bias is not known");
}

void judge_samples(const Session& session, const Quality& quality, Verdict& verdict) {
  const bool has_servo = session.raw.header.profile.servo.is_there();
  if (!has_servo) judge_rests(session, verdict);
  if (quality.valid == 0) return verdict.bad(none_valid_text(quality));
  if (static_cast<double>(quality.valid) < valid_share_usable * static_cast<double>(quality.swept))
    verdict.usable(fmt::format("only {} of {} frames{} are valid", quality.valid, quality.swept,
                               has_servo ? " within legs" : ""));
  const auto empty = std::count_if(quality.speeds.begin(), quality.speeds.end(),
                                   [](const auto& speed) { return speed.valid == 0; });
  const std::size_t speeds = quality.speeds.size();
  if (empty > 0) verdict.usable(fmt::format("{} of {} speeds have no valid frame", empty, speeds));
}

/// One that is away cannot be lost again, and an end because it stayed away is no loss of another.
int count_losses(const std::vector<RecordingEvent>& events) {
  PerDevice<bool> away{};
  int losses = 0;
  for (const RecordingEvent& event : events) {
    const bool is_back = event.kind == EventKind::device_back;
    if (!is_back && event.kind != EventKind::device_lost) continue;
    const bool was_away = event.source
                              ? std::exchange(away[*event.source], !is_back)
                              : std::find(away.values.begin(), away.values.end(), true) != away.values.end();
    if (!is_back && !was_away) ++losses;
  }
  return losses;
}

void judge_events(const Session& session, Verdict& verdict) {
  const int losses = count_losses(session.raw.events);
  if (losses == 1) verdict.usable("a device was lost once");
  if (losses > 1) verdict.usable(fmt::format("devices were lost {} times", losses));
  if (session.state == State::recovered) verdict.usable("recovered after the recorder was cut short");
  if (session.state == State::partial) verdict.usable("stopped before the plan was complete");
}

/// What the session says of a clock that is known less well than others are.
std::string why_uncertain(const Session& session, Device device) {
  const ClockReport& clock = session.sync.clock[device];
  if (!(clock.wander_ppm > session.raw.header.profile.link(device).wander_ppm)) return "";
  return fmt::format(
      ": its clock and the host's wander by {:.0f} ppm (a resonator, or NTP that slews the host's clock)",
      clock.wander_ppm);
}

/// Links that are slower than the profile says. The bounds have room for it, so up to that limit it is no
/// more than what each hub brings, and stands among the bounds.
void judge_links(const Session& session, Verdict& verdict) {
  std::string names;
  double delay_s = 0.0;
  for (const Device device : {Device::camera, Device::gyro}) {
    const ClockReport& clock = session.sync.clock[device];
    const double stated_s = session.raw.header.profile.link(device).largest_constant_delay_s;
    if (clock.method.empty() || clock.largest_constant_delay_s <= stated_s) continue;
    names += (names.empty() ? "" : " and the ") + std::string(name_of(device));
    delay_s = clock.largest_constant_delay_s;
  }
  if (delay_s > link_delay_usable_s)
    verdict.usable(fmt::format("the times of the {} may be up to {:.1f} ms late; a USB hub can cause this",
                               names, 1e3 * delay_s));
}

/// A clock that could not be fitted is one that too little was heard of: the streams say so already.
void judge_clocks(const Session& session, const Quality& quality, Verdict& verdict) {
  for (const Device device : all_devices) {
    const double uncertainty_s = quality.clock[device].uncertainty_s;
    const auto reason = fmt::format("the times of the {} are known to {:.1f} ms only{}", name_of(device),
                                    1e3 * uncertainty_s, why_uncertain(session, device));
    if (uncertainty_s > clock_uncertainty_bad_s)
      verdict.bad(reason);
    else if (uncertainty_s > clock_uncertainty_usable_s)
      verdict.usable(reason);
  }
}

/// In the legs such a gyro is as good as others: rates that are frames' labels are far from those it zeroes.
void judge_zeroes(const GyroErrors& gyro, Verdict& verdict) {
  const std::string hidden =
      "the gyro zeroes itself at rest and so hides its bias: switch that off in the device";
  const bool is_told =
      gyro.bias_from_legs && gyro.bias_dps && gyro.bias_dps->uncertainty <= bias_by_legs_usable_dps;
  if (!is_told) return verdict.usable(hidden);
  verdict.usable_or_remark(false, fmt::format("{}; estimated from both directions: {:.2f} +- {:.2f} deg/s",
                                              hidden, gyro.bias_dps->value, gyro.bias_dps->uncertainty));
}

/// Whether frames disagree since command and gyro do as a whole, of which the witnesses' sentence tells.
bool contradict_throughout(const Witnesses& witnesses) {
  return witnesses.outlier != Witness::none && witnesses.outlier != Witness::images;
}

/// Labels are right where the images alone contradict; a training would still learn from mirrored ones.
void judge_witnesses(const Session& session, Verdict& verdict) {
  const Witnesses& witnesses = session.sync.witnesses;
  if (witnesses.cause.empty()) return;
  const std::string reason = fmt::format("{}; try: {}", witnesses.cause, witnesses.remedy);
  const bool is_turned = witnesses.images_share && witnesses.images_share->value < 0.0;
  if (contradict_throughout(witnesses) || is_turned) return verdict.bad(reason);
  verdict.usable(reason);
}

void judge_gyro(const Session& session, const Quality& quality, Verdict& verdict) {
  if (const double decay = session.sync.gyro.decay_per_s; decay > 0.0)
    verdict.bad(fmt::format(
        "the gyro's rate falls by {:.0f} % a second while the shaft turns at one speed: its filter "
        "takes a steady turn for a bias; switch the device to raw rates (6 axes, no fusion)",
        100.0 * decay));
  if (session.sync.gyro.zeroes_itself && session.raw.header.profile.servo.is_there())
    judge_zeroes(session.sync.gyro, verdict);
  if (quality.sound == 0 || contradict_throughout(session.sync.witnesses)) return;
  const double share = static_cast<double>(quality.disagreeing) / static_cast<double>(quality.sound);
  if (share > disagreeing_share_usable)
    verdict.usable(fmt::format("gyro and servo disagree in {:.0f} % of the frames that are otherwise valid",
                               100 * share));
}

/// "200 and -200 deg/s": the first few, ready to print.
std::string strayed_text(const std::vector<ServoResponse::AtSpeed>& speeds) {
  constexpr std::size_t shown = 4;
  std::string text;
  std::size_t strayed = 0;
  for (const auto& speed : speeds) {
    if (!speed.contradicts || ++strayed > shown) continue;
    text += fmt::format("{}commanded {:.0f}, reached {:.0f} deg/s", text.empty() ? "" : "; ", speed.rate_dps,
                        speed.reached_dps);
  }
  return strayed > shown ? fmt::format("{}; and {} more speeds", text, strayed - shown) : text;
}

/// Frames at such speeds are invalid, so what the session is good for remains good.
void judge_servo(const Session& session, const Quality& quality, Verdict& verdict) {
  const ServoResponse& servo = session.sync.servo;
  if (contradict_throughout(session.sync.witnesses)) return;
  if (const std::string strayed = strayed_text(servo.speeds); !strayed.empty())
    verdict.usable(
        fmt::format("the shaft does not turn as commanded: {}: weak supply, load or servo?", strayed));
  const bool is_fitted_at_all = !session.sync.clock[Device::servo].method.empty();
  if (!servo.fitted && is_fitted_at_all && quality.swept > 0)
    verdict.usable("servo delay not measured; default used");
}

void judge_constants(const Session& session, Verdict& verdict) {
  const RigProfile& profile = session.raw.header.profile;
  const GyroErrors& gyro = session.sync.gyro;
  const CameraOffset& offset = session.sync.camera_offset;
  if (gyro.scale_contradicts && gyro.scale_by_turns)
    verdict.usable(
        fmt::format("the gyro's scale was calibrated as {:.4f} +- {:.4f}, and whole turns say {:.4f} +- "
                    "{:.4f}, which is used",
                    profile.gyro.scale, profile.gyro.scale_uncertainty, gyro.scale_by_turns->value,
                    gyro.scale_by_turns->uncertainty));
  if (offset.contradicts && offset.offset_s)
    verdict.usable(fmt::format(
        "the camera's latency was calibrated as {:.1f} +- {:.1f} ms, and the images say {:.1f} +- {:.1f} ms, "
        "which is used",
        1e3 * profile.camera.link.latency_s, 1e3 * profile.camera.link.latency_uncertainty_s,
        1e3 * (profile.camera.link.latency_s + offset.offset_s->value), 1e3 * offset.offset_s->uncertainty));
  if (gyro.filter_contradicts)
    verdict.usable(
        fmt::format("the gyro's bandwidth is stated {}, and {} contradicts that: its filter delays by {:.1f} "
                    "+- {:.1f} ms",
                    profile.gyro.bandwidth_hz > 0.0 ? fmt::format("as {:.0f} Hz", profile.gyro.bandwidth_hz)
                                                    : "by the device",
                    gyro.filter_source == "device" ? "the device itself" : "its noise",
                    1e3 * gyro.filter_delay_s.value, 1e3 * gyro.filter_delay_s.uncertainty));
}

void judge_labels(const Quality& quality, Verdict& verdict) {
  const auto reason = fmt::format("gyro and servo model differ by {:.1f} deg/s", quality.gyro_residual_dps);
  if (quality.gyro_residual_dps > residual_bad_dps)
    verdict.bad(reason);
  else if (quality.gyro_residual_dps > residual_usable_dps)
    verdict.usable(reason);
}

/// The first duration that a reason quotes, "21.07 ms" or "2.5 s"; 0 where it quotes none, as older files
/// may.
double quoted_s(const std::string& reason) {
  std::istringstream words(reason);
  for (std::string word, before; words >> word; before = word) {
    const double number = std::strtod(before.c_str(), nullptr);
    if (number > 0.0 && word.starts_with("ms")) return 1e-3 * number;
    if (number > 0.0 && (word == "s" || word == "s:")) return number;
  }
  return 0.0;
}

bool contradicts_less(const ClockEpoch& a, const ClockEpoch& b) {
  return quoted_s(a.reason) < quoted_s(b.reason);
}

/// Counted samples have times as good: what they are known to is judged.
void judge_own_times(const Session& session, Verdict& verdict) {
  const std::string& why = session.sync.clock[Device::gyro].own_time_unused;
  const GyroProfile& gyro = session.raw.header.profile.gyro;
  if (why.empty()) return;
  verdict.usable_or_remark(
      false, fmt::format("the gyro's own times are not those of its samples, which were counted: {}{}", why,
                         gyro.text.time < 0 ? "" : " (say time_column = -1 in the rig profile)"));
}

void judge_epochs(const Session& session, Verdict& verdict) {
  for (const Device device : all_devices) {
    const auto& epochs = session.sync.clock[device].epochs;
    if (epochs.size() < 2) continue;
    const auto times = epochs.size() == 2 ? "once" : fmt::format("{} times, most", epochs.size() - 1);
    const auto most = std::max_element(epochs.begin() + 1, epochs.end(), contradicts_less);
    verdict.usable(fmt::format("the clock of the {} was reset {}: {}", name_of(device), times, most->reason));
  }
}

}  // namespace

std::string losses_text(Device device, const Quality::Stream& stream) {
  const double share = share_of(stream.lost + stream.bad, stream);
  if (!(share > lost_share_usable)) return "";
  return fmt::format("{:.1f} % of the {}'s messages were lost or damaged", 100 * share, name_of(device));
}

bool is_for_calibration(const RecordingHeader& header) {
  return header.plan_toml.find("\nfor_calibration = true\n") != std::string::npos;
}

void judge(const Session& session, Quality& quality) {
  Verdict verdict;
  for (const Device device : all_devices)
    if (session.raw.header.profile.has(device)) judge_stream(device, quality.stream[device], verdict);
  judge_witnesses(session, verdict);
  if (!is_rest(session)) judge_samples(session, quality, verdict);
  judge_clocks(session, quality, verdict);
  judge_links(session, verdict);
  judge_epochs(session, verdict);
  judge_own_times(session, verdict);
  judge_gyro(session, quality, verdict);
  judge_labels(quality, verdict);
  judge_servo(session, quality, verdict);
  judge_constants(session, verdict);
  judge_events(session, verdict);
  verdict.write_to(quality);
}

}  // namespace thermorig::session

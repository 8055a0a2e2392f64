// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "commands.h"
#include "print/inspect_text.h"
#include "print/output.h"
#include "record/profile_path.h"
#include "session_files.h"
#include "thermorig/core/statistics.h"
#include "thermorig/io/spill/spill.h"
#include "thermorig/rig/calibration/calibration.h"
#include "thermorig/rig/profile/profile_file.h"
#include "thermorig/rig/recording/finalise.h"
#include "thermorig/storage/session/annotations.h"

namespace thermorig::app {

namespace {

/// What a session said of itself before and after.
struct State {
  session::Quality quality;
  std::vector<HostTime> times;  // of its frames
  std::vector<Annotation> annotations;
};

State state_of(const session::Session& session, session::Quality quality) {
  State state{std::move(quality), {}, session.annotations};
  for (const LabelledSample& sample : session.samples) state.times.push_back(sample.time);
  return state;
}

State state_before(const std::filesystem::path& path) {
  auto [session, quality] = session::read_overview(session::StoredFile(path));
  return state_of(session, std::move(quality));
}

/// How far the frames' times went, forward and back alike.
struct Moved {
  double median_s = 0.0;
  double max_s = 0.0;
};

std::optional<Moved> moved(const State& before, const State& after) {
  if (before.times.size() != after.times.size() || after.times.empty()) return std::nullopt;
  std::vector<double> by_s;
  for (std::size_t i = 0; i < after.times.size(); ++i)
    by_s.push_back(std::abs(to_s(after.times[i] - before.times[i])));
  return Moved{reordering_median(by_s), *std::max_element(by_s.begin(), by_s.end())};
}

/// What a session's profile says now because that of `--rig` said so: what was measured with its date, and
/// what was said otherwise before.
std::vector<std::string> applied(const RigProfile& from, const RigProfile& before, const RigProfile& now) {
  std::vector<std::string> names;
  const auto add = [&](const char* name, const std::string& there, const std::string& here) {
    if (!there.empty() && there == here) names.push_back(fmt::format("{} of {}", name, here));
  };
  add("orientation", from.camera.orientation_measured_utc, now.camera.orientation_measured_utc);
  add("lens", from.camera.lens_measured_utc, now.camera.lens_measured_utc);
  add("camera latency", from.camera.link.latency_measured_utc, now.camera.link.latency_measured_utc);
  add("gyro scale", from.gyro.scale_measured_utc, now.gyro.scale_measured_utc);
  add("gyro bias", from.gyro.bias_measured_utc, now.gyro.bias_measured_utc);
  add("servo scale", from.servo.scale_measured_utc, now.servo.scale_measured_utc);
  const auto note = [&](const char* name, bool is_new) {
    if (is_new) names.emplace_back(name);
  };
  note("columns and unit of the gyro", before.gyro.text != now.gyro.text);
  note("settings of the gyro", before.gyro.settings != now.gyro.settings);
  note("axis or sign of the gyro", before.gyro.axis != now.gyro.axis || before.gyro.sign != now.gyro.sign);
  note("an assumed gyro scale", now.gyro.scale_measured_utc.empty() && before.gyro.scale != now.gyro.scale);
  note("mirrored", before.camera.mirrored != now.camera.mirrored);
  note("field of view", before.camera.field_of_view_deg != now.camera.field_of_view_deg);
  return names;
}

/// A session from its own raw bytes, and what others had put into its file that is not in it any more.
struct MadeAgain {
  session::Session session;
  std::vector<std::string> left_out;
  std::vector<std::string> applied;
};

MadeAgain make_again(files::PartFile& part, const std::filesystem::path& path,
                     const std::vector<Annotation>& annotations,
                     const std::optional<RigProfile>& calibrated) {
  RawRecording raw = session::read_raw(path);
  std::vector<std::string> names;
  if (calibrated) {
    const RigProfile before = raw.header.profile;
    calibration::take_calibrations(*calibrated, raw.header.profile);
    names = applied(*calibrated, before, raw.header.profile);
  }
  MadeAgain made{rig::build_session(std::move(raw)), {}, std::move(names)};
  made.session.annotations = annotations;
  session::apply_exclusions(made.session);
  made.left_out = session::write_again(part, path, made.session);
  part.publish();
  return made;
}

std::string change(const std::string& before, const std::string& after) {
  return before == after ? after : fmt::format("{} -> {}", before, after);
}

/// A verdict that has changed is told with its reasons.
std::string verdict_words(const session::Quality& before, const session::Quality& after) {
  std::string text = fmt::format("  verdict  {}\n", printable(change(before.verdict, after.verdict)));
  if (before.verdict == after.verdict) return text;
  for (const std::string& reason : after.verdict_reasons)
    text += fmt::format("           {}\n", printable(reason));
  return text;
}

std::string words_of(const std::filesystem::path& path, const State& before, const State& after) {
  const session::Quality& quality = after.quality;
  std::string text =
      fmt::format("rebuilt  {}  {} frames\n", printable(path.string()), count_text(quality.frames)) +
      fmt::format("  valid    {} of {} in legs\n",
                  change(count_text(before.quality.valid), count_text(quality.valid)),
                  change(count_text(before.quality.swept), count_text(quality.swept))) +
      verdict_words(before.quality, quality);
  if (const auto by = moved(before, after))
    return text + fmt::format("  times    moved by {:.2f} ms in the median, by {:.2f} ms at most\n",
                              1e3 * by->median_s, 1e3 * by->max_s);
  return text + fmt::format("  times    {} frames before, {} now\n", before.times.size(), after.times.size());
}

nlohmann::json object_of(const std::filesystem::path& path, const State& before, const State& after) {
  nlohmann::json object = quality_json(after.quality);
  object["file"] = path.string();
  object["verdict_reasons"] = after.quality.verdict_reasons;
  object["before"] = quality_json(before.quality);
  const auto by = moved(before, after);
  object["moved_median_s"] = by ? nlohmann::json(by->median_s) : nlohmann::json();
  object["moved_max_s"] = by ? nlohmann::json(by->max_s) : nlohmann::json();
  return object;
}

std::string words_of(const std::vector<std::string>& calibrations) {
  return fmt::format("  applied  {}\n", calibrations.empty()
                                            ? "nothing: the profile says nothing else of this rig"
                                            : printable(fmt::format("{}", fmt::join(calibrations, ", "))));
}

/// Whether all can be made again, before the first one is.
void check_files(const std::vector<std::filesystem::path>& files) {
  for (const auto& path : files) {
    spill::arrays_near(path);
    const files::PartFile room(locked_session(path));
    session::read_raw(path);
  }
}

}  // namespace

ExitCode run(const ReprocessOptions& options) {
  std::optional<RigProfile> calibrated;
  if (!options.profile.empty()) calibrated = read_named_profile(options.profile);
  const std::vector<std::filesystem::path> files = session_files_at(options.paths);
  check_files(files);
  nlohmann::json list = nlohmann::json::array();
  for (const auto& path : files) {
    spill::arrays_near(path);
    files::PartFile part(locked_session(path));
    const State before = state_before(path);
    const MadeAgain made = make_again(part, path, before.annotations, calibrated);
    const State after = state_of(made.session, session::quality_of(made.session));
    list.push_back(object_of(path, before, after));
    list.back()["left_out"] = made.left_out;
    if (!options.json) print("{}", words_of(path, before, after));
    if (!options.json && !made.left_out.empty()) print("  left out {}\n", left_out_text(made.left_out));
    if (!calibrated) continue;
    list.back()["calibrations"] = made.applied;
    if (!options.json) print("{}", words_of(made.applied));
  }
  if (options.json) print_json(list);
  return ExitCode::ok;
}

}  // namespace thermorig::app

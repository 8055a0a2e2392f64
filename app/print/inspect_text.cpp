// SPDX-License-Identifier: MIT
#include "inspect_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <nlohmann/json.hpp>

#include "annotation_text.h"
#include "decoded_text.h"
#include "number_json.h"
#include "output.h"
#include "rows_text.h"
#include "simulation_text.h"
#include "speed_pairs.h"
#include "thermorig/core/validity.h"
#include "thermorig/storage/session/annotations.h"
#include "timing_text.h"

namespace thermorig::app {

namespace {

using session::Quality;
using session::Session;

std::string origin(const RecordingHeader& header) {
  if (!header.simulated) return "recorded from ports";
  const std::string seed = header.simulation_seed ? fmt::format("seed {}, ", *header.simulation_seed) : "";
  return fmt::format("SIMULATED ({}{})", seed, simulation_text(header.simulation));
}

nlohmann::json annotations_json(const Session& session) {
  nlohmann::json list = nlohmann::json::array();
  for (const Annotation& annotation : session.annotations) list.push_back(annotation_json(annotation));
  return list;
}

/// What measures the shaft, and whether labels are made by it.
std::string shaft_lines(const std::string& sensor, const ShaftReport& shaft) {
  std::string text = fmt::format("  shaft        measured by {}, {}\n", printable(sensor),
                                 shaft.used ? "labels are made by it" : "but no label is made by it");
  if (!shaft.why_not.empty()) text += fmt::format("               {}\n", printable(shaft.why_not));
  if (shaft.unread + shaft.poor > 0)
    text += fmt::format("               {} of {} readings failed, {} are by a weak or too strong magnet\n",
                        count_text(shaft.unread), count_text(shaft.readings), count_text(shaft.poor));
  return text;
}

std::string heading(const std::filesystem::path& path, const Session& session, const Quality& quality) {
  const RecordingHeader& header = session.raw.header;
  std::string text = printable(path.string()) + "\n";
  text += fmt::format("  session      {}, {}\n", session::name_of(session.state), printable(origin(header)));
  const session::Place place = session::place_of(session);
  text += fmt::format("  recorded     {} acquisition {}, {}, {}\n", printable(place.environment),
                      place.acquisition, printable(header.start_time_utc), duration_text(quality.duration_s));
  if (header.profile.servo.is_there())
    text += fmt::format("  plan         {}, {} frames a leg\n", printable(header.plan_name),
                        header.frames_per_leg);
  else
    text += "  labels       from the gyro: this rig has no servo\n";
  text += fmt::format("  made by      {} ({})\n", printable(header.creator), printable(header.creator_git));
  if (!header.licence.empty()) text += fmt::format("  licence      {}\n", printable(header.licence));
  if (!header.operator_name.empty())
    text += fmt::format("  operator     {}\n", printable(header.operator_name));
  if (!header.place.empty()) text += fmt::format("  place        {}\n", printable(header.place));
  if (!header.note.empty()) text += fmt::format("  note         {}\n", printable(header.note));
  for (const Annotation& annotation : session.annotations)
    text += fmt::format("  annotated    {}\n", printable(words_of(annotation)));
  const std::string rows = rows_told(session.raw.events);
  if (!rows.empty()) text += fmt::format("  camera rows  {}\n", printable(rows));
  if (!session.sync.bad_pixels.empty())
    text += fmt::format("  bad pixels   {} (row,column from 0)\n", printable(session.sync.bad_pixels));
  if (!header.firmware.empty()) text += fmt::format("  servo        {}\n", printable(header.firmware));
  if (!header.shaft_sensor.empty()) text += shaft_lines(header.shaft_sensor, session.sync.shaft);
  return text;
}

std::string stream_table(const Quality& quality, const RigProfile& profile) {
  Table table({"stream", ">received", ">lost", ">bad", ">repeated", ">rate", ">mean", ">longest gap"});
  for (Device device : all_devices) {
    if (!profile.has(device)) continue;
    const Quality::Stream& stream = quality.stream[device];
    table.add({std::string(name_of(device)), count_text(stream.received), count_text(stream.lost),
               count_text(stream.bad), count_text(stream.repeated),
               rate_range_text(stream.rate_min_hz, stream.rate_max_hz),
               fmt::format("{:.2f} /s", stream.rate_mean_hz), gap_text(stream.gap_max_s)});
  }
  return table.text();
}

/// Whether it does not clear `valid` by itself.
bool is_warning(const std::string& reason) {
  const auto found = std::find(reason_names.begin(), reason_names.end(), reason);
  return found != reason_names.end() && (warning_bits >> (found - reason_names.begin()) & 1U) != 0;
}

/// A warning of every frame tells none from another: a short session lies within a camera's warm-up.
std::string frames_text(const Quality& quality) {
  std::string reasons, warnings;
  for (const auto& [name, count] : quality.reason_counts) {
    if (count == 0 || (is_warning(name) && count == quality.swept)) continue;
    std::string& text = is_warning(name) ? warnings : reasons;
    text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name, count_text(count));
  }
  return valid_frames_text(quality) + "flagged  " + (reasons.empty() ? "none" : reasons) + "\n" +
         (warnings.empty() ? "" : "warned   " + warnings + " (clears no frame)\n");
}

/// A speed in hundredths, so that it can be looked up.
long centi(double rate_dps) {
  return std::lround(rate_dps * 100);
}

std::string speed_table(const Quality& quality) {
  const auto frames = [](const Quality::Speed* speed) { return speed ? std::to_string(speed->frames) : "-"; };
  const auto valid = [](const Quality::Speed* speed) { return speed ? std::to_string(speed->valid) : "-"; };
  Table table({">deg/s", ">frames +", ">valid +", ">frames -", ">valid -"});
  for (const auto& [magnitude, pair] : by_magnitude(quality.speeds))
    table.add({fmt::format("{:.1f}", static_cast<double>(magnitude) / 100), frames(pair.forward),
               valid(pair.forward), frames(pair.backward), valid(pair.backward)});
  return table.text();
}

std::string verdict_text(const Quality& quality) {
  std::string text = "verdict  " + printable(quality.verdict);
  for (std::size_t i = 0; i < quality.verdict_reasons.size(); ++i)
    text += (i == 0 ? ": " : "; ") + printable(quality.verdict_reasons[i]);
  return text + "\n";
}

nlohmann::json stream_json(const Quality::Stream& stream, const wire::Counters& counters) {
  return {{"received", stream.received},
          {"lost", stream.lost},
          {"bad", stream.bad},
          {"repeated", stream.repeated},
          {"rate_min_hz", stream.rate_min_hz},
          {"rate_mean_hz", stream.rate_mean_hz},
          {"rate_max_hz", stream.rate_max_hz},
          {"gap_max_s", stream.gap_max_s},
          {"counters", counters_json(counters)}};
}

nlohmann::json speeds_json(const Quality& quality) {
  nlohmann::json speeds = nlohmann::json::array();
  for (const Quality::Speed& speed : quality.speeds)
    speeds.push_back({{"rate_dps", speed.rate_dps}, {"frames", speed.frames}, {"valid", speed.valid}});
  return speeds;
}

nlohmann::json header_json(const RecordingHeader& header) {
  nlohmann::json object{{"uuid", header.uuid},
                        {"start_time", header.start_time_utc},
                        {"simulated", header.simulated},
                        {"simulation", header.simulation},
                        {"plan", header.plan_name},
                        {"frames_per_leg", header.frames_per_leg},
                        {"licence", header.licence},
                        {"operator", header.operator_name},
                        {"place", header.place},
                        {"note", header.note},
                        {"creator", header.creator},
                        {"creator_git", header.creator_git},
                        {"servo_firmware", header.firmware}};
  object["seed"] = header.simulation_seed ? nlohmann::json(*header.simulation_seed) : nlohmann::json();
  return object;
}

}  // namespace

nlohmann::json quality_json(const Quality& quality) {
  return {{"frames", quality.frames},
          {"frames_swept", quality.swept},
          {"frames_valid", quality.valid},
          {"verdict", quality.verdict}};
}

std::string valid_frames_text(const Quality& quality) {
  if (quality.swept == quality.frames)
    return fmt::format("frames   {} of {} are valid ({})\n", count_text(quality.valid),
                       count_text(quality.frames), share_text(quality.valid, quality.frames));
  return fmt::format("frames   {} of {} in legs are valid ({}); {} in all\n", count_text(quality.valid),
                     count_text(quality.swept), share_text(quality.valid, quality.swept),
                     count_text(quality.frames));
}

std::string altered_text(const std::vector<std::string>& altered) {
  constexpr std::size_t most = 8;
  if (altered.empty()) return "";
  std::string text = fmt::format("altered  {} {} not as thermorig wrote {}:", altered.size(),
                                 altered.size() == 1 ? "attribute is" : "attributes are",
                                 altered.size() == 1 ? "it" : "them");
  for (std::size_t i = 0; i < std::min(altered.size(), most); ++i)
    text += (i == 0 ? " " : ", ") + printable(altered[i]);
  if (altered.size() > most) text += fmt::format(" and {} more", altered.size() - most);
  return text + "\n         nothing above is taken from them; thermorig reprocess writes them anew\n";
}

std::string left_out_text(const std::vector<std::string>& left_out) {
  return printable(fmt::format("{}", fmt::join(left_out, ", "))) +
         ": what others add is not copied, but for attributes";
}

std::string text_of(const std::filesystem::path& path, const Session& session, const Quality& quality) {
  const std::string speeds = quality.speeds.empty() ? "" : fmt::format("\n{}", speed_table(quality));
  return fmt::format("{}\n{}\n{}{}{}\n{}", heading(path, session, quality),
                     stream_table(quality, session.raw.header.profile), frames_text(quality),
                     timing_line(path, session, quality), speeds, verdict_text(quality));
}

nlohmann::json inspected_json(const std::filesystem::path& path, const Session& session,
                              const Quality& quality) {
  nlohmann::json object = header_json(session.raw.header);
  const session::Place place = session::place_of(session);
  object["environment"] = place.environment;
  object["acquisition"] = place.acquisition;
  object["annotations"] = annotations_json(session);
  object["camera_rows"] = text_json(rows_told(session.raw.events));
  object["file"] = path.string();
  object["state"] = session::name_of(session.state);
  object["duration_s"] = quality.duration_s;
  object["camera_mode"] = session.camera_mode;
  object["camera_bad_pixels"] = session.sync.bad_pixels;
  object.update(quality_json(quality));
  object["reasons"] = quality.reason_counts;
  object["speeds"] = speeds_json(quality);
  for (Device device : all_devices)
    object["streams"][std::string(name_of(device))] =
        stream_json(quality.stream[device], session.counters[device]);
  if (!session.raw.header.shaft_sensor.empty()) {
    const ShaftReport& shaft = session.sync.shaft;
    object["shaft"] = {{"sensor", session.raw.header.shaft_sensor},
                       {"readings", shaft.readings},
                       {"unread", shaft.unread},
                       {"poor", shaft.poor},
                       {"used", shaft.used},
                       {"why_not", shaft.why_not},
                       {"gyro_share", estimate_json(shaft.gyro_share)},
                       {"command_share", estimate_json(shaft.command_share)},
                       {"error_deg", shaft.error_deg}};
  }
  object["label_source"] = session.raw.header.profile.servo.is_there() ? "command" : "gyro";
  object["verdict_reasons"] = quality.verdict_reasons;
  return object;
}

ShortSpeeds short_speeds(const Quality& quality, const rig::SweepPlan& plan) {
  std::map<long, Quality::Speed> speeds;  // by hundredths of deg/s
  for (double rate_dps : plan.leg_rates_dps) speeds[centi(rate_dps)].rate_dps = rate_dps;
  ShortSpeeds result{.planned = speeds.size()};
  for (const Quality::Speed& speed : quality.speeds)
    if (speeds.contains(centi(speed.rate_dps))) speeds[centi(speed.rate_dps)].frames = speed.frames;
  std::vector<Quality::Speed> wanting;
  for (const auto& [key, speed] : speeds)
    if (speed.frames < plan.frames_per_leg) wanting.push_back(speed);
  std::stable_sort(wanting.begin(), wanting.end(),
                   [](const auto& a, const auto& b) { return a.frames < b.frames; });
  result.count = wanting.size();
  constexpr std::size_t shown = 4;
  for (std::size_t i = 0; i < std::min(shown, wanting.size()); ++i)
    result.text += fmt::format("{}{} ({} of {})", i == 0 ? "" : ", ", speed_text(wanting[i].rate_dps),
                               wanting[i].frames, plan.frames_per_leg);
  if (wanting.size() > shown) result.text += fmt::format(" and {} more", wanting.size() - shown);
  return result;
}

}  // namespace thermorig::app

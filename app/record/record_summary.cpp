// SPDX-License-Identifier: MIT
#include "record_summary.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <nlohmann/json_fwd.hpp>

#include <algorithm>
#include <optional>

#include "print/inspect_text.h"
#include "print/output.h"
#include "thermorig/rig/recording/preflight.h"

namespace thermorig::app {

namespace {

nlohmann::json violations_json(const std::vector<rig::PreflightViolation>& found) {
  nlohmann::json list = nlohmann::json::array();
  for (const rig::PreflightViolation& violation : found)
    list.push_back({{"name", violation.name},
                    {"device", name_of(violation.device)},
                    {"figure", violation.figure},
                    {"limit", violation.limit},
                    {"advice", violation.advice}});
  return list;
}

nlohmann::json devices_json(const rig::PreflightFacts& facts) {
  nlohmann::json devices = nlohmann::json::object();
  for (const Device device : all_devices) {
    const auto& stream = facts.streams[device];
    devices[std::string(name_of(device))] =
        !stream ? nlohmann::json()
                : nlohmann::json{
                      {"messages", stream->messages},           {"rate_hz", stream->rate_hz},
                      {"nominal_hz", stream->nominal_hz},       {"lost_share", stream->lost_share},
                      {"damaged_share", stream->damaged_share}, {"uncertainty_s", stream->uncertainty_s}};
  }
  return devices;
}

/// What the preflight check saw and said; null if nothing was judged.
nlohmann::json preflight_json(const std::optional<rig::PreflightReport>& report) {
  if (!report) return {};
  const rig::PreflightFacts& facts = report->facts;
  nlohmann::json object{{"passed", report->passed()},
                        {"span_s", facts.span_s},
                        {"violations", violations_json(report->violations)},
                        {"warnings", violations_json(report->warnings)},
                        {"devices", devices_json(facts)},
                        {"images", nlohmann::json()},
                        {"rest", nlohmann::json()},
                        {"answers", nlohmann::json()}};
  if (facts.images)
    object["images"] = {{"even_fresh_share", facts.images->even_fresh_share},
                        {"odd_fresh_share", facts.images->odd_fresh_share},
                        {"repeated_share", facts.images->repeated_share},
                        {"lost_half_share", facts.images->lost_half_share},
                        {"sensor_drift_c_per_min", facts.images->sensor_drift_c_per_min}};
  if (facts.rest)
    object["rest"] = {{"mean_dps", facts.rest->mean_dps},
                      {"noise_dps", facts.rest->noise_dps},
                      {"swing_dps", facts.rest->swing_dps},
                      {"zeroes_itself", facts.rest->zeroes_itself}};
  if (facts.answers)
    object["answers"] = {{"requests", facts.answers->requests},
                         {"answered", facts.answers->answered},
                         {"round_trip_s", facts.answers->round_trip_s},
                         {"firmware", facts.answers->firmware}};
  return object;
}

using rig::RecordingResult;

double worst_gap_s(const session::Quality& quality) {
  double gap_s = 0;
  for (Device device : all_devices) gap_s = std::max(gap_s, quality.stream[device].gap_max_s);
  return gap_s;
}

std::string gaps_text(const session::Quality& quality) {
  std::string text;
  for (Device device : all_devices)
    if (quality.stream[device].received > 0)
      text += fmt::format("{}{} {}", text.empty() ? "" : ", ", name_of(device),
                          gap_text(quality.stream[device].gap_max_s));
  return text;
}

std::string lost_text(const session::Quality& quality) {
  std::string text;
  for (Device device : all_devices) {
    const auto& stream = quality.stream[device];
    if (stream.received == 0 && stream.bad == 0) continue;
    text += fmt::format("{}{} {} lost {} bad", text.empty() ? "" : ", ", name_of(device),
                        count_text(stream.lost), count_text(stream.bad));
  }
  return text;
}

std::string journal_text(const RecordingResult& result) {
  return result.session.empty() ? "left as it is: " + printable(result.journal.string())
                                : "saved in the session";
}

/// Speeds without their valid frames or, where the plan has no quota, without their frames.
ShortSpeeds wanting_speeds(const RecordSummary& summary) {
  if (summary.plan.valid_per_leg == 0) return short_speeds(summary.result.quality, summary.plan);
  ShortSpeeds wanting{.planned = summary.result.speeds.size()};
  constexpr std::size_t shown = 4;
  for (const rig::SpeedQuota& speed : summary.result.speeds) {
    if (!speed.is_short() || ++wanting.count > shown) continue;
    wanting.text += fmt::format("{}{} ({} valid of {})", wanting.count == 1 ? "" : ", ",
                                speed_text(speed.rate_dps), speed.valid, speed.wanted);
  }
  if (wanting.count > shown) wanting.text += fmt::format(" and {} more", wanting.count - shown);
  return wanting;
}

nlohmann::json speeds_json(const std::vector<rig::SpeedQuota>& speeds) {
  nlohmann::json list = nlohmann::json::array();
  for (const rig::SpeedQuota& speed : speeds)
    list.push_back({{"rate_dps", speed.rate_dps}, {"valid", speed.valid}, {"valid_quota", speed.wanted}});
  return list;
}

void print_speeds(const RecordSummary& summary) {
  const ShortSpeeds wanting = wanting_speeds(summary);
  print(
      "speeds   {} planned, {}\n", wanting.planned,
      wanting.count == 0 ? "none short of frames" : fmt::format("{} short: {}", wanting.count, wanting.text));
}

void print_figures(const RecordSummary& summary) {
  const RecordingResult& result = summary.result;
  const session::Quality& quality = result.quality;
  print("{}", valid_frames_text(quality));
  if (!summary.plan.leg_rates_dps.empty() && !summary.plan.for_calibration)
    print_speeds(summary);  // a calibration has no quota
  print("streams  {}\n", lost_text(quality));
  print("gaps     longest: {}\n", gaps_text(quality));
  std::string verdict = quality.verdict;
  for (const std::string& reason : quality.verdict_reasons) verdict += "; " + reason;
  print("verdict  {}\n", printable(verdict));
}

nlohmann::json json_of(const RecordSummary& summary) {
  const RecordingResult& result = summary.result;
  const session::Quality& quality = result.quality;
  nlohmann::json object{{"event", "summary"},
                        {"exit_code", static_cast<int>(result.exit)},
                        {"message", result.message},
                        {"advice", result.advice},
                        {"acquisition", result.acquisition},
                        {"session", result.session.string()},
                        {"journal", result.journal.string()},
                        {"duration_s", result.duration_s},
                        {"wall_s", summary.wall_s},
                        {"speeds", speeds_json(result.speeds)},
                        {"lacking", result.lacking},
                        {"speeds_short", wanting_speeds(summary).count},
                        {"worst_gap_s", worst_gap_s(quality)},
                        {"verdict_reasons", quality.verdict_reasons},
                        {"next", next_command(result)}};
  object.update(quality_json(quality));
  object["preflight"] = preflight_json(result.preflight);
  object["recorder_cpu_share"] = summary.cpu_share ? nlohmann::json(*summary.cpu_share) : nlohmann::json();
  return object;
}

void print_text(const RecordSummary& summary) {
  const RecordingResult& result = summary.result;
  print("\n");
  if (!result.session.empty()) {
    print("session  {}\n", printable(result.session.string()));
    print_figures(summary);
  }
  print("journal  {}\n", journal_text(result));
  if (summary.cpu_share)
    print("recorder {} on the clock, {:.2f} % of one core\n", duration_text(result.duration_s),
          100 * *summary.cpu_share);
  else
    print("recorder {} of virtual time in {}\n", duration_text(result.duration_s),
          duration_text(summary.wall_s));
  for (const std::string& lacking : result.lacking) print("lacking  {}\n", lacking);
  if (!result.message.empty()) print("note     {}\n", printable(result.message));
  if (!result.advice.empty() && result.advice != next_command(result))
    print("try      {}\n", printable(result.advice));
  print("\nnext  {}\n", printable(next_command(result)));
}

}  // namespace

std::string next_command(const RecordingResult& result) {
  return result.session.empty() ? "thermorig recover " + shell_word(result.journal.string())
                                : "thermorig inspect " + shell_word(result.session.string());
}

void print_summary(const RecordSummary& summary, bool json) {
  if (json)
    print_json(json_of(summary));
  else
    print_text(summary);
}

void require_told(const RecordSummary& summary) {
  require_told(summary.unwritten, next_command(summary.result));
}

void require_told(const std::optional<Error>& unwritten, const std::string& next) {
  if (unwritten) throw with_result(*unwritten, next);
  require_printed(next);
}

}  // namespace thermorig::app

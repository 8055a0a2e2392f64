// SPDX-License-Identifier: MIT
// Sessions that begin with the map of an earlier one, on simulated rigs in virtual time: in the same room,
// and in others. Usage: map_table [--json] [--first-seed N]
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "odometer_lens.h"
#include "odometer_recording.h"
#include "thermorig/core/run_all.h"
#include "thermorig/estimators/odometer/odometer.h"
#include "timing_figures.h"

namespace thermorig::bench {
namespace {

const std::array<std::string, 4> environments{"laboratory", "dining", "kitchen", "garden"};
constexpr std::size_t rooms = 24;
constexpr double earlier_session_s = 200.0;  // from the recording's begin on
constexpr std::array<double, 3> begins_s{0.0, 200.0,
                                         301.0};  // of later sessions; the first is at rest for 10 s
constexpr double later_session_s = 60.0;
constexpr double other_bias_dps = -3.0;  // of the later gyro, which was switched off between

using MapPointer = std::shared_ptr<const odometer::Map>;

struct Room {
  OdometerRecording recording;
  std::string environment;
  MapPointer map;           // of the earlier session; none: it has not tracked in its second half
  double origin_deg = 0.0;  // its heading less the shaft's angle
};

void make_map(Room& room) {
  odometer::Odometer odometer(room.recording.profile.gyro, room.recording.profile.camera);
  const HostTime begin = room.recording.measurements.front().frame.exposure_end;
  double sum_deg = 0.0, count = 0.0;
  for (const Measurement& measurement : room.recording.measurements) {
    const double time_s = to_s(measurement.frame.exposure_end - begin);
    if (time_s > earlier_session_s) break;
    const odometer::Report report = odometer.add(measurement.frame, measurement.gyro);
    if (report.state != EstimateState::good || time_s < 0.5 * earlier_session_s) continue;
    sum_deg += report.heading_deg - shaft_deg(room.recording, measurement.frame.exposure_end);
    count += 1.0;
  }
  if (count == 0.0) return;
  room.origin_deg = sum_deg / count;
  if (auto map = odometer.map()) room.map = std::make_shared<const odometer::Map>(*std::move(map));
}

/// What a session with a map came to.
struct Later {
  odometer::MapUse use = odometer::MapUse::none;
  std::optional<double> tracked_after_s;    // in that map
  double first_deg = 0.0, worst_deg = 0.0;  // heading less shaft, against the earlier session's
};

Later later_session(const Room& room, const MapPointer& map, double origin_deg, double begin_s) {
  odometer::Odometer odometer(room.recording.profile.gyro, room.recording.profile.camera, map);
  const HostTime begin = room.recording.measurements.front().frame.exposure_end + from_s(begin_s);
  Later later;
  for (const Measurement& measurement : room.recording.measurements) {
    const double time_s = to_s(measurement.frame.exposure_end - begin);
    if (time_s < 0.0) continue;
    if (time_s > later_session_s) break;
    std::vector<TimedGyro> gyro = measurement.gyro;
    for (TimedGyro& sample : gyro) sample.rate_dps += static_cast<float>(other_bias_dps);
    const odometer::Report report = odometer.add(measurement.frame, gyro);
    later.use = odometer.map_use();
    if (later.use != odometer::MapUse::found || report.state != EstimateState::good) continue;
    const double off_deg = report.heading_deg - shaft_deg(room.recording, measurement.frame.exposure_end);
    const double wrong_deg = std::abs(std::remainder(off_deg - origin_deg, 360.0));
    if (!later.tracked_after_s) later.first_deg = wrong_deg;
    if (!later.tracked_after_s) later.tracked_after_s = time_s;
    later.worst_deg = std::max(later.worst_deg, wrong_deg);
  }
  return later;
}

void add(std::vector<Figure>& figures, const std::string& section, const std::string& row,
         const std::string& column, const std::string& unit, double value,
         std::optional<double> at_most = {}) {
  std::string key = fmt::format("{}_{}_{}", section, row, column);
  for (char& one : key)
    one = std::isalnum(static_cast<unsigned char>(one)) == 0 ? '_' : static_cast<char>(std::tolower(one));
  figures.push_back({section, row, column, key, unit, value, at_most, std::nullopt, ""});
}

/// Later sessions in the rooms where their maps were made.
struct SameRoom {
  double sessions = 0.0;
  std::vector<double> after_s;  // of those that were recognised
  double first_deg = 0.0, worst_deg = 0.0;

  void add(const Room& room, double begin_s) {
    sessions += 1.0;
    if (!room.map) return;
    const Later later = later_session(room, room.map, room.origin_deg, begin_s);
    if (!later.tracked_after_s) return;
    after_s.push_back(*later.tracked_after_s);
    first_deg = std::max(first_deg, later.first_deg);
    worst_deg = std::max(worst_deg, later.worst_deg);
  }
};

void add_same(std::vector<Figure>& figures, const std::string& section, const std::string& row, SameRoom same,
              double most_deg) {
  std::vector<double>& after_s = same.after_s;
  std::sort(after_s.begin(), after_s.end());
  add(figures, section, row, "recognised", "%", 100.0 * static_cast<double>(after_s.size()) / same.sessions);
  if (after_s.empty()) return;
  add(figures, section, row, "tracks after, median", "s", after_s[after_s.size() / 2]);
  add(figures, section, row, "longest", "s", after_s.back());
  add(figures, section, row, "first angle, worst", "deg", same.first_deg, most_deg);
  add(figures, section, row, "any angle, worst", "deg", same.worst_deg, most_deg);
}

void add_honest(std::vector<Figure>& figures, const std::vector<Room>& all) {
  for (const double begin_s : begins_s)
    for (const std::string& environment : environments) {
      SameRoom same;
      for (const Room& room : all)
        if (room.environment == environment) same.add(room, begin_s);
      const std::string begin = begin_s > 0.0 ? fmt::format("from {:.0f} s on", begin_s) : "from rest";
      add_same(figures, "Same room", fmt::format("{}, {}", environment, begin), std::move(same), 2.0);
    }
}

void add_typical(std::vector<Figure>& figures, const std::vector<Room>& all) {
  for (const std::string& environment : environments) {
    SameRoom same;
    for (const Room& room : all)
      for (const double begin_s : begins_s)
        if (room.environment == environment) same.add(room, begin_s);
    add_same(figures, "Same room, world typical, after calibrate lens", environment, std::move(same), 3.0);
  }
}

void add_others(std::vector<Figure>& figures, const std::vector<Room>& all) {
  std::vector<Later> of_pairs(rooms * rooms);
  on_all_cores(rooms * rooms, [&](std::size_t pair) {
    const Room &made = all[pair / rooms], &used = all[pair % rooms];
    if (&made != &used && made.map)
      of_pairs[pair] = later_session(used, made.map, 0.0, begins_s[pair % begins_s.size()]);
  });
  double pairs = 0.0, wrong = 0.0, refused = 0.0;
  for (const Later& later : of_pairs) {
    if (later.use == odometer::MapUse::none) continue;
    pairs += 1.0;
    wrong += later.tracked_after_s ? 1.0 : 0.0;
    refused += later.use == odometer::MapUse::other ? 1.0 : 0.0;
  }
  add(figures, "Other rooms", "all", "pairs", "", pairs);
  add(figures, "Other rooms", "all", "taken for the same", "", wrong, 0.0);
  add(figures, "Other rooms", "all", "a new map begun within 60 s", "%", 100.0 * refused / pairs);
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** arguments) {
  using namespace thermorig::bench;
  const auto options = table_options(count, arguments, "map_table [--json] [--first-seed N]");
  if (!options) return 2;
  std::vector<Room> honest(rooms), typical(rooms);
  thermorig::on_all_cores(2 * rooms, [&](std::size_t i) {
    Room& room = i < rooms ? honest[i] : typical[i - rooms];
    room.environment = environments[i % environments.size()];
    OdometerCase wanted{.seed = options->first_seed + i % rooms, .environment = room.environment};
    if (i >= rooms) {
      wanted.world = "typical";
      wanted.calibrated = calibrate_lens(wanted).profile;
    }
    room.recording = record(wanted);
    make_map(room);
  });
  std::vector<Figure> figures;
  add_honest(figures, honest);
  add_typical(figures, typical);
  add_others(figures, honest);
  if (options->json) {
    print_json(figures);
    return 0;
  }
  fmt::print("Simulated rigs in virtual time, plan \"paper\", raw gyro, causal clocks; from seed {} on.\n",
             options->first_seed);
  print_text(figures);
  return 0;
}

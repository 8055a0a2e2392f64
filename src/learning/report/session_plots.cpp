// SPDX-License-Identifier: MIT
// One session: its speeds over time, an image of it, and what its frames lack.
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <limits>

#include "json_values.h"
#include "plots.h"
#include "text.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/validity.h"
#include "thermorig/learning/report/report.h"
#include "thermorig/storage/session/annotations.h"

namespace thermorig::report {
namespace {

using nlohmann::json;
using session::Rows;

constexpr double not_known = std::numeric_limits<double>::quiet_NaN();

/// A line, of the whole session.
struct Course {
  std::string name, key;  // key: of its colour and dash
  std::vector<double> time_s, value;
};

std::vector<double> times_of(const Rows& rows) {
  std::vector<double> times;
  for (const LabelledSample& sample : rows.session.samples)
    times.push_back(to_s(sample.time - rows.session.raw.header.time_reference));
  return times;
}

template <typename Value>
Course course_of(const Rows& rows, const std::string& name, const std::string& key, Value value) {
  Course course{name, key, times_of(rows), {}};
  for (const LabelledSample& sample : rows.session.samples)
    course.value.push_back(static_cast<double>(value(sample)));
  return course;
}

/// What an estimator of a live run said; `less_command`: its error.
std::vector<Course> estimates_of(const Rows& rows, bool less_command) {
  const RawRecording& raw = rows.session.raw;
  std::vector<Course> courses;
  for (std::size_t place = 0; place < raw.header.estimators.size(); ++place) {
    const std::string name = clean(raw.header.estimators[place].name);
    Course& course = courses.emplace_back(Course{name, name, {}, {}});
    for (const EstimateRow& row : raw.estimates) {
      const double rate_dps = row.estimates[place].rate_dps;
      course.time_s.push_back(to_s(row.time - raw.header.time_reference));
      course.value.push_back(!less_command ? rate_dps
                             : row.counted ? rate_dps - row.rate_commanded_dps
                                           : not_known);
    }
  }
  return courses;
}

double corrected_dps(const LabelledSample& sample, const GyroErrors& errors) {
  return (double{sample.rate_gyro_dps} - bias_dps_at(errors, sample.time)) / errors.scale.value;
}

Chart course_chart(const std::string& name, const std::string& title, const std::string& y,
                   const std::vector<Course>& courses) {
  Chart chart{.name = name, .title = title, .label = title + " over time, in deg/s:", .data = {}};
  json lines = json::array();
  for (const Course& course : courses) {
    chart.label += " " + course.name + ",";
    lines.push_back({{"name", course.name},
                     {"key", course.key},
                     {"x", drawn(course.time_s)},
                     {"y", drawn(course.value)}});
  }
  chart.label.back() = '.';
  chart.data = {{"kind", "lines"}, {"x", "time, s"}, {"y", y}, {"thinned", true}, {"lines", lines}};
  return chart;
}

Chart rates_chart(const Rows& rows, bool has_servo) {
  std::vector<Course> courses;
  if (has_servo) {
    courses.push_back(
        course_of(rows, "commanded", "commanded", [](const auto& s) { return s.rate_commanded_dps; }));
    courses.push_back(course_of(rows, "shaft", "shaft", [](const auto& s) { return s.rate_shaft_dps; }));
  }
  courses.push_back(course_of(rows, "gyro mean", "gyro-mean", [](const auto& s) { return s.rate_gyro_dps; }));
  for (Course& course : estimates_of(rows, false)) courses.push_back(std::move(course));
  return course_chart("rates", "Speeds", "speed, deg/s", courses);
}

/// Of valid frames alone.
Chart difference_chart(const Rows& rows) {
  const GyroErrors& errors = rows.session.sync.gyro;
  const auto less = [](const LabelledSample& sample, double rate_dps) {
    return sample.valid ? rate_dps - sample.rate_commanded_dps : not_known;
  };
  std::vector<Course> courses{
      course_of(rows, "gyro mean", "gyro-mean", [&](const auto& s) { return less(s, s.rate_gyro_dps); }),
      course_of(rows, "gyro corrected", "corrected",
                [&](const auto& s) { return less(s, corrected_dps(s, errors)); })};
  for (Course& course : estimates_of(rows, true)) courses.push_back(std::move(course));
  return course_chart("difference", "Speeds minus the command, valid frames", "difference, deg/s", courses);
}

Chart image_chart(const std::vector<float>& image) {
  Chart chart{.name = "image",
              .title = "Thermal image of the first valid frame, deg C",
              .label = "Thermal image, 24 rows of 32 pixels.",
              .data = {}};
  json values = json::array();
  for (const float value : image) values.push_back(drawn(double{value}));
  chart.data = {{"kind", "image"}, {"columns", frame_columns}, {"values", values}};
  return chart;
}

Table facts_table(const Rows& rows) {
  const session::Session& session = rows.session;
  const RecordingHeader& header = session.raw.header;
  const session::Place place = session::place_of(session);
  std::uint64_t valid = 0;
  for (const LabelledSample& sample : session.samples) valid += sample.valid ? 1 : 0;
  Table table{.name = "session", .caption = "The session", .header = {"what", "value"}};
  table.rows = {{"environment", clean(place.environment)},
                {"acquisition", std::to_string(place.acquisition)},
                {"recorded", clean(header.start_time_utc)},
                {"data", header.simulated ? "SIMULATED rig" : "real"},
                {"plan", clean(header.plan_name)},
                {"duration, s", fmt::format("{:.1f}", to_s(session.raw.end_time - header.time_reference))},
                {"frames", count_text(session.samples.size())},
                {"valid frames", count_text(valid)},
                {"verdict", clean(rows.verdict)},
                {"licence", clean(header.licence)}};
  std::erase_if(table.rows, [](const auto& row) { return row[1].empty(); });
  return table;
}

Table reasons_table(const Rows& rows) {
  Table table{.name = "reasons",
              .caption = "Frames by what was noticed of them; one frame may have several",
              .header = {"reason", "frames"}};
  for (std::size_t bit = 0; bit < reason_names.size(); ++bit) {
    std::uint64_t frames = 0;
    for (const LabelledSample& sample : rows.session.samples) frames += sample.reason_bits >> bit & 1U;
    if (frames > 0) table.rows.push_back({std::string(reason_names[bit]), count_text(frames)});
  }
  return table;
}

}  // namespace

std::vector<PlotFile> session_plots(const Rows& rows, const std::vector<float>& image) {
  const bool has_servo = rows.session.raw.header.profile.servo.is_there();
  Charts charts{{rates_chart(rows, has_servo)}};
  if (has_servo) charts.charts.push_back(difference_chart(rows));
  if (!image.empty()) charts.charts.push_back(image_chart(image));
  const Document document{"A session", "", {{"", {charts, facts_table(rows), reasons_table(rows)}}}};
  return plots_of(document, rows.session.raw.header.simulated);
}

}  // namespace thermorig::report

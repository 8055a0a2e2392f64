// SPDX-License-Identifier: MIT
#include "live_lines.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <nlohmann/json.hpp>
#include <numeric>
#include <string_view>

#include "print/output.h"
#include "print/simulation_text.h"
#include "print/terminal_width.h"

namespace thermorig::app {

namespace {

constexpr std::size_t narrowest = 8;

/// As wide as the name over it.
std::size_t width_of(const EstimatorColumn& estimator) {
  return std::max(narrowest, estimator.name.size() + 2);
}

// What a person wants to see first, where not all fit: the paper's two beside the plain gyro.
constexpr std::array<std::string_view, 4> first_shown{"cnn-fusion", "gyro", "cnn-thermal", "odometer"};

std::size_t rank_of(const EstimatorColumn& estimator) {
  return static_cast<std::size_t>(std::ranges::find(first_shown, estimator.name) - first_shown.begin());
}

std::string rate_cell(float rate_dps) {
  return std::isnan(rate_dps) ? "-" : fmt::format("{:+.1f}", rate_dps);
}

/// Marked where the estimator does not trust it, or not yet.
std::string rate_cell(const RateEstimate& estimate) {
  const bool is_doubted = std::isfinite(estimate.rate_dps) && estimate.state != EstimateState::good;
  return rate_cell(estimate.rate_dps) + (is_doubted ? "?" : "");
}

std::string figure(double value, const char* format = "{:.4f}") {
  return std::isfinite(value) ? fmt::format(fmt::runtime(format), value) : "-";
}

/// A line a second: time, the servo's speed, that of as many estimators as fit, Kg where there is a gate,
/// counted frames.
class RateLines {
 public:
  RateLines() = default;
  RateLines(const std::vector<EstimatorColumn>& estimators, HostTime begin, std::size_t width)
      : begin_(begin), estimators_(estimators), has_gate_(live::gain_of(estimators, {}).has_value()) {
    std::vector<std::size_t> places(estimators.size());
    std::iota(places.begin(), places.end(), std::size_t{0});
    std::ranges::stable_sort(places, {}, [&](std::size_t place) { return rank_of(estimators[place]); });
    std::size_t taken = titles().size() - 1;
    for (const std::size_t place : places) {
      taken += width_of(estimators[place]);
      (taken <= width ? shown_ : hidden_).push_back(place);
    }
    std::ranges::sort(shown_);
    std::ranges::sort(hidden_);
  }

  /// The names above the columns.
  std::string titles() const {
    std::string line = "    time   servo";
    for (const std::size_t place : shown_)
      line += fmt::format("{:>{}}", estimators_[place].name, width_of(estimators_[place]));
    return line + (has_gate_ ? "    Kg" : "") + "  counted\n";
  }

  std::string line(const LiveFrame& frame) const {
    const EstimateRow& row = frame.row;
    std::string line =
        fmt::format("{:>6.1f} s{:>8}", to_s(row.arrival - begin_), rate_cell(row.rate_commanded_dps));
    for (const std::size_t place : shown_)
      line += fmt::format("{:>{}}", rate_cell(row.estimates[place]), width_of(estimators_[place]));
    if (const std::optional<float> gain = live::gain_of(estimators_, row))
      line += fmt::format("  {:>4}", std::isnan(*gain) ? "-" : fmt::format("{:.2f}", *gain));
    return line + fmt::format("  {:>7}\n", frame.scores.counted);
  }

  /// "" where all fit.
  std::string hidden() const {
    std::string names;
    for (const std::size_t place : hidden_) names += (names.empty() ? "" : ", ") + estimators_[place].name;
    return names.empty() ? "" : "not shown here: " + names + "\n";
  }

 private:
  HostTime begin_{};
  std::vector<EstimatorColumn> estimators_;
  bool has_gate_ = false;
  std::vector<std::size_t> shown_, hidden_;
};

class LiveLines : public LiveScreen {
 public:
  explicit LiveLines(OutputWriter& output) : output_(output) {}

  void hello(const LiveFacts& facts) override {
    has_servo_ = facts.header.profile.servo.is_there();
    rates_ = RateLines(facts.header.estimators, facts.header.time_reference, terminal_width());
    output_.write(folded(heading_of(facts) + rates_.hidden() + "?: not reliable (yet); rates in deg/s\n"),
                  Matter::word);
  }
  void state(const rig::RecordingProgress&) override {}
  void frame(const LiveFrame& frame) override {
    if (last_ && frame.row.arrival - *last_ < std::chrono::seconds(1)) return;
    last_ = frame.row.arrival;
    const std::string titles = lines_ % 40 == 0 ? rates_.titles() : "";
    if (output_.write(titles + rates_.line(frame), Matter::frame)) ++lines_;
  }
  void note(const std::string& sentence) override {
    output_.write(folded(printable(sentence)) + "\n", Matter::word);
  }
  void ended(const LiveEnd& end, const live::LiveScores& scores) override {
    output_.write_last(folded(ending_of(end, scores, has_servo_)));
  }

 private:
  OutputWriter& output_;
  RateLines rates_;
  bool has_servo_ = true;
  std::optional<HostTime> last_;
  int lines_ = 0;
};

Matter matter_of(web::Topic topic) {
  if (topic == web::Topic::frame) return Matter::frame;
  return topic == web::Topic::state ? Matter::state : Matter::word;
}

class LiveJson : public MessageSink {
 public:
  explicit LiveJson(OutputWriter& output) : output_(output) {}

  bool wants(web::Topic topic) const override {
    return topic != web::Topic::image && topic != web::Topic::surroundings;
  }
  void take(web::Topic topic, const std::string& message) override {
    if (topic == web::Topic::ended)
      output_.write_last(message + "\n");
    else
      output_.write(message + "\n", matter_of(topic));
  }

 private:
  OutputWriter& output_;
};

}  // namespace

std::string heading_of(const LiveFacts& facts) {
  const RecordingHeader& header = facts.header;
  std::string text = fmt::format("{} {}, ", name_of(facts.mode), printable(header.environment));
  if (header.profile.servo.is_there())
    text += fmt::format("plan {}: {} legs, about {}{}\n", printable(facts.plan_name), facts.legs,
                        duration_text(facts.expected_s), facts.repeats ? ", repeated until stopped" : "");
  else
    text += "no servo: rates are shown, and not scored\n";
  if (header.simulated) text += simulated_line(header.simulation_seed, header.simulation);
  const LiveModel& model = header.live_model;
  if (model.name.empty())
    text += "no network (--model FILE)\n";
  else
    text += fmt::format("model {}: {}, Nf {}, Nr {}, {} weights{}{}\n", printable(model.name),
                        model.fusion ? "fusion" : "thermal only", model.frames, model.reduction,
                        printable(model.precision), model.turned > 1 ? ", mean of 8 turns" : "",
                        model.simulated ? ",\ntrained on simulated data" : "");
  if (facts.mode != LiveMode::replay)
    text += facts.recording ? "saving a session\n" : "not saved; use --record\n";
  return text;
}

std::string scores_text(const live::LiveScores& scores) {
  Table table({"estimator", ">frames", ">RMSE", ">MSE", ">median*", ">IQR*", ">angle deg", ">deg/min"});
  for (const live::EstimatorScores& one : scores.estimators)
    table.add({printable(one.name), count_text(one.frames), figure(one.rmse_dps, "{:.2f}"),
               figure(one.mse, "{:.5f}"), figure(one.recent_median_mse, "{:.5f}"),
               figure(one.recent_iqr_mse, "{:.5f}"), figure(one.angle_error_deg, "{:+.2f}"),
               figure(one.drift_deg_per_min, "{:+.2f}")});
  std::string text = table.text();
  text += fmt::format("{} of {} frames counted, {} excluded; RMSE in deg/s; * of the last minute\n",
                      count_text(scores.counted), count_text(scores.frames), count_text(scores.excluded));
  if (std::isfinite(scores.gain_mean))
    text += fmt::format("Kg {:.2f} on average{}\n", scores.gain_mean,
                        scores.gate_collapsed ? ": the gate has collapsed" : "");
  return text;
}

std::string ending_of(const LiveEnd& end, const live::LiveScores& scores, bool has_servo) {
  std::string text;
  if (!has_servo)
    text = "\nno scores: without a servo nothing says how fast the rig was to turn\n";
  else if (scores.frames > 0)
    text = fmt::format("\n{}", scores_text(scores));
  if (!end.session.empty()) text += "session  " + printable(end.session) + "\n";
  if (end.is_error) return text;  // standard error tells the rest
  if (!end.message.empty()) text += "note     " + printable(end.message) + "\n";
  if (!end.advice.empty()) text += "try      " + printable(end.advice) + "\n";
  return text;
}

std::unique_ptr<LiveScreen> make_live_lines(OutputWriter& output) {
  return std::make_unique<LiveLines>(output);
}

std::unique_ptr<MessageSink> make_live_json(OutputWriter& output) {
  return std::make_unique<LiveJson>(output);
}

std::string dropped_line(const DroppedTexts& dropped) {
  return fmt::format("({} lines were left out: the output was not read)\n", count_text(dropped.all()));
}

std::string dropped_object(const DroppedTexts& dropped) {
  nlohmann::json object{{"event", "dropped"}, {"frames", dropped.frames}};
  if (dropped.states > 0) object["states"] = dropped.states;
  if (dropped.words > 0) object["events"] = dropped.words;
  return json_line(object);
}

}  // namespace thermorig::app

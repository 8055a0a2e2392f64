// SPDX-License-Identifier: MIT
#include "joined_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>

namespace thermorig::pipeline {

namespace {

std::vector<TimeEstimate> times_of(const ClockPiece& piece) {
  if (!piece.fit.times.empty()) return piece.fit.times;
  std::vector<TimeEstimate> times;
  times.reserve(piece.causal.size());
  for (const Stamp& stamp : piece.causal)
    times.push_back({stamp.time, stamp.uncertainty_s, stamp.earlier_s, stamp.later_s});
  return times;
}

std::string away_text(const std::string& device, double away_s) {
  std::array<char, 32> seconds{};
  std::snprintf(seconds.data(), seconds.size(), "%.1f", away_s);
  return "the " + device + " was away for " + seconds.data() + " s";
}

/// A mean over the messages of all pieces whose clock was fitted.
class Figures {
 public:
  void add(const ClockReport& report, double messages) {
    if (report.method.empty() || messages <= 0.0) return;
    messages_ += messages;
    for (std::size_t i = 0; i < means.size(); ++i) sums_[i] += messages * report.*means[i];
    for (std::size_t i = 0; i < largest.size(); ++i) most_[i] = std::max(most_[i], report.*largest[i]);
    is_checked_ = is_checked_ && report.bound_wander_ppm > 0.0;
    if (messages > most_messages_) method_ = report.method;
    most_messages_ = std::max(most_messages_, messages);
  }

  void write_to(ClockReport& report) const {
    if (messages_ <= 0.0) return;
    report.method = method_;
    for (std::size_t i = 0; i < means.size(); ++i) report.*means[i] = sums_[i] / messages_;
    for (std::size_t i = 0; i < largest.size(); ++i) report.*largest[i] = most_[i];
    if (!is_checked_) report.bound_wander_ppm = 0.0;
  }

 private:
  using Member = double ClockReport::*;
  static constexpr std::array<Member, 7> means{&ClockReport::rate_hz,        &ClockReport::skew_ppm,
                                               &ClockReport::wander_ppm,     &ClockReport::late_p50_us,
                                               &ClockReport::late_p95_us,    &ClockReport::uncertainty_us,
                                               &ClockReport::bound_median_us};
  static constexpr std::array<Member, 3> largest{&ClockReport::late_max_us, &ClockReport::bound_us,
                                                 &ClockReport::bound_wander_ppm};
  std::array<double, 7> sums_{};
  std::array<double, 3> most_{};
  bool is_checked_ = true;
  double messages_ = 0.0;
  double most_messages_ = 0.0;
  std::string method_;
};

template <typename Item>
void append(std::vector<Item>& to, const std::vector<Item>& from) {
  to.insert(to.end(), from.begin(), from.end());
}

}  // namespace

ClockFit joined(std::vector<ClockPiece> pieces, const std::string& device, double nominal_rate_hz) {
  if (pieces.empty()) return {};
  ClockFit whole;
  whole.report = pieces.front().fit.report;  // the settings, which all of them share
  whole.report.knots.clear();
  whole.report.epochs.clear();
  whole.report.gaps.clear();
  Figures figures;
  for (ClockPiece& piece : pieces) {
    const std::vector<TimeEstimate> times = times_of(piece);
    if (times.empty()) continue;
    std::vector<ClockEpoch> epochs = piece.fit.report.epochs;
    if (epochs.empty()) epochs.push_back({times.front().time, ""});
    if (!whole.times.empty()) {
      const HostTime last = whole.times.back().time;
      const HostTime first = std::max(last, times.front().time);
      const double away_s = to_s(first - last);
      epochs.front() = {first, away_text(device, away_s)};
      const double missing = std::round(away_s * nominal_rate_hz) - 1.0;
      whole.report.gaps.push_back({last, first, static_cast<std::uint64_t>(std::clamp(missing, 0.0, 1e12))});
    }
    for (TimeEstimate time : times) {
      if (!whole.times.empty()) time.time = std::max(time.time, whole.times.back().time);
      whole.times.push_back(time);
    }
    append(whole.report.epochs, epochs);
    append(whole.report.knots, piece.fit.report.knots);
    append(whole.report.gaps, piece.fit.report.gaps);
    figures.add(piece.fit.report, static_cast<double>(times.size()));
  }
  figures.write_to(whole.report);
  return whole;
}

}  // namespace thermorig::pipeline

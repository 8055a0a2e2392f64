// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/live_clock.h"

#include <algorithm>
#include <cmath>

namespace thermorig::timing {

namespace {
// The line runs on from the past, so it wants a shorter window than a parabola through the middle.
constexpr double live_reference_window_s = 8.0;
constexpr double longest_live_window_s = 30.0;

constexpr double shortest_span_s = 1.0;  // a line through less says nothing
constexpr std::size_t fewest_points = 4;
constexpr double outage_s = 1.0;  // a busy host stalls for less
constexpr double lost_periods = 0.6;
constexpr double ahead_periods = 0.5;
constexpr double watch_s = 0.3;  // beyond a stall of the reader
constexpr std::uint32_t fewest_watched = 6;
constexpr std::uint32_t fewest_slow_watched = 3;  // each so long that many chunks bring it
constexpr double slow_s = 0.1;
constexpr double by_chance = 2e-9;  // less probable than that is no chance
constexpr double run_share = 1.0 / 32.0;
constexpr double first_run = 4.0;  // of a device that sends fast
constexpr double restless = 3.0;
constexpr double forget_unrest = 0.7;  // a block
constexpr double nowhere_near_s = 1e9;
constexpr double left_out_two = 1.6;  // periods
constexpr double watched_stray_s = 1.5;
constexpr std::uint32_t fewest_straying = 50;
constexpr double largest_drift = 4000e-6;  // that is tried
constexpr double rise_share = 0.1;         // of a block, in the mean of late
// A wait for a USB frame that slides past tilts the line, at whose end messages are placed.
constexpr double line_end_s = usb_frame_s * uniform_deviation;
constexpr double touching_s = 1e-7;      // so near the line a point holds it up
constexpr double fastest_slew = 500e-6;  // of a host's clock, adjtimex(2)
}  // namespace

LiveClock::LiveClock(const PortProfile& link, double nominal_rate_hz)
    : rate_hz_(nominal_rate_hz), largest_constant_delay_s_(link.largest_constant_delay_s) {
  allow_drift(std::max(link.wander_ppm, 1.0) * 1e-6);
  if (1.0 / rate_hz_ < slow_s) usual_run_ = first_run;
}

void LiveClock::allow_drift(double drift) {
  drift_ = drift;
  const double wander = drift_ * 1e6 / reference_wander_ppm;
  window_s_ = std::min(live_reference_window_s * std::pow(wander, -2.0 / 3.0), longest_live_window_s);
  window_s_ = std::max(window_s_, messages_a_window / rate_hz_);
  block_s_ = window_s_ / blocks_a_window;
}

/// Where even the fastest of many messages came later by the line than any fastest one does, but too little
/// for one to be missing, the clock, or the host's (NTP), wanders further than was allowed for.
void LiveClock::look_for_straying(double late, double x) {
  if (straying_ == 0) stray_x_ = x;
  least_stray_s_ = straying_ == 0 ? late : std::min(least_stray_s_, late);
  if (++straying_ < fewest_straying || x - stray_x_ < watched_stray_s) return;
  straying_ = 0;
  if (least_stray_s_ > largest_constant_delay_s_ && least_stray_s_ < lost_periods * period_s())
    allow_drift(std::max(drift_, std::min(2.0 * drift_, largest_drift)));  // the profile's may be more
}

/// The message's place on the device's clock.
double LiveClock::count(const MessageProof& proof) {
  counted_ += 1.0;
  if (!proof.device_s) return counted_ / rate_hz_;
  const bool is_time = std::isfinite(*proof.device_s) && std::abs(*proof.device_s) < nowhere_near_s;
  return is_time ? *proof.device_s : last_device_s_;
}

std::optional<HostTime> LiveClock::place(const MessageProof& proof) {
  if (!origin_) origin_ = proof.latest;
  const double y = to_s(proof.latest - *origin_);
  double x = count(proof);
  if (proof.device_s && x < last_device_s_) {  // a reset
    rate_known_ = false;
    restart(x, y);
  }
  last_device_s_ = x;
  if (!proof.device_s) x = fitted_ ? recount(proof, x, y) : count_lost(proof, x, y);
  last_y_ = y;
  last_x_ = x;
  if (fitted_ && late_s(x, y) > outage_s) restart(x, y);
  if (!proof.reads.empty()) {
    if (rate_known_) look_for_straying(late_s(x, y), x);
    add(x, y);
    add_reads(proof.reads, x);
  }
  if (!fitted_ || unrest_ > restless) return std::nullopt;
  const double line_s = line_at(x) - least_lateness_s_.value;
  if (!std::isfinite(line_s)) return std::nullopt;
  return *origin_ + from_s(std::clamp(line_s, y - outage_s, y));
}

/// Forgets what was; a rate that was known stays known.
void LiveClock::restart(double x, double y) {
  points_.clear();
  blocks_.clear();
  reads_.clear();
  messages_.clear();
  old_reads_ = old_messages_ = 0;
  open_begin_ = 0;
  first_x_ = open_x_ = x;
  fitted_ = rate_known_;
  slope_ = mean_slope_;
  level_ = y;
  line_x_ = x;
  doubted_until_x_ = x;
  straying_ = 0;
  watched_ = 0;
  watched_late_s_ = {};
  run_ = 0.0;
}

double LiveClock::shift(double x, double periods) {
  straying_ = 0;
  counted_ += periods;
  missing_ += periods;
  run_ = 0.0;
  watched_ = 0;
  watched_late_s_ = {};
  return x + periods / rate_hz_;
}

/// Before there is a line, by the nominal rate: one through a count without them would be too steep.
double LiveClock::count_lost(const MessageProof& proof, double x, double y) {
  const double late_periods = (y - last_y_) * rate_hz_ - 1.0;
  const double lost = std::min(proof.lost_before, std::floor(late_periods + 1.0 - lost_periods));
  return counted_ > 0.0 && lost > 0.0 ? shift(x, lost) : x;
}

/// Of a device that often leaves messages out, how many: two in a row change no turn of the halves, three do
/// as one does. If it was a stall after all, what comes next is ahead.
double LiveClock::left_out(const MessageProof& proof, double late_periods) const {
  if (!left_out_.is_frequent()) return 0.0;
  const double told = proof.left_out ? 1.0 : 0.0;
  if (late_periods - told < left_out_two) return 0.0;
  return told + 2.0 * std::round(0.5 * (late_periods - told));
}

/// Counts what was lost, or takes back what was counted too much.
double LiveClock::recount(const MessageProof& proof, double x, double y) {
  const double late_periods = late_s(x, y) / period_s();
  if (late_periods < -ahead_periods) {
    unrest_ += 1.0;
    return shift(x, std::round(late_periods));
  }
  if (late_s(x, y) > outage_s) return shift(x, std::round(late_periods));
  left_out_.add(proof.left_out);
  if (const double lost = left_out(proof, late_periods); lost > 0.0) return shift(x, lost);
  // Of what the skipped bytes may have been as many as its proof has room for; the watch finds the rest.
  const double lost = std::min(proof.lost_before, std::floor(late_periods + 1.0 - lost_periods));
  if (lost > 0.0) return shift(x, lost);
  if (proof.reads.empty()) return x;
  watch_runs(late_periods);
  if (!watch(late_s(x, y), x) || is_by_chance()) return x;
  const double behind = std::min(watched_late_s_[0], watched_late_s_[1]) / period_s();
  if (behind <= lost_periods + rate_doubt_s() / period_s()) return x;
  unrest_ += 1.0;
  if (behind * period_s() < fastest_slew * window_s_) doubted_until_x_ = x + window_s_;
  return shift(x, std::round(behind));
}

/// Where a host reads late, many messages in a row are as late as a lost one would make them.
void LiveClock::watch_runs(double late_periods) {
  run_ += 1.0;
  if (late_periods > lost_periods) return;
  usual_run_ += run_share * (run_ - usual_run_);
  run_ = 0.0;
}

/// Whether the run may yet end by itself, as those did that were before it.
bool LiveClock::is_by_chance() const {
  return std::pow(1.0 - 1.0 / usual_run_, run_) > by_chance;
}

/// How late a line may run that was drawn before the rate was known, until the one after the next is drawn.
double LiveClock::rate_doubt_s() const {
  return rate_known_ ? 0.0 : 2.0 * block_s_ * rate_slack_s / std::max(line_x_ - first_x_, shortest_span_s);
}

/// Keeps the least lateness of the two last spans that are long enough to be sure; true as one ends.
bool LiveClock::watch(double late, double x) {
  if (watched_ == 0) watch_x_ = x;
  least_late_s_ = watched_ == 0 ? late : std::min(least_late_s_, late);
  const std::uint32_t enough = period_s() < slow_s ? fewest_watched : fewest_slow_watched;
  if (++watched_ < enough || x - watch_x_ < watch_s) return false;
  watched_ = 0;
  watched_late_s_ = {watched_late_s_[1], least_late_s_};
  return true;
}

void LiveClock::add(double x, double y) {
  if (points_.empty()) first_x_ = open_x_ = x;
  if (x >= open_x_ + block_s_) close_block(x);
  points_.push_back({x, y});
  if (fitted_ && points_.size() < fewest_points) level_ = std::min(level_, y - slope_ * (x - line_x_));
}

void LiveClock::add_reads(std::span<const LatestBegin> reads, double x) {
  for (LatestBegin read : reads) {
    read.device_s = x;
    read.held_s = x + read.wire_s - sent_s_;
    sent_s_ = x + read.wire_s;
    reads_.push_back(read);
  }
  messages_.push_back(message_reads(std::span<const LatestBegin>(reads_).last(reads.size())));
}

/// They are moved once half of them are old.
void LiveClock::forget_reads(double before_x) {
  for (; old_messages_ < messages_.size() && reads_[old_reads_].device_s < before_x; ++old_messages_)
    old_reads_ += messages_[old_messages_].count;
  if (2 * old_reads_ < reads_.size()) return;
  messages_.erase(messages_.begin(), messages_.begin() + static_cast<std::ptrdiff_t>(old_messages_));
  reads_.erase(reads_.begin(), reads_.begin() + static_cast<std::ptrdiff_t>(old_reads_));
  old_messages_ = old_reads_ = 0;
}

void LiveClock::close_block(double x) {
  keep_lower_hull(points_, open_begin_, 0.0);
  blocks_.push_back({points_.size() - open_begin_, open_x_});
  std::size_t old = 0;
  std::size_t old_points = 0;
  for (; old < blocks_.size() && blocks_[old].begin_x < x - window_s_; ++old)
    old_points += blocks_[old].points;
  points_.erase(points_.begin(), points_.begin() + static_cast<std::ptrdiff_t>(old_points));
  blocks_.erase(blocks_.begin(), blocks_.begin() + static_cast<std::ptrdiff_t>(old));
  forget_reads(x - window_s_);
  open_begin_ = points_.size();
  open_x_ = x;
  unrest_ *= forget_unrest;
  fit(x);
  if (fitted_) expect_lateness();
}

namespace {
/// How much higher the line would be at its middle without the points that hold it up.
double rise_without_holding(std::span<const Ceiling> points, const Line& line, double slope_limit) {
  std::vector<Ceiling> rest;
  for (const Ceiling& point : points)
    if (point.y - line.at(point.x) >= touching_s) rest.push_back(point);
  return rest.empty() ? 0.0 : std::max(0.0, highest_line(rest, line.middle, slope_limit).a - line.a);
}
}  // namespace

void LiveClock::fit(double x) {
  if (points_.size() < 2) return;
  const double begin_x = points_.front().x;
  const double span_s = points_.back().x - begin_x;
  if (!rate_known_ && span_s < shortest_span_s) return;
  const double drift = drift_ + rate_slack_s / std::max(span_s, 1e-3);
  const double reference =
      rate_known_ && span_s < 0.5 * window_s_ ? mean_slope_ : lower_line_slope(points_, mean_slope_);
  std::vector<Ceiling> level(points_);
  for (Ceiling& point : level) point.y -= points_.front().y + reference * (point.x - begin_x);
  const double limit = rate_known_ && span_s < 0.5 * window_s_ ? drift_ : drift;
  const Line line = highest_line(level, begin_x + 0.5 * span_s, limit);
  const double rise = rise_without_holding(level, line, limit);
  rise_ += (span_s >= 0.9 * window_s_ ? rise_share : 1.0) * (rise - rise_);
  slope_ = reference + line.b;
  line_x_ = x;
  level_ = points_.front().y + reference * (x - begin_x) + line.at(x);
  fitted_ = true;
  if (span_s >= 0.9 * window_s_ || !rate_known_) mean_slope_ = slope_;
  if (span_s >= 0.5 * window_s_) rate_known_ = true;
}

/// As the fit of a whole recording does, from the last seconds alone.
void LiveClock::expect_lateness() {
  if (blocks_.empty() || !std::isfinite(level_) || !std::isfinite(slope_)) return;
  std::vector<CurveRise> knots;
  for (const Block& block : blocks_) knots.push_back({block.begin_x + 0.5 * block_s_, rise_});
  const auto reads = std::span<const LatestBegin>(reads_).subspan(old_reads_);
  const auto messages = std::span<const MessageReads>(messages_).subspan(old_messages_);
  const auto late = [&](std::size_t i) {
    return late_s(reads[i].device_s, to_s(reads[i].latest - *origin_));
  };
  const LeastLateness least =
      least_lateness({reads, messages, 0.0, late}, 1.0 / rate_hz_, knots, window_s_, knots.size() - 1);
  const Estimate& now_s = least.at_knots_s.back();
  longest_silence_s_ = least.longest_hold_s;
  // Through few points a line says little; that much is known beforehand.
  const double most_s = largest_constant_delay_s_ + longest_silence_s_;
  least_lateness_s_ = {std::min(now_s.value, most_s),
                       std::hypot(std::min(now_s.uncertainty, uniform_deviation * most_s), line_end_s)};
}

}  // namespace thermorig::timing

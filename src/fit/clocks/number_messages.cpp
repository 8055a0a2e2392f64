// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <deque>
#include <optional>

#include "thermorig/core/statistics.h"
#include "thermorig/fit/clocks/recorded_clock.h"
#include "thermorig/pipeline/timing/lower_line.h"

namespace thermorig::fit {

using namespace timing;

namespace {
constexpr double shortest_horizon_s = 1.0;  // a busy host stalls for less
constexpr double longest_horizon_s = 64.0;
constexpr std::size_t fewest_horizons =
    16;                                  // in a recording, if one longer than the shortest is to be trusted
constexpr double longest_stall_s = 0.3;  // of a reader on a busy host; anything longer is an outage
constexpr double clear_periods = 0.6;    // so much later than before is a message lost
constexpr double suspect_periods = 0.5;  // where bytes were lost
constexpr double quiet_periods = 0.1;    // a horizon is long enough if the least lateness varies less
constexpr std::size_t windows_a_horizon = 4;  // length of a window in which a period is measured
constexpr double settled_periods = 0.2;
constexpr double usual_share = 0.98;     // of the messages are no later than is usual
constexpr double quiet_host_s = 0.05;    // later than a timer and a wake-up make it: the host is busy
constexpr double most_wander = 1000e-6;  // of a clock from its mean rate, at most
constexpr double most_missing_by_number = 1e9;
constexpr double beyond_all_times_s = 1e18;
constexpr double quicker_share = 0.35;
constexpr std::size_t shortest_piece = 8;  // messages
constexpr int numbering_passes = 3;

/// The least of `values` over each `length` of them: element i covers i .. i + length - 1.
std::vector<double> least_ahead(std::span<const double> values, std::size_t length) {
  std::vector<double> result(values.size());
  std::deque<std::size_t> rising;
  for (std::size_t i = values.size(); i-- > 0;) {
    while (!rising.empty() && values[rising.front()] >= values[i]) rising.pop_front();
    rising.push_front(i);
    while (rising.back() >= i + length) rising.pop_back();
    result[i] = values[rising.back()];
  }
  return result;
}

/// The least of the last `length` values pushed.
class LeastBehind {
 public:
  explicit LeastBehind(std::size_t length) : length_(length) {}
  void push(double value) {
    while (!rising_.empty() && rising_.back().value >= value) rising_.pop_back();
    rising_.push_back({next_, value});
    if (rising_.front().index + length_ <= next_++) rising_.pop_front();
  }
  double least() const { return rising_.front().value; }

 private:
  struct Entry {
    std::size_t index;
    double value;
  };
  std::size_t length_;
  std::size_t next_ = 0;
  std::deque<Entry> rising_;
};

class Numbering {
 public:
  Numbering(std::span<const HostTime> latest, std::span<const bool> suspect, double nominal_rate_hz)
      : suspect_(suspect), number_(latest.size()) {
    for (std::size_t i = 0; i < latest.size(); ++i) number_[i] = static_cast<std::int64_t>(i);
    read(latest);
    any_suspect_ = has_suspect(1, latest.size());
    period_s_ = nominal_rate_hz > 0.0 && std::isfinite(nominal_rate_hz) ? 1.0 / nominal_rate_hz : 0.0;
  }

  std::vector<std::int64_t> run() {
    if (latest_s_.size() < 4 || !choose_horizon()) return number_;
    count_lost();
    for (int pass = 0; pass < numbering_passes; ++pass) {
      if (const auto period_s = counted_period()) period_s_ = *period_s;
      count_lost();
    }
    return number_;
  }

 private:
  void read(std::span<const HostTime> latest) {
    latest_s_.reserve(latest.size());
    for (const HostTime time : latest) {
      const bool unknown = time == HostTime::max();
      const double before_s = latest_s_.empty() ? 0.0 : latest_s_.back();
      const auto since_ns = static_cast<double>(to_ns(time)) - static_cast<double>(to_ns(latest.front()));
      latest_s_.push_back(unknown ? before_s : since_ns * 1e-9);
    }
  }

  bool is_suspect(std::size_t i) const { return i < suspect_.size() && suspect_[i]; }

  /// So long that before and after any message there are some which came with hardly a delay.
  bool choose_horizon() {
    for (double horizon_s = shortest_horizon_s; horizon_s <= longest_horizon_s; horizon_s *= 2.0) {
      const double guess_s = period_s_ > 0.0 ? period_s_ : mean_period_s();
      horizon_ = messages_in(horizon_s, guess_s);
      const auto period_s = first_period();
      if (!period_s) return false;
      period_s_ = *period_s;
      horizon_ = messages_in(horizon_s, period_s_);
      unrest_ = least_lateness_varies();
      if (unrest_ <= quiet_periods) return true;
      if (fewest_horizons * horizon_ >= latest_s_.size()) break;
    }
    return false;  // not a steady device, or far too irregular a link: nothing can be said to be lost
  }

  double mean_period_s() const {
    return (latest_s_.back() - latest_s_.front()) / static_cast<double>(latest_s_.size());
  }
  static std::size_t messages_in(double time_s, double period_s) {
    return static_cast<std::size_t>(std::clamp(time_s / std::max(period_s, 1e-6), 8.0, 1e7));
  }

  /// The period before any loss is counted: of pieces without a suspect loss, no longer than a horizon. A
  /// loss makes a piece slower, so the typical piece among the quicker ones counts.
  std::optional<double> first_period() const {
    std::vector<Piece> pieces;
    for (std::size_t begin = 0; begin < latest_s_.size();) {
      std::size_t end = begin + 1;
      while (end < latest_s_.size() && end < begin + horizon_ && !is_suspect(end)) ++end;
      add_piece(begin, end - begin, pieces);
      begin = end;
    }
    return typical_slope(std::move(pieces), any_suspect_ ? 0.5 : quicker_share);
  }

  /// The period when losses are counted.
  std::optional<double> counted_period() const {
    std::vector<Piece> pieces;
    const std::size_t length = std::min(windows_a_horizon * horizon_, latest_s_.size());
    for (std::size_t begin = 0; begin + length <= latest_s_.size();
         begin += std::max<std::size_t>(1, length / 2))
      add_piece(begin, length, pieces);
    return typical_slope(std::move(pieces), 0.5);
  }

  struct Piece {
    double slope = 0.0;
    double weight = 0.0;
  };

  void add_piece(std::size_t begin, std::size_t length, std::vector<Piece>& pieces) const {
    if (length < shortest_piece) return;
    const double slope = window_slope(begin, length);
    if (slope > 0.0) pieces.push_back({slope, static_cast<double>(length * length)});
  }

  /// The slope below which `share` of the weight is.
  static std::optional<double> typical_slope(std::vector<Piece> pieces, double share) {
    std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) { return a.slope < b.slope; });
    double left = 0.0;
    for (const Piece& piece : pieces) left += share * piece.weight;
    for (const Piece& piece : pieces)
      if ((left -= piece.weight) <= 0.0) return piece.slope;
    return std::nullopt;
  }

  bool has_suspect(std::size_t begin, std::size_t end) const {
    for (std::size_t i = begin; i < end; ++i)
      if (is_suspect(i)) return true;
    return false;
  }

  double window_slope(std::size_t begin, std::size_t length) const {
    std::vector<Ceiling> window(length);
    for (std::size_t i = 0; i < length; ++i)
      window[i] = {static_cast<double>(number_[begin + i] - number_[begin]), latest_s_[begin + i]};
    return lower_line_slope(window, 0.0);
  }

  std::vector<double> lateness_s() const {
    std::vector<double> late_s(latest_s_.size());
    for (std::size_t i = 0; i < late_s.size(); ++i)
      late_s[i] = latest_s_[i] - period_s_ * static_cast<double>(i);
    return late_s;
  }

  /// From horizon to horizon, whole periods (losses) taken off, in periods: 0 to 0.5.
  double least_lateness_varies() const {
    const std::vector<double> ahead_s = least_ahead(lateness_s(), horizon_);
    std::vector<double> steps{0.0};
    for (std::size_t i = horizon_; i + horizon_ <= ahead_s.size();
         i += std::max<std::size_t>(1, horizon_ / 2)) {
      const double step = (ahead_s[i] - ahead_s[i - horizon_]) / period_s_;
      steps.push_back(std::abs(step - std::round(step)));
    }
    return lower_quantile(steps, 0.75);
  }

  /// Walks along the messages. Where all that follow for a horizon are later than the least late ones before
  /// by a period or more, as many are missing.
  void count_lost() {
    const std::vector<double> late_s = lateness_s();
    const std::vector<double> ahead_s = least_ahead(late_s, horizon_);
    usual_late_s_ = usual_lateness_s(late_s, ahead_s);
    LeastBehind behind_s(horizon_);
    double missing = 0.0;
    std::size_t i = 0;
    const auto number_until = [&](std::size_t end, double least_s) {
      for (; i < end; ++i) {
        number_[i] = static_cast<std::int64_t>(i) + static_cast<std::int64_t>(missing);
        behind_s.push(std::max(late_s[i] - missing * period_s_, least_s));
      }
    };
    number_until(1, -beyond_all_times_s);
    while (i < late_s.size()) {
      const double before_s = behind_s.least();
      const double lost = lost_before(i, ahead_s[i] - missing * period_s_ - before_s);
      const Place place =
          lost > 0.0 ? find_place(late_s, i, before_s + missing * period_s_, lost) : Place{i + 1, i + 1};
      number_until(place.first, -beyond_all_times_s);
      missing += lost;
      // Where exactly they were lost is a guess: it must not make those right after it look early.
      number_until(place.settled, before_s);
    }
  }

  /// Behind the least late one of the next horizon: what a link's timer and the system's wake-up make. A busy
  /// host knows no such limit.
  double usual_lateness_s(std::span<const double> late_s, std::span<const double> ahead_s) const {
    std::vector<double> behind_s(late_s.size());
    for (std::size_t i = 0; i < late_s.size(); ++i) behind_s[i] = late_s[i] - ahead_s[i];
    const double usual_s = lower_quantile(behind_s, usual_share);
    return usual_s < quiet_host_s ? usual_s + settled_periods * period_s_ : beyond_all_times_s;
  }

  double lost_before(std::size_t i, double step_s) const {
    if (step_s < suspect_periods * period_s_) return 0.0;
    const double left_s = static_cast<double>(latest_s_.size() - i) * period_s_;
    if (step_s < longest_stall_s && left_s < longest_stall_s) return 0.0;  // the end: it may be late only
    const std::size_t near = std::min(i + horizon_ / 8, latest_s_.size());
    const double enough = has_suspect(i, near) ? suspect_periods : clear_periods;
    if (step_s < enough * period_s_) return 0.0;
    return std::min(std::max(1.0, std::round(step_s / period_s_)), most_missing_by_number);
  }

  /// Where messages are missing.
  struct Place {
    std::size_t first = 0;    // message after them
    std::size_t settled = 0;  // one past the first message that is as early as those after it
  };

  /// From message `i` on. One that is earlier than those after the loss can be was sent before it. The next
  /// one before which bytes were lost is the place; none near: where the stream paused longest, up to the
  /// first that is about as early as those after the loss.
  Place find_place(std::span<const double> late_s, std::size_t i, double before_s, double lost) const {
    const double drift_s = std::min(most_wander * lost, 0.2) * period_s_;  // while nothing came
    const double after_s = before_s + lost * period_s_;
    const std::size_t first = first_possible(late_s, i, after_s - noise_s() - drift_s);
    const std::size_t near = messages_in(longest_stall_s, period_s_);
    Place place{first, first + 1};
    for (std::size_t k = first; k < std::min(first + horizon_, late_s.size()); ++k) {
      const bool is_near = k < first + near;
      if (is_better(late_s, k, place.first, is_near)) place.first = k;
      if (late_s[k] <= after_s + settled_periods * period_s_ + drift_s) {
        place.settled = std::max(place.settled, k + 1);
        if (!any_suspect_ || is_suspect(place.first) || !is_near) break;
      }
      // Too late for one that was sent before the loss, and as late as is usual for one sent after it.
      if (late_s[k] > before_s + usual_late_s_ && late_s[k] <= after_s + usual_late_s_) break;
    }
    place.settled = std::max(place.settled, place.first + 1);
    return place;
  }

  bool is_better(std::span<const double> late_s, std::size_t k, std::size_t best, bool is_near) const {
    if (is_suspect(best)) return false;
    if (is_near && is_suspect(k)) return true;
    return late_s[k] - late_s[k - 1] > late_s[best] - late_s[best - 1];
  }

  double noise_s() const { return std::clamp(3.0 * unrest_, 0.03, 0.3) * period_s_; }

  std::size_t first_possible(std::span<const double> late_s, std::size_t i, double earliest_s) const {
    std::size_t first = i;
    for (std::size_t k = i; k + 1 < std::min(i + horizon_, late_s.size()); ++k)
      if (late_s[k] < earliest_s) first = k + 1;
    return first;
  }

  std::span<const bool> suspect_;
  std::vector<double> latest_s_;  // since the first
  std::vector<std::int64_t> number_;
  double period_s_ = 0.0;
  std::size_t horizon_ = 0;    // messages
  double usual_late_s_ = 0.0;  // no later than that are nearly all messages
  double unrest_ = 0.0;        // of the least lateness from horizon to horizon, in periods
  bool any_suspect_ = false;
};
}  // namespace

std::vector<std::int64_t> number_messages(std::span<const HostTime> latest, std::span<const bool> suspect,
                                          double nominal_rate_hz) {
  return Numbering(latest, suspect, nominal_rate_hz).run();
}

}  // namespace thermorig::fit

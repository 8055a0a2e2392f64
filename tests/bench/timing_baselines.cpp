// SPDX-License-Identifier: MIT
#include "timing_baselines.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

namespace thermorig::bench {
namespace {

struct Line {
  double at_zero_s = 0.0;
  double rate = 1.0;
};

std::vector<double> along(const Line& line, std::span<const Arrival> arrivals) {
  std::vector<double> times;
  times.reserve(arrivals.size());
  for (const Arrival& arrival : arrivals) times.push_back(line.at_zero_s + line.rate * arrival.device_s);
  return times;
}

/// Twice the area of a triangle: positive for a turn to the left.
double turn(const Arrival& a, const Arrival& b, const Arrival& c) {
  return (b.device_s - a.device_s) * (c.host_s - a.host_s) -
         (b.host_s - a.host_s) * (c.device_s - a.device_s);
}

std::vector<Arrival> lower_hull(std::span<const Arrival> arrivals) {
  std::vector<Arrival> hull;
  for (const Arrival& arrival : arrivals) {
    while (hull.size() > 1 && turn(hull[hull.size() - 2], hull.back(), arrival) <= 0.0) hull.pop_back();
    hull.push_back(arrival);
  }
  return hull;
}

/// The state of Klipper's ClockSync; names and constants are its own. Its clock here counts in seconds.
class KlipperClock {
 public:
  void add(const RoundTrip& trip) {
    const double sent_time = trip.host_sent_s, clock = trip.device_received_s;
    const double half_rtt = 0.5 * (trip.host_arrived_s - sent_time);
    if (half_rtt < min_half_rtt_ + (sent_time - min_rtt_time_) * rtt_age) {
      min_half_rtt_ = half_rtt;
      min_rtt_time_ = sent_time;
    }
    if (count_++ == 0) {
      time_avg_ = sent_time;
      clock_avg_ = clock;
      return;
    }
    if (!predicts(sent_time, clock)) return;
    const double diff_sent_time = sent_time - time_avg_;
    time_avg_ += decay * diff_sent_time;
    time_variance_ = (1.0 - decay) * (time_variance_ + diff_sent_time * diff_sent_time * decay);
    const double diff_clock = clock - clock_avg_;
    clock_avg_ += decay * diff_clock;
    clock_covariance_ = (1.0 - decay) * (clock_covariance_ + diff_sent_time * diff_clock * decay);
    freq_ = clock_covariance_ / time_variance_;
  }
  double time_of(double clock) const { return time_avg_ + min_half_rtt_ + (clock - clock_avg_) / freq_; }

 private:
  static constexpr double decay = 1.0 / 30.0;
  static constexpr double rtt_age = 0.000010 / 3600.0;

  /// False: an outlier that is left out.
  bool predicts(double sent_time, double clock) {
    const double off = clock - ((sent_time - time_avg_) * freq_ + clock_avg_);
    if (off * off > 25.0 * prediction_variance_ && std::abs(off) > 0.0005) {
      if (off > 0.0 && sent_time < last_prediction_time_ + 10.0) return false;
      prediction_variance_ = 0.001 * 0.001;
      return true;
    }
    last_prediction_time_ = sent_time;
    prediction_variance_ = (1.0 - decay) * (prediction_variance_ + off * off * decay);
    return true;
  }

  double min_half_rtt_ = 1e9, min_rtt_time_ = 0.0;
  double time_avg_ = 0.0, time_variance_ = 0.0, clock_avg_ = 0.0, clock_covariance_ = 0.0;
  double prediction_variance_ = 0.001 * 0.001, last_prediction_time_ = 0.0;
  double freq_ = 1.0;
  int count_ = 0;
};

}  // namespace

std::vector<double> arrival_times(std::span<const Arrival> arrivals) {
  std::vector<double> times;
  times.reserve(arrivals.size());
  for (const Arrival& arrival : arrivals) times.push_back(arrival.host_s);
  return times;
}

std::vector<double> least_squares_line(std::span<const Arrival> arrivals) {
  double mean_device_s = 0.0;
  double mean_host_s = 0.0;
  const auto count = static_cast<double>(arrivals.size());
  for (const Arrival& arrival : arrivals) {
    mean_device_s += arrival.device_s / count;
    mean_host_s += arrival.host_s / count;
  }
  double squares = 0.0;
  double products = 0.0;
  for (const Arrival& arrival : arrivals) {
    squares += std::pow(arrival.device_s - mean_device_s, 2);
    products += (arrival.device_s - mean_device_s) * (arrival.host_s - mean_host_s);
  }
  const double rate = squares > 0.0 ? products / squares : 1.0;
  return along({mean_host_s - rate * mean_device_s, rate}, arrivals);
}

std::vector<double> recursive_least_squares(std::span<const Arrival> arrivals) {
  constexpr double half_life_s = 90.0;
  std::vector<double> times;
  if (arrivals.empty()) return times;
  const Arrival first = arrivals.front();
  const double span_s = arrivals.back().device_s - first.device_s;
  const double messages = std::max(1.0, static_cast<double>(arrivals.size() - 1));
  const double keep = std::pow(2.0, -span_s / messages / half_life_s);
  double offset_s = 0.0, rate = 1.0;
  double p00 = 1e10, p01 = 0.0, p11 = 1e10;
  for (const Arrival& arrival : arrivals) {
    const double x = arrival.device_s - first.device_s;
    const double error_s = arrival.host_s - first.host_s - offset_s - rate * x;
    const double to0 = (p00 + p01 * x) / keep;
    const double to1 = (p01 + p11 * x) / keep;
    const double gain = 1.0 / (1.0 + to0 + x * to1);
    offset_s += gain * to0 * error_s;
    rate += gain * to1 * error_s;
    p00 = p00 / keep - gain * to0 * to0;
    p01 = p01 / keep - gain * to0 * to1;
    p11 = p11 / keep - gain * to1 * to1;
    times.push_back(first.host_s + offset_s + rate * x);
  }
  return times;
}

std::vector<double> convex_hull_line(std::span<const Arrival> arrivals) {
  const std::vector<Arrival> hull = lower_hull(arrivals);
  if (hull.size() < 2) return arrival_times(arrivals);
  const double middle_s = (arrivals.front().device_s + arrivals.back().device_s) / 2;
  std::size_t end = 1;
  while (end + 1 < hull.size() && hull[end].device_s < middle_s) ++end;
  const Arrival& from = hull[end - 1];
  const double rate = (hull[end].host_s - from.host_s) / (hull[end].device_s - from.device_s);
  return along({from.host_s - rate * from.device_s, rate}, arrivals);
}

std::vector<double> fastest_round_trips(std::span<const double> device_s, std::span<const RoundTrip> trips) {
  constexpr std::size_t probes = 8;
  std::vector<double> times;
  std::size_t next = 0;
  double offset_s = 0.0;
  for (const double at_s : device_s) {
    while (next + probes <= trips.size() &&
           (times.empty() || trips[next + probes - 1].device_sent_s <= at_s)) {
      const auto delay_s = [](const RoundTrip& trip) {
        return trip.host_arrived_s - trip.host_sent_s - (trip.device_sent_s - trip.device_received_s);
      };
      const auto group = trips.subspan(next, probes);
      const RoundTrip best =
          *std::min_element(group.begin(), group.end(),
                            [&](const RoundTrip& a, const RoundTrip& b) { return delay_s(a) < delay_s(b); });
      offset_s = (best.host_sent_s - best.device_received_s + best.host_arrived_s - best.device_sent_s) / 2;
      next += probes;
      if (times.empty()) break;
    }
    times.push_back(at_s + offset_s);
  }
  return times;
}

std::vector<double> klipper_regression(std::span<const double> device_s, std::span<const RoundTrip> trips) {
  constexpr double interval_s = 0.9839;
  std::vector<double> times;
  KlipperClock clock;
  std::size_t next = 0;
  double asked_s = -1e9;
  for (const double at_s : device_s) {
    for (; next < trips.size() && (times.empty() || trips[next].device_sent_s <= at_s); ++next) {
      if (trips[next].host_sent_s - asked_s < interval_s) continue;
      asked_s = trips[next].host_sent_s;
      clock.add(trips[next]);
      if (times.empty()) break;
    }
    times.push_back(clock.time_of(at_s));
  }
  return times;
}

}  // namespace thermorig::bench

// SPDX-License-Identifier: MIT
#pragma once

#include <deque>
#include <string>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/recording/preflight.h"
#include "thermorig/sensors/wire/counters.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::rig {

/// Counters of everything that the preflight check compares, at one moment.
struct PreflightCounts {
  std::optional<wire::ServoWelcome> welcome;  // of the servo
  PerDevice<wire::Counters> wire;
  std::uint64_t requests = 0;
  std::uint64_t retries = 0;
  std::string how_servo_rests;  // where nobody reaches it any more
  PerDevice<bool> gone{};       // not there, and not needed
};

/// Listens to a rig that is not armed: from begin() on, at most the last five seconds, or a few messages of a
/// device that sends more seldom. Pure.
class PreflightWatch {
 public:
  static constexpr double least_s = 3.0;  // so long at least: 24 frames of a camera at 8 Hz

  /// All devices send: what came before does not count. `profile` names their nominal rates.
  void begin(HostTime now, const PreflightCounts& counts, const RigProfile& profile);

  /// The counters now and then, at each tick: they are compared over the same time as the messages.
  void counted(HostTime now, const PreflightCounts& counts);

  /// For how long it must listen before it can judge: `least_s`, and three messages of every device
  /// that is there.
  static double needed_s(const RigProfile& profile, const PerDevice<bool>& gone);

  bool has_begun() const { return begin_.has_value(); }
  double heard_s(HostTime now) const { return begin_ ? to_s(now - *begin_) : 0.0; }

  void frame(const TimedFrame& frame);
  void gyro(const TimedGyro& gyro);
  void servo(const TimedServo& servo);
  void round_trip(HostDuration time, HostTime arrived);  // of a request to the servo

  PreflightFacts facts(HostTime now, const PreflightCounts& counts, const RigProfile& profile) const;

 private:
  struct Heard {
    HostTime time{};  // of arrival
    double uncertainty_s = 0.0;
    std::uint16_t missing_before = 0;
    std::optional<std::int64_t> device_us;
  };
  struct Image {
    HostTime time{};
    bool even = false, odd = false, repeats = false, half_lost = false;
    double sensor_c = 0.0;
  };
  struct Rate {
    HostTime time{};
    TimedGyro sample;
  };
  struct Counted {
    HostTime time{};
    PreflightCounts counts;
  };
  struct RoundTrip {
    HostTime time{};  // of the answer
    double took_s = 0.0;
  };
  void hear(Device device, const Stamp& stamp, Heard heard);
  template <typename Entry>
  void forget_old(std::deque<Entry>& entries) const;
  std::optional<PreflightStream> stream(Device device, HostTime now, const PreflightCounts& counts,
                                        const RigProfile& profile) const;
  double span_s(Device device, HostTime now, double period_s) const;
  std::optional<PreflightImages> images() const;
  std::optional<PreflightRest> rest() const;
  PreflightAnswers answers(const PreflightCounts& counts) const;

  std::optional<HostTime> begin_;
  HostDuration window_{};
  std::deque<Counted> counted_;  // the first: at the window's begin
  PerDevice<std::deque<Heard>> heard_;
  std::deque<Image> images_;
  std::deque<Rate> rates_;
  std::deque<RoundTrip> round_trips_;
};

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cmath>
#include <limits>

#include "message_marks.h"
#include "thermorig/core/statistics.h"
#include "thermorig/core/validity.h"
#include "thermorig/storage/session/session.h"
#include "verdict.h"

namespace thermorig::session {

namespace {

constexpr double window_s = 1.0;

HostTime time_of(HostTime time) {
  return time;
}
HostTime time_of(const FrameMark& mark) {
  return mark.time;
}

template <typename Mark>
std::vector<double> times_s(const std::vector<Mark>& marks) {
  std::vector<double> times;
  times.reserve(marks.size());
  for (const Mark& mark : marks) times.push_back(to_s(time_of(mark).time_since_epoch()));
  std::sort(times.begin(), times.end());
  return times;
}

template <typename Message>
std::vector<HostTime> times_of(const std::vector<Message>& messages) {
  std::vector<HostTime> times;
  times.reserve(messages.size());
  for (const Message& message : messages) times.push_back(message.stamp.time);
  return times;
}

MessageMarks marks_of(const Session& session) {
  MessageMarks marks{{}, times_of(session.gyro), times_of(session.servo)};
  marks.frames.reserve(session.frames.size());
  for (const TimedFrame& frame : session.frames)
    marks.frames.push_back(
        {frame.stamp.time, frame.stamp.arrival, frame.fresh_even, frame.fresh_odd, frame.missing_before});
  return marks;
}

void add_gap(Quality::Stream& stream, const std::vector<double>& times) {
  for (std::size_t i = 1; i < times.size(); ++i)
    stream.gap_max_s = std::max(stream.gap_max_s, times[i] - times[i - 1]);
}

/// The rate of a window reaches from its first message to the first of the next, so that it is not quantised.
void add_rates(Quality::Stream& stream, const std::vector<double>& times) {
  if (times.size() < 2) return;
  stream.rate_mean_hz = static_cast<double>(times.size() - 1) / (times.back() - times.front());
  stream.rate_min_hz = stream.rate_max_hz = stream.rate_mean_hz;
  bool first_window = true;
  for (std::size_t begin = 0; begin < times.size();) {
    std::size_t end = begin;
    while (end < times.size() && times[end] < times[begin] + window_s) ++end;
    if (end == times.size()) return;  // the last window is not whole
    const double rate_hz = static_cast<double>(end - begin) / (times[end] - times[begin]);
    stream.rate_min_hz = first_window ? rate_hz : std::min(stream.rate_min_hz, rate_hz);
    stream.rate_max_hz = first_window ? rate_hz : std::max(stream.rate_max_hz, rate_hz);
    first_window = false;
    begin = end;
  }
}

Quality::Stream stream_of(const wire::Counters& counters, const std::vector<double>& times) {
  Quality::Stream stream;
  stream.received = counters.messages;
  stream.lost = counters.lost;
  stream.bad = counters.bad_checksum + counters.bad_length + counters.bad_value;
  add_rates(stream, times);
  add_gap(stream, times);
  return stream;
}

/// Whether the device went between the two times, and was waited for: what it did not send then is not lost
/// to any leg.
bool was_awaited(const Session& session, Device device, HostTime before, HostTime after) {
  return std::any_of(session.raw.events.begin(), session.raw.events.end(), [&](const RecordingEvent& event) {
    return event.kind == EventKind::device_lost && event.source == device && before <= event.time &&
           event.time < after;
  });
}

Quality::Stream camera_stream(const Session& session, const std::vector<FrameMark>& frames) {
  auto stream = stream_of(session.counters[Device::camera], times_s(frames));
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (frames[i].missing_before == 0) continue;
    if (i > 0 && was_awaited(session, Device::camera, frames[i - 1].arrival, frames[i].arrival)) continue;
    stream.lost += frames[i].missing_before;
  }
  stream.repeated =
      static_cast<std::uint64_t>(std::count_if(frames.begin(), frames.end(), [](const auto& frame) {
        return frame.fresh_even == 0 && frame.fresh_odd == 0;
      }));
  return stream;
}

/// A gyro numbers nothing: what never came shows in its steady rate, or in its own time.
Quality::Stream gyro_stream(const Session& session, const std::vector<HostTime>& times) {
  auto stream = stream_of(session.counters[Device::gyro], times_s(times));
  const ClockReport& clock = session.sync.clock[Device::gyro];
  for (const ClockGap& gap : clock.gaps) {
    if (was_awaited(session, Device::gyro, gap.begin, gap.end)) continue;
    // Before format 1.3 one wrong time of the gyro could make a gap of any size.
    const double room = std::ceil(std::max(to_s(gap.end - gap.begin), 0.0) * clock.rate_hz) + 1.0;
    stream.lost += static_cast<std::uint64_t>(std::min(static_cast<double>(gap.missing), room));
  }
  return stream;
}

std::vector<Quality::Speed> speeds_of(const Session& session) {
  std::map<std::uint16_t, double> rate_of_leg;
  std::map<double, Quality::Speed> speeds;
  for (const auto& leg : session.raw.legs) {
    rate_of_leg[leg.leg] = leg.rate_dps;
    speeds[leg.rate_dps].rate_dps = leg.rate_dps;
  }
  for (const auto& sample : session.samples) {
    const auto leg = rate_of_leg.find(sample.leg);
    if (leg == rate_of_leg.end()) continue;
    ++speeds[leg->second].frames;
    speeds[leg->second].valid += sample.valid ? 1 : 0;
  }
  std::vector<Quality::Speed> ascending;
  for (const auto& [rate_dps, speed] : speeds) ascending.push_back(speed);
  return ascending;
}

/// A ramp or a reversal makes a frame invalid anyway, and says nothing of gyro and servo at odds.
bool has_no_other_reason(const LabelledSample& sample) {
  return (sample.reason_bits & ~warning_bits & ~bit(Reason::gyro_disagrees)) == 0;
}

void count_samples(const Session& session, Quality& quality) {
  const bool has_legs = session.raw.header.profile.servo.is_there();  // else all frames count as swept
  quality.frames = session.samples.size();
  for (const auto& sample : session.samples) {
    quality.valid += sample.valid ? 1 : 0;
    if (has_legs && sample.leg == 0) continue;
    ++quality.swept;
    const bool disagrees = (sample.reason_bits & bit(Reason::gyro_disagrees)) != 0;
    const bool sound = sample.valid || (disagrees && has_no_other_reason(sample));
    quality.sound += sound ? 1 : 0;
    quality.disagreeing += sound && disagrees ? 1 : 0;
    for (std::size_t i = 0; i < reason_count; ++i)
      if ((sample.reason_bits & bit(static_cast<Reason>(i))) != 0)
        ++quality.reason_counts[std::string(reason_names[i])];
  }
}

double rate_shaft_uncertainty_dps(const std::vector<LabelledSample>& samples) {
  std::vector<float> values;
  for (const auto& sample : samples)
    if (sample.valid && !std::isnan(sample.rate_shaft_uncertainty_dps))
      values.push_back(sample.rate_shaft_uncertainty_dps);
  return values.empty() ? std::numeric_limits<double>::quiet_NaN() : double{reordering_median(values)};
}

/// Root mean square of the corrected gyro minus the label over the frames within legs against which nothing
/// speaks but, it may be, the gyro itself. The scale that gyro and servo share cannot be told from them.
double gyro_residual_dps(const Session& session) {
  const GyroErrors& gyro = session.sync.gyro;
  const ServoResponse& servo = session.sync.servo;
  double squares = 0.0, count = 0.0;
  for (const auto& sample : session.samples) {
    if (sample.leg == 0 || !has_no_other_reason(sample)) continue;
    if (contradicts_command(servo, sample.rate_commanded_dps)) continue;
    const double gyro_dps = (sample.rate_gyro_dps - bias_dps_at(gyro, sample.time)) / gyro.scale.value;
    const double shaft_dps = sample.rate_shaft_dps * servo.gyro_ratio.value / servo.scale.value;
    if (!std::isfinite(gyro_dps - shaft_dps)) continue;
    squares += (gyro_dps - shaft_dps) * (gyro_dps - shaft_dps);
    count += 1.0;
  }
  return count > 0.0 ? std::sqrt(squares / count) : std::numeric_limits<double>::quiet_NaN();
}

void add_sync(const Session& session, Quality& quality) {
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  const SyncReport& sync = session.sync;
  for (const Device device : all_devices) {
    const ClockReport& clock = sync.clock[device];
    const bool fitted = !clock.method.empty();
    quality.clock[device] = {.uncertainty_s = fitted ? 1e-6 * clock.uncertainty_us : unknown,
                             .bound_s = fitted ? 1e-6 * clock.bound_median_us : unknown};
  }
  quality.camera_offset_s = sync.camera_offset.offset_s;
  quality.rate_shaft_uncertainty_dps = rate_shaft_uncertainty_dps(session.samples);
  quality.gyro_residual_dps = sync.servo.fitted && sync.gyro.bias_dps ? gyro_residual_dps(session) : unknown;
}

}  // namespace

Quality quality_of(const Session& session) {
  return quality_of(session, marks_of(session));
}

Quality quality_of(const Session& session, const MessageMarks& marks) {
  Quality quality;
  quality.stream[Device::camera] = camera_stream(session, marks.frames);
  quality.stream[Device::gyro] = gyro_stream(session, marks.gyro);
  quality.stream[Device::servo] = stream_of(session.counters[Device::servo], times_s(marks.servo));
  quality.duration_s = to_s(session.raw.end_time - session.raw.header.time_reference);
  count_samples(session, quality);
  quality.speeds = speeds_of(session);
  add_sync(session, quality);
  judge(session, quality);
  return quality;
}

}  // namespace thermorig::session

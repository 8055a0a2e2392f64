// SPDX-License-Identifier: MIT
#include "recorded_stream.h"

#include <algorithm>
#include <cmath>
#include <map>

#include "thermorig/pipeline/timing/link_timing.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/wire/camera_scanner.h"

namespace thermorig::timing {

namespace {
constexpr double step_s = 0.05;

struct Understood {
  StreamSpan span;
  bool lost_before = false;
};

/// The messages in a device's bytes.
class Scanners {
 public:
  Scanners(Device device, const RigProfile& profile)
      : device_(device), camera_(profile.camera.checksum), gyro_(sensors::gyro_scanner(profile.gyro)) {}

  void push(std::span<const std::uint8_t> bytes, std::vector<Understood>& out) {
    if (device_ == Device::camera) {
      camera_.push(bytes, frames_);
      for (const auto& frame : frames_) out.push_back({frame.span, frame.resync_before});
      frames_.clear();
    } else {
      gyro_.push(bytes, samples_);
      for (const auto& sample : samples_) out.push_back({sample.span, sample.lost_before});
      samples_.clear();
    }
  }

 private:
  Device device_;
  wire::CameraScanner camera_;
  sensors::GyroScanner gyro_;
  std::vector<wire::CameraMessage> frames_;
  std::vector<wire::GyroMessage> samples_;
};

simulation::VirtualRigConfig rig_config(Device device, const TestLink& link, std::uint64_t seed) {
  simulation::VirtualRigConfig config = simulation::default_rig(seed, "laboratory");
  config.links[device] = {
      .kind = link.kind, .latency_timer_s = link.latency_timer_s, .loaded_host = link.loaded_host};
  if (link.kind == simulation::UsbLink::cdc) config.profile.link(device).baud = 0;
  config.camera_latency_s = 0.020;
  config.gyro_latency_s = 0.001;
  return config;
}

void add_truth(const std::vector<simulation::SentMessage>& sent, double latency_s, RecordedStream& stream) {
  std::map<std::uint64_t, const simulation::SentMessage*> by_begin;
  for (const auto& message : sent)
    if (message.arrives) by_begin[message.span.begin] = &message;
  for (const StreamSpan& span : stream.spans) {
    const simulation::SentMessage& message = *by_begin.at(span.begin);
    stream.sample_time.push_back(message.exposure_end + from_s(latency_s));
    stream.index.push_back(static_cast<std::int64_t>(message.index));
  }
  const std::int64_t first = stream.index.empty() ? 0 : stream.index.front();
  for (std::int64_t& index : stream.index) index -= first;
}
}  // namespace

std::vector<TestLink> links(bool loaded_host) {
  using simulation::UsbLink;
  return {{"ftdi16", UsbLink::ftdi, 0.016, loaded_host},
          {"ftdi1", UsbLink::ftdi, 0.001, loaded_host},
          {"ch340", UsbLink::ch340, 0.016, loaded_host},
          {"cdc", UsbLink::cdc, 0.016, loaded_host}};
}

RecordedStream record_stream(Device device, const TestLink& link, std::uint64_t seed, double duration_s,
                             const std::vector<simulation::Outage>& outages) {
  simulation::VirtualRigConfig config = rig_config(device, link, seed);
  config.outages = outages;
  simulation::VirtualRig rig(config, simulation::make_host_firmware());
  rig.keep_truth(true);
  Scanners scanners(device, config.profile);
  std::vector<Understood> messages;
  RecordedStream stream;
  for (double time_s = 0.0; time_s < duration_s; time_s += step_s)
    for (const Chunk& chunk : rig.advance(HostTime(from_s(time_s + step_s)))) {
      if (chunk.device != device) continue;
      stream.received.append(chunk.bytes, chunk.arrived);
      scanners.push(chunk.bytes, messages);
    }
  const bool is_camera = device == Device::camera;
  stream.link = config.profile.link(device);
  stream.link.latency_s = 0.0;  // the truth has it
  stream.nominal_rate_hz =
      is_camera ? config.profile.camera.output_rate_hz : config.profile.gyro.output_rate_hz;
  stream.suspect = std::make_unique<bool[]>(messages.size());
  for (const Understood& message : messages) {
    stream.suspect[stream.spans.size()] = message.lost_before;
    stream.spans.push_back(message.span);
  }
  add_truth(is_camera ? rig.sent_frames() : rig.sent_gyro(), is_camera ? 0.020 : 0.001, stream);
  return stream;
}

RecordedStream RecordedStream::without(const std::function<bool(std::size_t)>& is_lost,
                                       bool is_flagged) const {
  RecordedStream rest{.link = link, .nominal_rate_hz = nominal_rate_hz, .received = received};
  rest.suspect = std::make_unique<bool[]>(spans.size());
  bool lost_before = false;
  for (std::size_t i = 0; i < spans.size(); ++i) {
    if (is_lost(i)) {
      lost_before = true;
      continue;
    }
    rest.suspect[rest.spans.size()] = is_flagged && lost_before;
    rest.spans.push_back(spans[i]);
    rest.sample_time.push_back(sample_time[i]);
    rest.index.push_back(index[i]);
    lost_before = false;
  }
  return rest;
}

FittedStream fit_stream(const RecordedStream& stream) {
  FittedStream fitted;
  const auto proofs = fit::earliest_proofs(stream.received, stream.spans, stream.link.baud);
  fitted.number = fit::number_messages(proofs, stream.suspects(), stream.nominal_rate_hz);
  std::vector<double> device_s;
  for (const std::int64_t number : fitted.number)
    device_s.push_back(static_cast<double>(number) / stream.nominal_rate_hz);
  const auto latest = fit::latest_begins(stream.received, stream.spans, device_s, stream.link.baud);
  fitted.clock = fit::fit_arrivals(device_s, latest, stream.link, stream.nominal_rate_hz);
  return fitted;
}

std::vector<Stamp> stamp_stream(const RecordedStream& stream, double nominal_rate_hz) {
  LinkTiming timing(stream.link, nominal_rate_hz);
  std::vector<Stamp> stamps;
  for (std::size_t chunk = 0; chunk < stream.received.chunk_count(); ++chunk) {
    const std::uint64_t end = stream.received.chunk_end[chunk];
    timing.chunk(end, stream.received.time(chunk));
    for (; stamps.size() < stream.spans.size() && stream.spans[stamps.size()].end <= end;)
      stamps.push_back(
          timing.stamp(stream.spans[stamps.size()], {.lost_before = stream.suspect[stamps.size()]}));
  }
  return stamps;
}

void ErrorSizes::add(double error_s) {
  sizes_s_.push_back(std::abs(error_s));
}

double ErrorSizes::quantile(double share) const {
  std::vector<double> sorted = sizes_s_;
  std::sort(sorted.begin(), sorted.end());
  return sorted.at(static_cast<std::size_t>(share * static_cast<double>(sorted.size() - 1)));
}

double ErrorSizes::rms() const {
  double squares = 0.0;
  for (const double size_s : sizes_s_) squares += size_s * size_s;
  return std::sqrt(squares / static_cast<double>(sizes_s_.size()));
}

}  // namespace thermorig::timing

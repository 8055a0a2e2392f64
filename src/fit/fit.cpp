// SPDX-License-Identifier: MIT
#include <algorithm>
#include <optional>
#include <tuple>
#include <utility>
#include <vector>

#include "camera_rhythm.h"
#include "checked_constants.h"
#include "clock_fits.h"
#include "images_share.h"
#include "pieces.h"
#include "ping_exchanges.h"
#include "thermorig/core/bad_pixels.h"
#include "thermorig/fit/clocks/recorded_clock.h"
#include "thermorig/fit/fit.h"
#include "thermorig/fit/motion/panorama_fit.h"
#include "thermorig/fit/shaft/encoder_fit.h"
#include "thermorig/fit/shaft/gyro_errors.h"
#include "thermorig/fit/shaft/servo_response.h"
#include "thermorig/fit/shaft/witnesses.h"
#include "thermorig/pipeline/final_times.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::fit {

using pipeline::Fits, pipeline::FinalTimes, pipeline::Streams;

namespace {

constexpr double answer_patience_s = 5.0;  // for what a gyro says of itself

template <typename Message>
void put_times(const std::vector<TimeEstimate>& times, std::vector<Message>& messages) {
  FinalTimes final_times(times);
  for (Message& message : messages) final_times.put_next(message.stamp);
}

/// Readings of the shaft share the clock of the telemetry around them.
void put_shaft_times(const std::vector<TimedServo>& servo, const EncoderProfile& encoder,
                     std::vector<TimedShaft>& shaft) {
  std::size_t next = 0;
  for (TimedShaft& reading : shaft) {
    while (next < servo.size() && servo[next].span.begin < reading.span.begin) ++next;
    if (next == 0) continue;
    const TimedServo& before = servo[next - 1];
    const double s_per_us = next < servo.size() ? pipeline::host_s_per_us(before, servo[next]) : 1e-6;
    const auto since_us = static_cast<double>(reading.mcu_time_us - before.mcu_time_us);
    reading.stamp.time = before.stamp.time + from_s(since_us * s_per_us - encoder.latency_s);
  }
}

/// The rhythm is counted on what the bytes prove: causal stamps have been made with a count of their own.
void put_proofs(const RawStream& received, std::uint32_t baud, std::vector<TimedFrame>& frames) {
  const std::vector<StreamSpan> spans = spans_of(frames);
  if (!holds(received, spans)) return;
  const auto proofs = earliest_proofs(received, spans, baud);
  auto proof = proofs.begin();
  for (TimedFrame& frame : frames) frame.stamp.time = *proof++;
}

template <typename Message>
std::vector<Stamp> stamps_of(std::span<const Message> messages) {
  std::vector<Stamp> stamps;
  stamps.reserve(messages.size());
  for (const Message& message : messages) stamps.push_back(message.stamp);
  return stamps;
}

/// `fit_piece` is asked for the clock of messages `begin` .. `end` - 1, which came between two absences.
template <typename Message, typename FitPiece>
ClockFit fit_pieces(const RawRecording& raw, Device device, const std::vector<Message>& messages,
                    double nominal_rate_hz, FitPiece fit_piece) {
  const std::vector<std::size_t> begins = piece_begins(messages, break_offsets(raw, device));
  if (begins.size() < 2) return fit_piece(0, messages.size());
  std::vector<ClockPiece> pieces;
  for (std::size_t i = 0; i < begins.size(); ++i) {
    const std::size_t end = i + 1 < begins.size() ? begins[i + 1] : messages.size();
    pieces.push_back({fit_piece(begins[i], end),
                      stamps_of(std::span<const Message>(messages).subspan(begins[i], end - begins[i]))});
  }
  return joined(std::move(pieces), std::string(name_of(device)), nominal_rate_hz);
}

/// Telemetry `begin` .. `end` - 1, and the answers to pings among it.
Streams servo_piece(const Streams& streams, std::size_t begin, std::size_t end) {
  Streams piece;
  const auto all = std::span<const TimedServo>(streams.servo).subspan(begin, end - begin);
  piece.servo.assign(all.begin(), all.end());
  const std::uint64_t from = begin == 0 ? 0 : streams.servo[begin].span.begin;
  const std::uint64_t until = end == streams.servo.size() ? ~std::uint64_t{0} : streams.servo[end].span.begin;
  for (const TimedPong& pong : streams.pongs)
    if (from <= pong.span.begin && pong.span.begin < until) piece.pongs.push_back(pong);
  return piece;
}

/// Even the fastest byte of the servo was on its way for no longer than the shortest round trip. Where that
/// is longer than the profile says of a link, nothing speaks for so little: one hub and one host serve all
/// three.
void check_constant_delay(const std::optional<double>& round_trip_s, PortProfile& link) {
  if (round_trip_s) link.largest_constant_delay_s = std::max(link.largest_constant_delay_s, *round_trip_s);
}

PerDevice<ClockFit> fit_clocks(const RawRecording& raw, Streams& streams, const CameraRhythm& rhythm) {
  RigProfile profile = raw.header.profile;
  const auto round_trip_s = shortest_round_trip_s(
      ping_exchanges(raw.received[Device::servo], raw.sent[Device::servo], streams, profile.servo.link.baud));
  check_constant_delay(round_trip_s, profile.camera.link);
  check_constant_delay(round_trip_s, profile.gyro.link);
  const auto& [camera, gyro, servo] = std::tie(profile.camera, profile.gyro, profile.servo);
  PerDevice<ClockFit> clocks;
  const auto has_gaps = rhythm.gaps.size() == streams.frames.size();
  clocks[Device::camera] =
      fit_pieces(raw, Device::camera, streams.frames, camera.output_rate_hz,
                 [&, &camera = camera](auto begin, auto end) {
                   const auto gaps = has_gaps ? std::span(rhythm.gaps).subspan(begin, end - begin)
                                              : std::span<const labels::FrameGap>();
                   return fit_camera_clock(
                       raw.received[Device::camera],
                       std::span<const TimedFrame>(streams.frames).subspan(begin, end - begin), gaps, camera);
                 });
  clocks[Device::gyro] = fit_pieces(
      raw, Device::gyro, streams.gyro, gyro.output_rate_hz, [&, &gyro = gyro](auto begin, auto end) {
        return fit_gyro_clock(raw.received[Device::gyro],
                              std::span<const TimedGyro>(streams.gyro).subspan(begin, end - begin), gyro);
      });
  clocks[Device::servo] = fit_pieces(
      raw, Device::servo, streams.servo, sensors::servo_protocol(raw.header.profile.servo.protocol).rate_hz,
      [&, &servo = servo](auto begin, auto end) {
        if (end - begin == streams.servo.size())
          return fit_servo_clock(raw.received[Device::servo], raw.sent[Device::servo], streams, servo);
        return fit_servo_clock(raw.received[Device::servo], raw.sent[Device::servo],
                               servo_piece(streams, begin, end), servo);
      });
  put_times(clocks[Device::camera].times, streams.frames);
  put_times(clocks[Device::gyro].times, streams.gyro);
  put_times(clocks[Device::servo].times, streams.servo);
  put_shaft_times(streams.servo, profile.encoder, streams.shaft);
  return clocks;
}

/// What each frame shows when, by the fits so far.
void expose(std::vector<TimedFrame>& frames, const CameraProfile& profile, const Fits& fits) {
  labels::ExposureRule rule = pipeline::exposure_rule(profile, fits);
  for (TimedFrame& frame : frames) rule.apply(frame);
}

motion::View view_of(const CameraProfile& camera) {
  return {camera.lens_width_deg(), camera.mirrored};
}

void fit_newer_half(Streams& streams, const RigProfile& profile, const GyroErrors& errors, Fits& fits) {
  if (fits.camera_mode != labels::CameraMode::full_fresh) return;
  fits.newer_half = motion::newer_half(streams.frames, streams.gyro, view_of(profile.camera), errors);
  if (fits.newer_half) expose(streams.frames, profile.camera, fits);
}

/// Images and gyro say nothing of each other's constants where they contradict each other.
bool do_images_follow_gyro(const Witnesses& witnesses) {
  return witnesses.outlier == Witness::none || witnesses.outlier == Witness::command;
}
constexpr const char* do_not_follow = "images and gyro contradict each other";

motion::TurnResult turns_of(const Streams& streams, const RigProfile& profile, const SyncReport& sync,
                            const RunAll& run_all) {
  if (!do_images_follow_gyro(sync.witnesses)) return {{}, 0.0, do_not_follow};
  return motion::gyro_scale(streams.frames, streams.gyro, view_of(profile.camera), sync.gyro,
                            motion::session_windows, run_all);
}

CameraOffset offset_of(const Streams& streams, const RigProfile& profile, const SyncReport& sync,
                       const RunAll& run_all) {
  CameraOffset offset;
  offset.why_not = do_not_follow;
  if (!do_images_follow_gyro(sync.witnesses)) return offset;
  return motion::camera_offset(streams.frames, streams.gyro, view_of(profile.camera), sync.gyro, run_all);
}

/// What the gyro answered when its port opened; bytes of some seconds are looked through.
std::optional<double> answered_bandwidth_hz(const RawRecording& raw) {
  const sensors::GyroProtocol& protocol = sensors::gyro_protocol(raw.header.profile.gyro.protocol);
  const RawStream& received = raw.received[Device::gyro];
  if (protocol.bandwidth_hz == nullptr || raw.sent[Device::gyro].chunk_count() == 0) return std::nullopt;
  std::vector<std::uint8_t> bytes;
  for (std::size_t i = 0; i < received.chunk_count(); ++i) {
    if (received.time(i) - raw.sent[Device::gyro].time(0) > from_s(answer_patience_s)) break;
    const auto chunk = received.chunk(i);
    bytes.insert(bytes.end(), chunk.begin(), chunk.end());
  }
  return protocol.bandwidth_hz(bytes);
}

/// What is made of the images from here on is made without them.
std::string mend_bad_pixels(std::vector<TimedFrame>& frames) {
  PixelWatch watch;
  for (const TimedFrame& frame : frames) watch.add(frame);
  if (!watch.bad().empty())
    for (TimedFrame& frame : frames) mend(frame.frame, watch.bad());
  return text_of(watch.bad());
}

/// A servo that turns otherwise than commanded may have a setting of its own that says so.
void name_setting(const sensors::ServoProtocol& protocol, const Streams& streams, Witnesses& witnesses) {
  const bool may_be_it = witnesses.outlier == Witness::command || witnesses.outlier == Witness::undecided;
  if (!may_be_it || !witnesses.gyro_share || protocol.scale_cause == nullptr) return;
  if (witnesses.gyro_share->value < least_turning_share) return;  // it does not turn, or the other way
  const auto found = protocol.scale_cause(witnesses.gyro_share->value, streams.servo_answers);
  if (!found) return;
  witnesses.cause += "; or " + found->why;
  witnesses.remedy += ", or " + found->remedy;
}

}  // namespace

Fits fit_recording(const RawRecording& raw, Streams streams, const RunAll& run_all) {
  const RigProfile& profile = raw.header.profile;
  put_proofs(raw.received[Device::camera], profile.camera.link.baud, streams.frames);
  CameraRhythm rhythm =
      camera_rhythm(streams.frames, piece_begins(streams.frames, break_offsets(raw, Device::camera)));
  PerDevice<ClockFit> clocks = fit_clocks(raw, streams, rhythm);
  Fits fits;
  fits.camera_mode = rhythm.mode;
  fits.frame_period_s = rhythm.period_s;
  fits.gaps = std::move(rhythm.gaps);
  expose(streams.frames, profile.camera, fits);
  const sensors::ServoProtocol& servo_protocol = sensors::servo_protocol(profile.servo.protocol);
  const auto scale = servo_protocol.counts_steps
                         ? rate_scale_by_steps(streams.servo, servo_protocol.longest_gap_s)
                         : std::nullopt;
  if (scale) {
    fits.servo_rate_scale = *scale;
    clocks[Device::servo].report.skew_ppm = 1e6 * (1.0 / *scale - 1.0);
    for (TimedServo& servo : streams.servo) servo.state.rate_dps *= *scale;
  }

  SyncReport sync;
  sync.bad_pixels = mend_bad_pixels(streams.frames);
  sync.gyro = profile.servo.is_there()
                  ? fit_gyro_errors(streams.gyro, streams.servo, profile.gyro)
                  : fit_gyro_errors_without_servo(streams.gyro, streams.frames, profile.gyro);
  sync.gyro.decay_per_s = gyro_decay_per_s(streams.gyro, streams.servo, sync.gyro);
  fit_gyro_filter(streams.gyro, streams.servo, profile.gyro, sync.gyro, answered_bandwidth_hz(raw));
  apply_filter_delay(sync.gyro, clocks[Device::gyro]);
  put_times(clocks[Device::gyro].times, streams.gyro);
  fit_newer_half(streams, profile, sync.gyro, fits);
  sync.witnesses = compare_witnesses(streams.servo, streams.gyro, sync.gyro, profile,
                                     images_share(streams.frames, streams.servo, profile.camera));
  name_setting(servo_protocol, streams, sync.witnesses);
  // A stepper has no loop, and says ten times a second where it is: a loop that is fitted to that has the
  // ends of its range, and takes frames of short legs for ramps.
  const double longest_gap_s = servo_protocol.counts_steps ? 0.0 : servo_protocol.longest_gap_s;
  const auto fit_servo = [&] {
    return fit_servo_response(streams.servo, streams.gyro, sync.gyro, profile.servo,
                              1.0 / profile.camera.output_rate_hz, sync.witnesses, longest_gap_s);
  };
  sync.servo = fit_servo();  // with it how the bias went, on which rests what images say
  const motion::TurnResult turns = turns_of(streams, profile, sync, run_all);
  apply_turns(turns, sync.gyro);
  sync.camera_offset = offset_of(streams, profile, sync, run_all);
  apply_camera_offset(profile.camera, sync.gyro, clocks[Device::gyro].report, sync.camera_offset,
                      clocks[Device::camera]);
  if (turns.gyro_scale) sync.servo = fit_servo();  // another scale of the gyro is another one of the servo
  sync.shaft = judge_shaft(streams.shaft, streams.gyro, streams.servo, sync.gyro, profile,
                           servo_protocol.shaft_error_deg);

  for (const Device device : all_devices) {
    fits.times[device] = std::move(clocks[device].times);
    sync.clock[device] = std::move(clocks[device].report);
  }
  fits.sync = std::move(sync);
  return fits;
}

}  // namespace thermorig::fit

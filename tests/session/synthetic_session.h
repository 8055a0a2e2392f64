// SPDX-License-Identifier: MIT
#pragma once

#include <cmath>
#include <limits>
#include <random>

#include "../support/paper_estimates.h"
#include "servo_link.h"
#include "thermorig/sensors/wire/device_bytes.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::session {

/// A session with something in every field, deterministic by seed; no physics in it.
class SyntheticSession {
 public:
  SyntheticSession(std::size_t frames, std::uint32_t seed) : random_(seed) {
    fill_header();
    for (std::size_t i = 0; i < frames; ++i) add_frame(i);
    for (std::size_t i = 0; i < frames * 25; ++i) add_gyro(i);
    for (std::size_t i = 0; i < frames * 12; ++i) add_servo(i);
    for (std::size_t i = 0; i < frames * 25; ++i) add_shaft(i);
    if (frames > 0) session_.raw.header.shaft_sensor = "AS5600";
    if (frames > 0) add_extras();
    if (frames > 0) add_sync();
    session_.raw.complete = true;
    session_.raw.end_time = start_ + from_s(0.125 * static_cast<double>(frames) + 1e-9);
    session_.settle_s = 0.25;
    session_.camera_mode = "half-fresh";
    session_.frame_period_s = 0.1275;
    for (const Device device : all_devices) session_.counters[device].messages = frames;
    session_.counters[Device::gyro].bad_value = 3;
  }

  Session take() { return std::move(session_); }

 private:
  void fill_header() {
    auto& header = session_.raw.header;
    header.uuid = "8d3f2a10-7f6e-4c55-9d0a-2b1c3d4e5f60";
    header.environment = "garden";
    header.acquisition = 2;
    header.title = "garden, acquisition 2 (früh)";
    header.licence = "CC-BY-4.0";
    header.start_time_utc = "2026-07-25T14:35:59.900001Z";
    header.time_reference = start_;
    header.simulated = true;
    header.simulation_seed = 3;
    header.simulation = "made for a test";
    header.plan_toml = "frames_per_leg = 57\n";
    header.creator = "thermorig test";
  }

  void add_sync() {
    double number = 1.0;
    for (const Device device : all_devices) add_clock(session_.sync.clock[device], number++);
    session_.sync.clock[Device::servo].method = "two-way";
    session_.sync.camera_offset = {Estimate{0.012, 0.0005}, "", 480, true, true, Estimate{0.005, 0.0001}};
    add_gyro_errors(session_.sync.gyro);
    session_.sync.bad_pixels = "3,17 12,5";
    ServoResponse& servo = session_.sync.servo;
    servo.fitted = servo.scale_calibrated = true;
    servo.delay_s = 0.021;
    servo.loop_hz = 9.5;
    servo.scale = {0.99, 0.001};
    servo.gyro_ratio = {1.002, 0.01};
    servo.dead_band_deg = 0.3;
    servo.gain = {1.0, 1.01, 0.99};
    servo.residual_dps = 0.6;
    servo.speeds = {{-7.5, 0.1, 0.2, 0.9, 30, -7.6, false}, {7.5, -0.1, 0.25, 1.1, 60, 5.0, true}};
    servo.ripples = {{33.0, 0.01, -0.02, 0.005, 0.004}, {360.0, 0.003, 0.002, -0.001, 0.006}};
  }

  void add_gyro_errors(GyroErrors& gyro) const {
    gyro.scale = {1.01, 0.002};
    gyro.scale_calibrated = gyro.scale_contradicts = true;
    gyro.scale_by_turns = Estimate{1.02, 0.001};
    gyro.scale_why_not = "one of two windows told";
    gyro.filter_delay_s = {0.011, 0.001};
    gyro.filter_source = "noise";
    gyro.filter_contradicts = true;
    gyro.bias_dps = Estimate{0.4, 0.01};
    gyro.bias_before_dps = 0.39;
    gyro.noise_dps = 0.1;
    gyro.zeroes_itself = gyro.bias_from_legs = true;
    const HostTime start = session_.raw.header.time_reference;
    gyro.bias_course = {{start + from_s(1.0), 0.39}, {start + from_s(2.0), 0.42}};
  }

  void add_clock(ClockReport& clock, double number) const {
    clock = {.method = "one-way",
             .own_time_unused = "it stands still",
             .rate_hz = 8.0 * number,
             .skew_ppm = 12.5,
             .wander_ppm = 1.5,
             .late_p50_us = 100,
             .late_p95_us = 900,
             .late_max_us = 15000,
             .uncertainty_us = 120,
             .bound_us = 700,
             .bound_median_us = 300,
             .bound_wander_ppm = 12,
             .needed_wander_ppm = 6,
             .largest_constant_delay_s = 0.002,
             .latency_s = 0.0125,
             .latency_uncertainty_s = 0.0006,
             .knots = {{at(0.5), 1e5 + number, 12.25, 80.5}, {at(10.5), 1e5 + 2 * number, 13, 81}},
             .epochs = {{at(0), ""}, {at(7), "the micro-controller was reset"}},
             .gaps = {{at(3), at(4.5), 11}}};
  }

  std::uint8_t random_byte() { return static_cast<std::uint8_t>(random_()); }
  float noise() { return static_cast<float>(random_() % 1000) * 0.001F - 0.5F; }
  HostTime at(double seconds) const { return start_ + from_s(seconds); }

  void add_frame(std::size_t i) {
    const double time_s = 0.125 * static_cast<double>(i) + 0.0000123;
    TimedFrame frame;
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      frame.frame.temp_c[pixel] =
          std::round((20.0F + 5.0F * std::sin(0.1F * static_cast<float>(pixel + i)) + noise()) * 100.0F) /
          100.0F;
    frame.frame.sensor_temp_c = 31.25F;
    frame.span = {1544 * i, 1544 * (i + 1)};
    frame.stamp = {at(time_s), at(time_s + 0.04), 0.001F, 0.002F, 0.0001F};
    frame.half[i % 2] = {at(time_s - 0.125), at(time_s)};
    frame.half[(i + 1) % 2] = {at(time_s - 0.25), at(time_s - 0.125)};
    frame.fresh_even = static_cast<std::uint16_t>(i % 2 ? 380 : 0);
    frame.fresh_odd = static_cast<std::uint16_t>(i % 2 ? 0 : 381);
    frame.exposure_begin = at(time_s - 0.25);
    frame.exposure_end = at(time_s);
    frame.resync_before = i % 50 == 7;
    frame.stale = i % 30 == 4;
    frame.missing_before = i == 160 ? 2 : 0;
    session_.frames.push_back(frame);
    std::vector<std::uint8_t> chunk(1544);
    for (auto& byte : chunk) byte = random_byte() & 0x1FU;
    session_.raw.received[Device::camera].append(chunk, frame.stamp.arrival);
    add_sample(frame, i);
  }

  void add_sample(const TimedFrame& frame, std::size_t i) {
    LabelledSample sample;
    sample.frame_index = static_cast<std::uint32_t>(i);
    sample.time = frame.stamp.time - from_s(0.0625);
    sample.exposure_begin = frame.exposure_begin;
    sample.exposure_end = frame.exposure_end;
    sample.leg = static_cast<std::uint16_t>(i / 60 + 1);
    sample.rate_shaft_dps = 7.5F * static_cast<float>(sample.leg);
    sample.rate_shaft_min_dps = sample.rate_shaft_dps - 1;
    sample.rate_shaft_max_dps = sample.rate_shaft_dps + 1;
    sample.angle_commanded_deg = noise();
    sample.rate_gyro_dps = i == 0 ? std::nanf("") : sample.rate_shaft_dps + noise();
    sample.rate_commanded_dps = sample.rate_shaft_dps + 0.5F;
    sample.rate_shaft_half_dps = {sample.rate_shaft_dps - 0.25F, sample.rate_shaft_dps + 0.25F};
    sample.rate_commanded_half_dps = {sample.rate_commanded_dps, std::nanf("")};
    sample.rate_gyro_half_dps = {sample.rate_gyro_dps, sample.rate_gyro_dps + 1};
    sample.gyro_spread_dps = 0.25F;
    sample.gyro_count = 50;
    sample.rate_shaft_uncertainty_dps = 0.1F;
    sample.rate_commanded_uncertainty_dps = 0.5F;
    sample.rate_corrected_dps = sample.rate_shaft_dps + 0.125F;
    sample.rate_corrected_half_dps = {sample.rate_corrected_dps, std::nanf("")};
    sample.rate_corrected_uncertainty_dps = 0.2F;
    sample.angle_measured_deg = 720.0 + 0.001 * static_cast<double>(i);
    sample.rate_measured_dps = sample.rate_shaft_dps + 0.0625F;
    sample.rate_measured_half_dps = {std::nanf(""), sample.rate_measured_dps};
    sample.rate_measured_uncertainty_dps = 0.1F;
    if (i % 60 < 3) sample.reason_bits = bit(Reason::servo_ramp) | bit(Reason::leg_change);
    sample.valid = sample.reason_bits == 0;
    sample.run = sample.valid ? sample.leg : 0U;
    session_.samples.push_back(sample);
  }

  void add_gyro(std::size_t i) {
    const double time_s = 0.005 * static_cast<double>(i) + 0.000001;
    TimedGyro gyro;
    gyro.reading.rate_dps = {noise(), noise(), 7.5F + noise()};
    gyro.reading.counts = {-3, 4, static_cast<std::int16_t>(100 + i % 7)};
    if (i % 3 == 0) gyro.reading.temp_c = 33.5F;
    if (i % 4 == 0) gyro.reading.device_time_us = static_cast<std::int64_t>(5000 * i);
    gyro.reading.saturated = i % 100 == 99;
    gyro.span = {11 * i, 11 * i + 11};
    gyro.stamp = {at(time_s), at(time_s + 0.003), 0.0005F, 0.002F, 0.0003F};
    gyro.rate_dps = -gyro.reading.rate_dps[2];
    gyro.lost_before = i % 77 == 1;
    session_.gyro.push_back(gyro);
    const auto chunk = wire::witmotion_gyro_packet({random_byte(), 256, random_byte()}, 33.5F);
    session_.raw.received[Device::gyro].append(chunk, gyro.stamp.arrival);
  }

  void add_servo(std::size_t i) {
    const double time_s = 0.01 * static_cast<double>(i);
    TimedServo servo;
    servo.mcu_time_us = (std::int64_t{1} << 32) - 500'000 + static_cast<std::int64_t>(10'000 * i);
    servo.state.mcu_us = static_cast<std::uint32_t>(servo.mcu_time_us);
    servo.state.angle_deg = static_cast<double>(static_cast<float>(0.075 * static_cast<double>(i)));
    servo.state.rate_dps = 7.5;
    servo.state.pulse_us = 0.0625F * static_cast<float>(24001 + i % 16000);
    servo.state.motion = ServoMotion::steady;
    servo.state.fault = i % 500 == 499 ? ServoFault::watchdog : ServoFault::none;
    servo.state.leg = static_cast<std::uint16_t>(1 + i / 720);
    servo.span = {26 * i, 26 * i + 26};
    servo.stamp = {at(time_s), at(time_s + 0.001), 0.00002F, 0.0001F, 0.0002F};
    servo.lost_before = i % 91 == 3;
    session_.servo.push_back(servo);
    session_.raw.received[Device::servo].append(std::vector<std::uint8_t>(26, random_byte()),
                                                servo.stamp.arrival);
  }

  void add_shaft(std::size_t i) {
    const double time_s = 0.005 * static_cast<double>(i);
    TimedShaft shaft;
    shaft.mcu_time_us = (std::int64_t{1} << 32) - 500'000 + static_cast<std::int64_t>(5'000 * i);
    shaft.reading = {.mcu_us = static_cast<std::uint32_t>(shaft.mcu_time_us),
                     .angle_deg = 0.0375 * static_cast<double>(i % 9600),
                     .uncertainty_deg = 0.05F,
                     .status = i % 50 == 9 ? ShaftStatus::silent : ShaftStatus::good,
                     .gain = 64};
    if (has_angle(shaft.reading)) shaft.angle_deg = 0.0375 * static_cast<double>(i) - 3.0;
    shaft.span = {14 * i, 14 * i + 14};
    shaft.stamp = {at(time_s), at(time_s + 0.001), 0.00002F, 0.0001F, 0.0002F};
    shaft.lost_before = i == 0 || i % 91 == 3;
    session_.shaft.push_back(shaft);
  }

  void add_extras() {
    send_ping(77);
    session_.pongs.push_back({77, 4'000'000, 4'001'000, {5, 20}, at(0.02)});
    session_.pongs.push_back({78, 5'000'000, 5'001'000, {40, 55}, at(1.02)});
    session_.raw.events.push_back({at(0.5), EventKind::info, std::nullopt, "begun: ±7.5 deg/s"});
    session_.raw.events.push_back({at(0.75), EventKind::device_back, Device::gyro, ""});
    for (std::uint16_t leg = 1; leg <= session_.samples.back().leg; ++leg)
      session_.raw.legs.push_back({leg, leg - 1, 7.5 * leg, at(leg), at(leg + 7.0000001), 60, leg > 1});
  }

  void send_ping(std::uint32_t token) {
    std::array<std::uint8_t, SERVO_PING_SIZE> payload{};
    servo_put_u32(payload.data(), token);
    std::array<std::uint8_t, SERVO_FRAME_MAX> frame{};
    const auto size = servo_frame(frame.data(), SERVO_PING, 9, payload.data(), SERVO_PING_SIZE);
    // In two writes: the second ends the ping.
    session_.raw.sent[Device::servo].append(std::span(frame).first(3), at(0.010));
    session_.raw.sent[Device::servo].append(std::span(frame).subspan(3, size - 3U), at(0.011));
    session_.raw.sent[Device::servo].append(std::array<std::uint8_t, 1>{SERVO_LINK_STOP}, at(0.012));
  }

  const HostTime start_ = host_time_ns(123'456'789'012'345);
  std::mt19937 random_;
  Session session_;
};

inline Session synthetic_session(std::size_t frames, std::uint32_t seed = 1) {
  return SyntheticSession(frames, seed).take();
}

/// The same with what a live run showed of every other frame.
inline Session synthetic_live_session(std::size_t frames) {
  Session session = synthetic_session(frames);
  session.raw.header.live_model = {"best.onnx", std::string(64, 'a'), 3, 1, true, true, 200.0};
  session.raw.header.estimators = paper_columns;
  for (std::size_t i = 0; i < session.samples.size(); i += 2) {
    const LabelledSample& sample = session.samples[i];
    const auto number = static_cast<float>(i);
    EstimateRow row{.frame_index = sample.frame_index,
                    .time = sample.time + HostDuration(i),
                    .exposure_begin = sample.exposure_begin,
                    .exposure_end = sample.exposure_end,
                    .arrival = sample.time + std::chrono::milliseconds(40),
                    .rate_commanded_dps = sample.rate_commanded_dps,
                    .reason_bits = sample.reason_bits,
                    .run = sample.run,
                    .leg = sample.leg,
                    .counted = i % 4 == 0};
    row = with_rates(row, 0.1F * number, -0.0F, 1.0F / (number + 3.0F), 0.001F * number);
    row.estimates[of_gyro].rate_sigma_dps = 0.5F + number;
    row.estimates[of_gyro].angle_deg = 1e3 / (static_cast<double>(i) + 7.0);
    row.estimates[of_thermal].angle_sigma_deg = 0.25F * number;
    if (i % 6 == 0) row.estimates[of_fusion] = {.reason = EstimateReason::no_gyro};
    session.raw.estimates.push_back(row);
  }
  return session;
}

}  // namespace thermorig::session

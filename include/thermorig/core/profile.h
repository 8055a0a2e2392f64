// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <optional>
#include <string>

#include "thermorig/core/device.h"

namespace thermorig {

/// How a device is connected. Baud 0 stands for "does not apply" (USB-CDC).
struct PortProfile {
  std::string port;        // "/dev/ttyUSB0", "/dev/serial/by-id/...", or a pty; empty: not chosen yet
  std::string usb_path;    // USB topology, e.g. "1-4.2": how the port is found again; may be empty
  std::uint32_t baud = 0;  // bits per second, 8N1: 10 bits on the wire a byte
  double latency_s = 0.0;  // constant delay between the sample and its first byte on the wire
  double latency_uncertainty_s = 0.0;       // one standard deviation of it
  std::string latency_measured_utc;         // when it was calibrated; empty: it is an assumption
  double largest_constant_delay_s = 0.002;  // even the fastest byte is read at most so late: USB, wake-up
  double wander_ppm = 100.0;   // the device's clock never runs further from its mean rate than this
  bool reset_on_open = false;  // toggle DTR after opening (some CH340 boards need it to start streaming)
};

enum class ChecksumPolicy : std::uint8_t { word, byte, ignore };

/// GY-MCU90640 bridge. Source: protocols/gy_mcu90640.md.
struct CameraProfile {
  PortProfile link{.baud = 460800, .latency_s = 0.0, .latency_uncertainty_s = 0.010, .wander_ppm = 1000.0};
  std::string model = "GY-MCU90640";
  std::string protocol = "gy-mcu90640";  // a name of sensors/camera_protocol.h
  double output_rate_hz = 8.0;           // frames a second that it was set to, nominal
  double field_of_view_deg = 55.0;       // horizontal: 55 (BAB) or 110 (BAA)
  bool mirrored = true;                  // the order on the wire is a mirror image of the scene
  std::string orientation_measured_utc;  // when `mirrored` and the gyro's sign were; empty: assumptions
  ChecksumPolicy checksum = ChecksumPolicy::word;
  // What `calibrate lens` finds. Pixels of a plain lens stand field_of_view_deg / 32 apart, level and
  // upright.
  double pitch_scale = 1.0;  // true distance between columns over that
  double pitch_scale_uncertainty = 0.03;
  double distortion = 0.0;  // corners look further out by this share; it grows with the square
  double distortion_uncertainty = 0.05;
  double tilt_deg = 0.0;    // the camera looks upward
  double roll_deg = 0.0;    // about its optical axis: the side of growing azimuth is higher
  double row_spread = 0.0;  // rows are exposed one after the other over this share of a refresh period, from
                            // the first or, below 0, from the last on
  std::string lens_measured_utc;  // empty: assumptions

  /// Of the lens without distortion whose columns stand as far apart, on average over the frame: a column at
  /// u and a row at v, each from -1 to 1, stand wider by distortion (3 u^2 + v^2) / 2.
  double lens_width_deg() const { return field_of_view_deg * pitch_scale * (1.0 + distortion * 2.0 / 3.0); }
};

/// How far the camera's latency may be off, in s (root mean square): the profile's standard deviation, where
/// it was measured. Where it is an assumption, nothing says either when within a refresh the middle rows are
/// read, from the middle of it to its end (the MLX90640's data sheet does not say whether rows are exposed
/// together or one after the other). A sketch that `merges_halves` reads one half-frame, then the other, and
/// sends both as one frame when it comes to it: all that is known is that the newer one had its end within
/// the last refresh. Whether it does, its protocol says: sensors::latency_uncertainty_s().
double latency_uncertainty_s(const CameraProfile& camera, bool merges_halves);

/// Columns of a text gyro. A line is split on commas, semicolons, tabs and spaces.
struct TextColumns {
  std::string prefix;                // a line must start with it (it is cut off); empty: any line
  std::array<int, 3> rate{0, 1, 2};  // columns of x, y, z, from 0; -1 for an axis that is not sent
  double scale_dps = 1.0;            // degrees per second of one unit
  int time = -1;                     // column of the device's time, -1 for none
  double time_unit_s = 1e-3;         // seconds of one unit of it
  bool operator==(const TextColumns&) const = default;
};

struct GyroProfile {
  PortProfile link{.baud = 115200, .latency_s = 0.0, .latency_uncertainty_s = 0.002};
  std::string model = "WitMotion";
  std::string protocol = "witmotion";      // a name of sensors/gyro_protocol.h
  std::string sketch;                      // that prints its lines: sensors/gyro_sketch.h; empty: none named
  TextColumns text;                        // of a protocol that has columns
  std::map<std::string, double> settings;  // of its protocol, by name; one that is not stated is 0
  double output_rate_hz = 200.0;           // nominal
  // Low-pass of the gyro: where its amplitude has fallen by 3 dB; 0: not known.
  double bandwidth_hz = 0.0;
  double filter_delay_s = 0.0;  // its group delay, which is in no other latency; 0: 0.225 / bandwidth_hz
  int axis = 2;                 // which of x, y, z is the servo's axis: 0, 1, 2
  int sign = 1;                 // +1 or -1: so that a positive commanded speed gives a positive rate
  // rate about the axis = scale * true rate + bias, sign applied. Stored rates are never corrected.
  double scale = 1.0;
  double scale_uncertainty = 0.03;  // as a data sheet promises it
  std::string scale_measured_utc;   // empty: an assumption
  double bias_dps = 0.0;
  double bias_uncertainty_dps = 20.0;
  std::string bias_measured_utc;

  double setting(const std::string& setting_name) const;

  /// One standard deviation of the bias in a later session, deg/s: that of its measurement, and 2 deg/s by
  /// which it has moved since, most of all with the temperature. That is 6 to 12 K of an MPU-6050, which
  /// moves by 20 deg/s either way from -40 to 85 degC (PS-MPU-6000A-00, table 6.1).
  double later_bias_sigma_dps() const { return std::hypot(bias_uncertainty_dps, 2.0); }

  /// Of a low-pass of second order, in periods of its bandwidth: Butterworth, sqrt(2) / (2 pi).
  static constexpr double second_order_delay = 0.225;
  /// How late the low-pass makes what it shows, as is stated here, in s. None: its bandwidth is not known.
  std::optional<double> stated_delay_s() const {
    if (!(bandwidth_hz > 0.0)) return std::nullopt;
    return filter_delay_s > 0.0 ? filter_delay_s : second_order_delay / bandwidth_hz;
  }
};

/// `none`: nobody commands what turns the rig, e.g. a turntable that is turned by hand. Labels are then the
/// gyro's.
enum class ServoKind : std::uint8_t { positional = 0, continuous = 1, none = 2 };

struct ServoProfile {
  // Within any minute a quartz stays so close to its mean rate, a room's changes of temperature included; the
  // mean itself is measured, however far off it is.
  PortProfile link{.baud = 250000, .latency_s = 0.0, .wander_ppm = 6.0};
  std::string model = "winch, 6 turns";
  std::string protocol = "servo-link";  // a name of sensors/servo_protocol.h
  int bus_id = 1;                       // of a servo on a bus
  ServoKind kind = ServoKind::positional;
  // positional: angle between the shortest and the longest pulse; continuous: what its cable bears, 0: any
  double travel_deg = 2160.0;
  double full_rate_dps = 0.0;  // continuous: speed at the longest pulse (the shortest gives its negative)
  double pulse_min_us = 500.0;
  double pulse_max_us = 2500.0;
  double max_rate_dps = 220.0;  // never commanded beyond; at most the firmware's own limit
  double acceleration_dps2 = 2000.0;
  double stop_margin_deg = 2.0;  // distance kept from either end of the travel
  double settle_s = 0.2;         // after a change of speed, until the shaft follows
  double loop_hz = 8.0;          // bandwidth of the servo's own loop, until a recording tells better
  double scale = 1.0;            // shaft angle per commanded angle
  double scale_uncertainty = 0.015;
  std::string scale_measured_utc;  // empty: an assumption

  bool is_there() const { return kind != ServoKind::none; }
};

/// A sensor on the shaft. Its errors are those of what it sends: once a turn of a magnet off the axis, twice
/// a turn of one that is tilted.
struct EncoderProfile {
  double latency_s = 0.0003;  // constant delay from the shaft's angle to the time of its reading
  double latency_uncertainty_s = 0.0003;
  int sign = 1;             // +1 or -1: so that a positive commanded speed makes the angle grow
  double offset_deg = 0.0;  // where the shaft stands, by the command, when the sensor sends 0
  double once_cosine_deg = 0.0, once_sine_deg = 0.0;    // sent - true, by cosine and sine of the angle sent
  double twice_cosine_deg = 0.0, twice_sine_deg = 0.0;  // the same of twice that angle
  double error_deg = 0.7;                               // what of such errors is left, root mean square
  std::string measured_utc;                             // empty: assumptions, no label is made from them

  /// Of the shaft, for an angle that was sent, whole turns in it or not.
  double angle_deg(double sent_deg) const {
    constexpr double rad = 3.14159265358979323846 / 180.0;
    const double once = sent_deg * rad, twice = 2.0 * once;
    const double error = once_cosine_deg * std::cos(once) + once_sine_deg * std::sin(once) +
                         twice_cosine_deg * std::cos(twice) + twice_sine_deg * std::sin(twice);
    return sign * (sent_deg - error) + offset_deg;
  }
};

/// One rig: what is connected, and how. Each member has a line in
/// src/storage/recording_header/profile_fields.cpp, by which it is read, written and checked: as TOML, in a
/// journal, in a session.
struct RigProfile {
  std::string name = "rig";
  CameraProfile camera;
  GyroProfile gyro;
  ServoProfile servo;
  EncoderProfile encoder;

  /// Whether the rig has one: camera and gyro always, a servo by its kind.
  bool has(Device device) const { return device != Device::servo || servo.is_there(); }
  PortProfile& link(Device device);
  const PortProfile& link(Device device) const;
};

}  // namespace thermorig

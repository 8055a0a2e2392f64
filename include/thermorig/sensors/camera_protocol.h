// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/clock_properties.h"
#include "thermorig/core/profile.h"
#include "thermorig/sensors/evidence.h"
#include "thermorig/sensors/scanner.h"
#include "thermorig/sensors/wire/camera_scanner.h"

namespace thermorig::sensors {

/// Sent one after the other, so far apart as their protocol wants it.
using Commands = std::vector<std::vector<std::uint8_t>>;

using CameraScanner = Scanner<wire::CameraMessage>;

/// Nothing that an MLX90640 measures lies beyond (its data sheet: objects from -40 to 300 degC): a sketch's
/// number that does is no temperature.
inline constexpr float coldest_pixel_c = -100.0F, hottest_pixel_c = 500.0F;

/// Of a protocol that merges_halves, in words.
inline constexpr std::string_view merged_halves =
    "its sketch merges both half-frames, and when each was exposed is unknown by a refresh";

/// What to try where a sketch's values cannot be degrees Celsius of a room: Kelvin, or shares of a range.
std::string advice_on_unit(const ThermalFrame& frame);

/// Of a sketch's values that may be degrees Fahrenheit, which they do not say: a question; else empty.
std::string doubt_on_unit(const ThermalFrame& frame);

/// One chess half is 0 throughout: the sketch prints after each half-frame, or before it has read both.
bool is_half_an_image(std::span<const float, frame_pixels> temp_c);

/// All that the program knows of one camera protocol. Others ask this, and never compare names.
struct CameraProtocol {
  std::string_view name;   // in profiles and sessions
  std::string_view sends;  // in words, many of them: "frames of a GY-MCU90640 board"
  std::span<const UsualBaud> bauds;
  ClockProperties clock;
  std::uint64_t message_bytes;  // of one frame, at most

  CameraScanner (*scanner)(const CameraProfile& profile);
  /// Nothing if the bytes hold no frame of it.
  std::optional<Evidence> (*recognise)(std::span<const std::uint8_t> bytes);
  /// What it is told when its port opens and while nothing comes: to send frames, at the profile's rate where
  /// it knows that one. None: it hears nothing.
  Commands (*request)(const CameraProfile& profile) = nullptr;
  /// What makes one send frames of which nothing is known yet. None: it hears nothing.
  std::vector<std::uint8_t> (*greeting)() = nullptr;
  /// One that sends each frame only when it is asked: what asks for one more, told with each that came. None:
  /// it sends a stream.
  std::vector<std::uint8_t> (*next)(const CameraProfile& profile) = nullptr;
  /// A frame is two half-frames that a sketch has read one after the other: when each was exposed is not
  /// known to a refresh, which latency_uncertainty_s() allows for.
  bool merges_halves = false;
  /// What is to be asked of the values of a frame, which a sketch has made; else empty. None: nothing.
  std::string (*doubt)(const ThermalFrame& frame) = nullptr;
};

/// The table. The first one is what a profile has that names none.
std::span<const CameraProtocol> camera_protocols();

std::vector<std::string> camera_protocol_names();

/// Throws Error(bad_usage) if there is none of that name: it lists those there are.
const CameraProtocol& camera_protocol(std::string_view name);

/// How far the camera's latency may be off, by its protocol: see thermorig::latency_uncertainty_s(). Throws
/// as camera_protocol() does.
double latency_uncertainty_s(const CameraProfile& camera);

/// A scanner of the protocol that the profile names. Throws as camera_protocol() does.
CameraScanner camera_scanner(const CameraProfile& profile);

}  // namespace thermorig::sensors

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
#include "thermorig/sensors/wire/gyro_message.h"

namespace thermorig::sensors {

using GyroScanner = Scanner<wire::GyroMessage>;

/// A number that a profile says in [gyro.<protocol>]. Not stated: 0.
struct GyroSetting {
  const char* name;
  double min, max;
  bool is_whole;
  const char* comment;
};

/// All that the program knows of one gyro protocol. Others ask this, and never compare names.
struct GyroProtocol {
  std::string_view name;     // in profiles, sessions and `decode --gyro-protocol`
  std::string_view sends;    // in words, many of them: "WitMotion packets"
  bool has_columns = false;  // it sends lines of text; [gyro.text] says what their columns are
  std::span<const GyroSetting> settings;
  std::span<const UsualBaud> bauds;
  double usual_rate_hz = 200.0;  // samples a second, as it comes or as one sets it at its usual baud

  ClockProperties (*clock)(const GyroProfile& profile);

  /// Bytes of one sample's message, at most.
  std::uint64_t (*message_bytes)(const GyroProfile& profile);
  GyroScanner (*scanner)(const GyroProfile& profile, StreamStart start);
  /// Nothing if the bytes, which came in `heard_s` seconds (0: not known), hold too few messages of it.
  std::optional<Evidence> (*recognise)(std::span<const std::uint8_t> bytes, double heard_s);
  /// What it is told or asked when its port opens and while nothing comes; `asked`: how often already, in
  /// vain. What makes it send samples, where it does not by itself. None: it hears nothing.
  std::vector<std::uint8_t> (*request)(const GyroProfile& profile, unsigned asked) = nullptr;
  /// What is to be known of the rates that the profile chooses; empty: nothing. None: never anything.
  std::string_view (*remark)(const GyroProfile& profile) = nullptr;
  bool is_told_rate = false;  // the request says the profile's rate: what comes without it has another
  /// The bandwidth of its low-pass, by what it answered among these bytes. Nothing: they do not say. None: it
  /// cannot be asked.
  std::optional<double> (*bandwidth_hz)(std::span<const std::uint8_t> bytes) = nullptr;
};

/// The table. The first one is what a profile has that names none.
std::span<const GyroProtocol> gyro_protocols();

std::vector<std::string> gyro_protocol_names();

/// Nothing if there is none of that name.
const GyroProtocol* find_gyro_protocol(std::string_view name);

/// Throws Error(bad_usage) if there is none of that name: it lists those there are.
const GyroProtocol& gyro_protocol(std::string_view name);

/// Whether a profile may state this setting of the protocol with this value.
bool is_allowed(const GyroProtocol& protocol, std::string_view setting, double value);

/// A scanner of the protocol that the profile names. Throws as gyro_protocol() does.
GyroScanner gyro_scanner(const GyroProfile& profile, StreamStart start = StreamStart::anywhere);

}  // namespace thermorig::sensors

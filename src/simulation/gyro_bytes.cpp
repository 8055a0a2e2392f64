// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "thermorig/core/error.h"
#include "thermorig/simulation/gyro.h"
#include "thermorig/wire/device_bytes.h"

namespace thermorig::simulation {
namespace {

std::vector<std::uint8_t> witmotion_bytes(const SimulatedGyroSample& sample, const GyroProfile&) {
  std::array<std::int16_t, 3> counts{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    counts[axis] = static_cast<std::int16_t>(
        std::clamp(std::round(sample.rate_dps[axis] / wire::witmotion_dps_per_count), -32768.0, 32767.0));
  const auto packet = wire::witmotion_gyro_packet(counts, static_cast<float>(sample.temp_c));
  return {packet.begin(), packet.end()};
}

/// Boards that send counts (a scale far below 1) print whole numbers.
std::string number_text(double rate_dps, double scale_dps) {
  const double value = rate_dps / scale_dps;
  return scale_dps < 0.5 ? fmt::format("{:.0f}", value) : fmt::format("{:.4f}", value);
}

std::vector<std::uint8_t> text_bytes(const SimulatedGyroSample& sample, const GyroProfile& profile) {
  const TextColumns& columns = profile.text;
  const int last = std::max(*std::max_element(columns.rate.begin(), columns.rate.end()), columns.time);
  std::vector<std::string> fields(static_cast<std::size_t>(last + 1), "0");
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (columns.rate[axis] >= 0)
      fields[static_cast<std::size_t>(columns.rate[axis])] =
          number_text(sample.rate_dps[axis], columns.scale_dps);
  if (columns.time >= 0)
    fields[static_cast<std::size_t>(columns.time)] =
        fmt::format("{:.0f}", static_cast<double>(sample.device_time_us) * 1e-6 / columns.time_unit_s);
  const std::string line = fmt::format("{}{}\r\n", columns.prefix, fmt::join(fields, ","));
  return {line.begin(), line.end()};
}

constexpr std::array encoders{GyroEncoder{"witmotion", witmotion_bytes}, GyroEncoder{"text", text_bytes}};

}  // namespace

std::span<const GyroEncoder> gyro_encoders() {
  return encoders;
}

std::vector<std::uint8_t> gyro_bytes(const SimulatedGyroSample& sample, const GyroProfile& profile) {
  const auto found = std::find_if(encoders.begin(), encoders.end(), [&](const GyroEncoder& encoder) {
    return encoder.name == profile.protocol;
  });
  if (found == encoders.end())
    throw Error(ExitCode::bad_usage, "the simulated gyro does not speak \"" + profile.protocol + "\"",
                "the gyro's protocol", "one that `thermorig decode --help` lists");
  return found->bytes(sample, profile);
}

}  // namespace thermorig::simulation

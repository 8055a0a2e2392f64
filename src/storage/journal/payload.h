// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "thermorig/core/raw_recording.h"

namespace thermorig::journal {

// Payloads of records that are not the header: docs/journal_format.md. Decoding gives nothing where the
// length or a value is not possible.

inline constexpr std::size_t time_bytes = 8;
std::array<std::uint8_t, time_bytes> encode_time(HostTime time);
std::optional<HostTime> decode_time(std::span<const std::uint8_t> payload);  // its first 8 bytes

std::vector<std::uint8_t> encode_event(const RecordingEvent& event);
std::optional<RecordingEvent> decode_event(std::span<const std::uint8_t> payload);

std::vector<std::uint8_t> encode_leg(const LegRecord& leg);
std::optional<LegRecord> decode_leg(std::span<const std::uint8_t> payload);

/// `count`: of the recording's estimators.
std::vector<std::uint8_t> encode_estimates(const EstimateRow& row, std::size_t count);
std::optional<EstimateRow> decode_estimates(std::span<const std::uint8_t> payload, std::size_t count);

/// Of before format 2: gyro, thermal head and fusion stand in the places of columns_before_format_2().
std::optional<EstimateRow> decode_estimate(std::span<const std::uint8_t> payload);

}  // namespace thermorig::journal

// SPDX-License-Identifier: MIT
// Flight controllers that speak MAVLink. Source: protocols/mavlink_gyro.md.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <numbers>

#include "foreign_bytes.h"
#include "mavlink.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/reassembly.h"

namespace thermorig::sensors {

namespace {

using wire::Bytes;
using wire::GyroMessage;

constexpr double dps_per_rad_s = 180.0 / std::numbers::pi;
constexpr std::array known_messages{mavlink::heartbeat, mavlink::scaled_imu, mavlink::raw_imu,
                                    mavlink::highres_imu};
// The longest packet, and what is looked at behind it: the time that a log has there, and a sync.
constexpr std::size_t longest_look = mavlink::header_v2_bytes + mavlink::payload_max_bytes +
                                     mavlink::checksum_bytes + mavlink::signature_bytes +
                                     mavlink::log_time_bytes + 1;

constexpr std::array<GyroSetting, 4> mavlink_settings{{
    {"system", 0, 255, true, "whose gyro is read; 0: of the first system that sends one"},
    {"component", 0, 255, true, "of that system; 0: the first that sends one"},
    {"message", 0, 105, true, "26 SCALED_IMU, 27 RAW_IMU, 105 HIGHRES_IMU; 0: the first that comes"},
    {"raw_scale_dps", 0, 100, false, "degrees per second of a count of RAW_IMU; 0: it is not read"},
}};

bool is_packet_sync(std::uint8_t byte) {
  return byte == mavlink::sync_v2 || byte == mavlink::sync_v1;
}

/// A log of a ground station (tlog) has a time before each packet: us since 1970, big-endian, of 2001 to
/// 2142.
bool may_begin_log_time(Bytes rest) {
  return rest[0] == 0 && (rest.size() == 1 || (rest[1] >= 3 && rest[1] < 0x13));
}

/// Nothing: more bytes are needed.
std::optional<bool> is_log_time(Bytes rest, bool ended) {
  if (rest.empty() || !may_begin_log_time(rest)) return false;
  if (rest.size() > mavlink::log_time_bytes) return is_packet_sync(rest[mavlink::log_time_bytes]);
  return ended ? std::optional(false) : std::nullopt;
}

/// CRC-16/MCRF4XX, which MAVLink calls X.25: one byte more.
std::uint16_t crc_with(std::uint16_t crc, std::uint8_t byte) {
  crc = static_cast<std::uint16_t>(crc ^ byte);
  for (int bit = 0; bit < 8; ++bit)
    crc = static_cast<std::uint16_t>((crc & 1U) != 0 ? (crc >> 1) ^ 0x8408U : crc >> 1);
  return crc;
}

const mavlink::Message* find_message(std::uint32_t id) {
  const auto found = std::find_if(known_messages.begin(), known_messages.end(),
                                  [&](const mavlink::Message& message) { return message.id == id; });
  return found == known_messages.end() ? nullptr : &*found;
}

struct Sender {
  std::uint8_t system = 0, component = 0;
  std::uint32_t message = 0;
};

struct Packet {
  std::size_t size = 0;  // of the whole
  Sender sender;
  const mavlink::Message* message = nullptr;  // none: not one of those that are known here
  Bytes checked;                              // what the checksum is of: all but the sync
  Bytes payload;
  std::uint16_t checksum = 0;
  bool is_short = false;  // version 1, which leaves nothing out, with less than its message has
};

/// The header of a packet; its bytes from the payload on may be missing yet.
struct PacketHeader {
  std::size_t bytes;
  std::size_t address;
  bool is_v2;
};

PacketHeader header_of(std::uint8_t sync) {
  if (sync == mavlink::sync_v2) return {mavlink::header_v2_bytes, mavlink::address_v2_offset, true};
  return {mavlink::header_v1_bytes, mavlink::address_v1_offset, false};
}

/// Nothing may be made of a packet with a flag that is not understood: it may have another shape.
bool is_understood(Bytes rest) {
  return rest[0] != mavlink::sync_v2 || (rest[mavlink::flags_offset] & ~unsigned{mavlink::flag_signed}) == 0;
}

/// Of a packet whose header is there.
std::size_t packet_size(Bytes rest) {
  const bool is_signed = rest[0] == mavlink::sync_v2 && rest[mavlink::flags_offset] == mavlink::flag_signed;
  return header_of(rest[0]).bytes + rest[mavlink::length_offset] + mavlink::checksum_bytes +
         (is_signed ? mavlink::signature_bytes : 0);
}

/// A packet that is there as a whole.
Packet packet_at(Bytes rest) {
  const PacketHeader header = header_of(rest[0]);
  const std::size_t payload_end = header.bytes + rest[mavlink::length_offset];
  const Bytes address = rest.subspan(header.address);
  Packet packet;
  packet.size = packet_size(rest);
  packet.sender = {address[1], address[2], address[3]};
  if (header.is_v2) packet.sender.message |= unsigned{address[4]} << 8 | unsigned{address[5]} << 16;
  packet.message = find_message(packet.sender.message);
  packet.checked = rest.subspan(1, payload_end - 1);
  packet.payload = rest.subspan(header.bytes, rest[mavlink::length_offset]);
  packet.checksum = wire::u16_at(rest, payload_end);
  packet.is_short =
      !header.is_v2 && packet.message != nullptr && packet.payload.size() < packet.message->payload_min;
  return packet;
}

/// Of a message that is not known here any CRC_EXTRA may be the right one: eight bits of the check remain.
bool checksum_fits(const Packet& packet) {
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : packet.checked) crc = crc_with(crc, byte);
  if (packet.message != nullptr) return crc_with(crc, packet.message->crc_extra) == packet.checksum;
  for (unsigned extra = 0; extra < 256; ++extra)
    if (crc_with(crc, static_cast<std::uint8_t>(extra)) == packet.checksum) return true;
  return false;
}

/// A payload's numbers, little-endian. Version 2 leaves out zeros at its end.
class Payload {
 public:
  explicit Payload(Bytes bytes) { std::copy(bytes.begin(), bytes.end(), bytes_.begin()); }

  std::uint8_t u8(std::size_t at) const { return bytes_[at]; }
  std::uint16_t u16(std::size_t at) const { return wire::u16_at(bytes_, at); }
  std::int16_t i16(std::size_t at) const { return wire::i16_at(bytes_, at); }
  std::uint32_t u32(std::size_t at) const { return u16(at) | std::uint32_t{u16(at + 2)} << 16; }
  std::uint64_t u64(std::size_t at) const { return u32(at) | std::uint64_t{u32(at + 4)} << 32; }
  float f32(std::size_t at) const { return std::bit_cast<float>(u32(at)); }

 private:
  std::array<std::uint8_t, mavlink::payload_max_bytes> bytes_{};
};

void set_counts(const Payload& payload, std::size_t at, double dps_per_count, GyroReading& reading) {
  using Limits = std::numeric_limits<std::int16_t>;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const std::int16_t count = payload.i16(at + 2 * axis);
    reading.counts[axis] = count;
    reading.rate_dps[axis] = static_cast<float>(count * dps_per_count);
    reading.saturated |= count == Limits::min() || count == Limits::max();
  }
}

void set_temperature(std::int16_t hundredths, GyroReading& reading) {
  if (hundredths != 0) reading.temp_c = static_cast<float>(hundredths * mavlink::kelvin_per_count);
}

/// 2^63 us and more, which no clock shows, become negative.
std::int64_t microseconds(std::uint64_t time_us) {
  return static_cast<std::int64_t>(time_us);
}

GyroReading read_scaled_imu(const Payload& payload) {
  GyroReading reading;
  set_counts(payload, mavlink::scaled_imu_gyro, 1e-3 * dps_per_rad_s, reading);  // mrad/s
  set_temperature(payload.i16(mavlink::scaled_imu_temperature), reading);
  reading.device_time_us = 1000 * std::int64_t{payload.u32(mavlink::scaled_imu_time_ms)};
  return reading;
}

GyroReading read_raw_imu(const Payload& payload, double scale_dps) {
  GyroReading reading;
  set_counts(payload, mavlink::raw_imu_gyro, scale_dps, reading);
  set_temperature(payload.i16(mavlink::raw_imu_temperature), reading);
  reading.device_time_us = microseconds(payload.u64(mavlink::raw_imu_time_us));
  return reading;
}

GyroReading read_highres_imu(const Payload& payload) {
  GyroReading reading;
  for (std::size_t axis = 0; axis < 3; ++axis)
    reading.rate_dps[axis] =
        static_cast<float>(payload.f32(mavlink::highres_imu_gyro + 4 * axis) * dps_per_rad_s);
  const float temp_c = payload.f32(mavlink::highres_imu_temperature);
  if ((payload.u16(mavlink::highres_imu_updated) & mavlink::updated_temperature) != 0 &&
      std::isfinite(temp_c))
    reading.temp_c = temp_c;
  reading.device_time_us = microseconds(payload.u64(mavlink::highres_imu_time_us));
  return reading;
}

/// A sender that tells nothing of what is new (0) is believed.
bool has_new_rates(const Payload& payload) {
  const std::uint16_t updated = payload.u16(mavlink::highres_imu_updated);
  return updated == 0 || (updated & mavlink::updated_gyro) == mavlink::updated_gyro;
}

/// Some send a message for each of their gyros: the first one's is read.
bool is_sample(const Packet& packet, const Payload& payload, double raw_scale_dps) {
  switch (packet.sender.message) {
    case mavlink::scaled_imu.id:
      return true;
    case mavlink::raw_imu.id:
      return raw_scale_dps > 0.0 && payload.u8(mavlink::raw_imu_id) == 0;
    case mavlink::highres_imu.id:
      return payload.u8(mavlink::highres_imu_id) == 0 && has_new_rates(payload);
    default:
      return false;
  }
}

bool is_sound(const GyroReading& reading) {
  return *reading.device_time_us >= 0 && std::all_of(reading.rate_dps.begin(), reading.rate_dps.end(),
                                                     [](float rate_dps) { return std::isfinite(rate_dps); });
}

/// Finds MAVLink packets of both versions; those of one sender's gyro become readings, others are counted as
/// replies.
class MavlinkScanner {
 public:
  explicit MavlinkScanner(const GyroProfile& profile)
      : wanted_{static_cast<std::uint8_t>(profile.setting("system")),
                static_cast<std::uint8_t>(profile.setting("component")),
                static_cast<std::uint32_t>(profile.setting("message"))},
        raw_scale_dps_(profile.setting("raw_scale_dps")) {}

  void push(Bytes bytes, std::vector<GyroMessage>& out) {
    assert(!ended_);
    ledger_.receive(bytes.size());
    wire::reassemble(pending_, bytes, longest_look, [&](Bytes rest) { return step(rest, out); });
    assert(pending_.size() == ledger_.waiting());
  }
  void finish(std::vector<GyroMessage>& out) {
    ended_ = true;
    wire::reassemble_end(pending_, [&](Bytes rest) { return step(rest, out); });
    assert(pending_.size() == ledger_.waiting());
  }
  /// The sender is chosen anew: what comes back may be another controller.
  void restart() {
    ledger_.restart();
    pending_.clear();
    chosen_.reset();
    locked_ = ended_ = false;
  }
  const wire::Counters& counters() const { return ledger_.counters; }

  std::function<void(const Packet&)> watch;  // is shown every good packet

 private:
  std::size_t step(Bytes rest, std::vector<GyroMessage>& out);
  std::size_t wait();
  std::size_t take_packet(const Packet& packet, std::vector<GyroMessage>& out);
  std::size_t take_bad(const Packet& packet, std::uint64_t& counter);
  bool is_chosen(const Sender& sender);
  std::optional<GyroReading> reading_of(const Packet& packet);
  std::size_t refuse_packet(std::size_t size);
  std::size_t skip(std::size_t bytes);

  Sender wanted_;  // 0: any
  double raw_scale_dps_;
  wire::ByteLedger ledger_;
  std::vector<std::uint8_t> pending_;  // received, not yet booked
  std::optional<Sender> chosen_;
  bool locked_ = false;  // the packets before came in a row
  bool ended_ = false;
};

std::size_t MavlinkScanner::step(Bytes rest, std::vector<GyroMessage>& out) {
  const bool at_begin = ledger_.waiting() == ledger_.counters.bytes_received;
  const std::optional<bool> in_log = locked_ || at_begin ? is_log_time(rest, ended_) : false;
  if (!in_log) return 0;
  if (*in_log) {
    ledger_.book_filler(mavlink::log_time_bytes);
    return mavlink::log_time_bytes;
  }
  if (!is_packet_sync(rest[0]))
    return skip(
        static_cast<std::size_t>(std::find_if(rest.begin(), rest.end(), is_packet_sync) - rest.begin()));
  if (rest.size() < header_of(rest[0]).bytes) return wait();
  if (!is_understood(rest)) return skip(1);
  const std::size_t size = packet_size(rest);
  if (rest.size() < size) return wait();
  const Packet packet = packet_at(rest);
  if (!checksum_fits(packet)) return refuse_packet(size);
  if (packet.message != nullptr) return take_packet(packet, out);
  if (rest.size() == size && !ended_) return 0;
  const std::optional<bool> log_goes_on = is_log_time(rest.subspan(size), ended_);
  if (!log_goes_on) return 0;
  const bool is_followed = rest.size() == size || *log_goes_on || is_packet_sync(rest[size]);
  return is_followed ? take_packet(packet, out) : refuse_packet(size);
}

/// For the rest of a packet. At the end of the stream nothing more comes: good ones may stand inside.
std::size_t MavlinkScanner::wait() {
  return ended_ && !locked_ ? skip(1) : 0;
}

std::size_t MavlinkScanner::take_packet(const Packet& packet, std::vector<GyroMessage>& out) {
  locked_ = true;
  if (packet.is_short) return take_bad(packet, ledger_.counters.bad_length);
  if (watch) watch(packet);
  const std::optional<GyroReading> reading = reading_of(packet);
  if (reading && !is_sound(*reading)) return take_bad(packet, ledger_.counters.bad_value);
  const StreamSpan span = ledger_.book_message(packet.size);
  if (!reading) {
    ++ledger_.counters.replies;
    return packet.size;
  }
  out.push_back({*reading, span, ledger_.take_gap()});
  ++ledger_.counters.messages;
  return packet.size;
}

/// Its check sum is good, its content is not.
std::size_t MavlinkScanner::take_bad(const Packet& packet, std::uint64_t& counter) {
  ++counter;
  ledger_.mark_damage(packet.size);
  ledger_.book_gap(packet.size);
  return packet.size;
}

/// The first sender of a gyro's message, among those that the profile wants.
bool MavlinkScanner::is_chosen(const Sender& sender) {
  const auto fits = [](std::uint32_t wanted, std::uint32_t given) { return wanted == 0 || wanted == given; };
  if (!chosen_ && fits(wanted_.system, sender.system) && fits(wanted_.component, sender.component) &&
      fits(wanted_.message, sender.message))
    chosen_ = sender;
  return chosen_ && chosen_->system == sender.system && chosen_->component == sender.component &&
         chosen_->message == sender.message;
}

std::optional<GyroReading> MavlinkScanner::reading_of(const Packet& packet) {
  const Payload payload(packet.payload);
  if (!is_sample(packet, payload, raw_scale_dps_) || !is_chosen(packet.sender)) return std::nullopt;
  if (packet.sender.message == mavlink::scaled_imu.id) return read_scaled_imu(payload);
  if (packet.sender.message == mavlink::raw_imu.id) return read_raw_imu(payload, raw_scale_dps_);
  return read_highres_imu(payload);
}

std::size_t MavlinkScanner::refuse_packet(std::size_t size) {
  if (locked_) {
    ++ledger_.counters.bad_checksum;
    ledger_.mark_damage(size);
  }
  return skip(1);
}

std::size_t MavlinkScanner::skip(std::size_t bytes) {
  locked_ = false;
  ledger_.book_gap(bytes);
  return bytes;
}

constexpr std::array<UsualBaud, 2> mavlink_bauds{{{115200, 0.15}, {57600, 0.04}}};

/// The message that the profile names, else RAW_IMU where its scale is stated, else the usual one.
const mavlink::Message& expected_message(const GyroProfile& profile) {
  const mavlink::Message* named = find_message(static_cast<std::uint32_t>(profile.setting("message")));
  if (named != nullptr && named->id != mavlink::heartbeat.id) return *named;
  return profile.setting("raw_scale_dps") > 0.0 ? mavlink::raw_imu : mavlink::scaled_imu;
}

/// SCALED_IMU has 32 bits of milliseconds since the boot, the others 64 of microseconds.
ClockProperties mavlink_clock(const GyroProfile& profile) {
  if (expected_message(profile).id == mavlink::scaled_imu.id)
    return {.tick_s = 1e-3, .wrap_ticks = std::uint64_t{1} << 32U};
  return {.tick_s = 1e-6};
}

std::uint64_t mavlink_message_bytes(const GyroProfile& profile) {
  return mavlink::header_v2_bytes + expected_message(profile).payload + mavlink::checksum_bytes;
}

template <typename Number>
void put(std::vector<std::uint8_t>& bytes, std::size_t at, Number value) {
  for (std::size_t i = 0; i < sizeof(Number); ++i)
    bytes[at + i] = static_cast<std::uint8_t>(value >> (8 * i));
}

/// Appends a packet of ours; `sync` says of which version.
void append_packet(std::uint8_t sync, unsigned number, const mavlink::Message& message,
                   std::vector<std::uint8_t> payload, std::vector<std::uint8_t>& out) {
  const PacketHeader header = header_of(sync);
  if (header.is_v2)
    while (payload.size() > 1 && payload.back() == 0) payload.pop_back();
  std::vector<std::uint8_t> packet(header.bytes);
  packet[0] = sync;
  packet[mavlink::length_offset] = static_cast<std::uint8_t>(payload.size());
  packet[header.address] = static_cast<std::uint8_t>(number);
  packet[header.address + 1] = mavlink::host_system;
  packet[header.address + 2] = mavlink::host_component;
  packet[header.address + 3] = static_cast<std::uint8_t>(message.id);
  packet.insert(packet.end(), payload.begin(), payload.end());
  std::uint16_t crc = 0xFFFF;
  for (const std::uint8_t byte : std::span(packet).subspan(1)) crc = crc_with(crc, byte);
  crc = crc_with(crc, message.crc_extra);
  packet.push_back(static_cast<std::uint8_t>(crc & 0xFFU));
  packet.push_back(static_cast<std::uint8_t>(crc >> 8));
  out.insert(out.end(), packet.begin(), packet.end());
}

std::uint8_t setting_byte(const GyroProfile& profile, const char* name) {
  return static_cast<std::uint8_t>(profile.setting(name));
}

std::vector<std::uint8_t> interval_command(const GyroProfile& profile, unsigned asked) {
  std::vector<std::uint8_t> payload(mavlink::command_long.payload);
  const auto parameter = [&](std::size_t index, double value) {
    put(payload, mavlink::command_long_parameters + 4 * index,
        std::bit_cast<std::uint32_t>(static_cast<float>(value)));
  };
  parameter(0, expected_message(profile).id);
  parameter(1, 1e6 / profile.output_rate_hz);
  put(payload, mavlink::command_long_command, mavlink::set_message_interval);
  payload[mavlink::command_long_system] = setting_byte(profile, "system");
  payload[mavlink::command_long_component] = setting_byte(profile, "component");
  payload[mavlink::command_long_confirmation] = static_cast<std::uint8_t>(std::min(asked, 255U));
  return payload;
}

std::vector<std::uint8_t> data_stream_request(const GyroProfile& profile) {
  std::vector<std::uint8_t> payload(mavlink::request_data_stream.payload);
  put(payload, mavlink::data_stream_rate_hz, static_cast<std::uint16_t>(std::lround(profile.output_rate_hz)));
  payload[mavlink::data_stream_system] = setting_byte(profile, "system");
  payload[mavlink::data_stream_component] = setting_byte(profile, "component");
  payload[mavlink::data_stream_id] = mavlink::raw_sensors_stream;
  payload[mavlink::data_stream_start] = 1;
  return payload;
}

/// The message at the profile's rate. Who does not do that when it is asked first may be of the time before
/// that command: it is asked for its stream of raw sensors as well, in the packet of that time.
std::vector<std::uint8_t> mavlink_request(const GyroProfile& profile, unsigned asked) {
  std::vector<std::uint8_t> bytes;
  append_packet(mavlink::sync_v2, 2 * asked, mavlink::command_long, interval_command(profile, asked), bytes);
  if (asked > 0)
    append_packet(mavlink::sync_v1, 2 * asked + 1, mavlink::request_data_stream, data_stream_request(profile),
                  bytes);
  return bytes;
}

GyroScanner mavlink_scanner(const GyroProfile& profile, StreamStart) {
  return GyroScanner(MavlinkScanner(profile));
}

/// What the profile has to say: which message of a gyro comes most often, the finer one of equals, and the
/// unit of RAW_IMU's counts where the controller's kind tells it.
GyroProfile mavlink_profile_for(Bytes bytes) {
  std::map<std::uint32_t, std::size_t> messages;
  bool is_ardupilot = false;
  MavlinkScanner scanner{GyroProfile()};
  scanner.watch = [&](const Packet& packet) {
    ++messages[packet.sender.message];
    if (packet.sender.message == mavlink::heartbeat.id)
      is_ardupilot |=
          Payload(packet.payload).u8(mavlink::heartbeat_autopilot) == mavlink::autopilot_ardupilot;
  };
  std::vector<GyroMessage> readings;
  scanner.push(bytes, readings);
  scanner.finish(readings);
  GyroProfile profile;
  std::size_t most = 1;
  for (const mavlink::Message& message : {mavlink::raw_imu, mavlink::scaled_imu, mavlink::highres_imu}) {
    if (messages[message.id] < most) continue;
    most = messages[message.id];
    profile.settings["message"] = message.id;
  }
  if (is_ardupilot && profile.setting("message") == mavlink::raw_imu.id)
    profile.settings["raw_scale_dps"] = 1e-3 * dps_per_rad_s;
  return profile;
}

std::optional<Evidence> recognise_mavlink(Bytes bytes, double) {
  const GyroProfile profile = mavlink_profile_for(bytes);
  MavlinkScanner scanner{profile};
  std::vector<GyroMessage> messages;
  scanner.push(bytes, messages);
  const wire::Counters& counters = scanner.counters();
  const std::uint64_t packets = counters.messages + counters.replies;
  if (packets < 2) return std::nullopt;
  Evidence evidence{.messages = messages.size(),
                    .bytes = counters.bytes_in_messages,
                    .text = fmt::format("{} MAVLink packets, {} of a gyro", packets, messages.size()),
                    .text_format = {},
                    .advice = {},
                    .settings = profile.settings};
  if (!messages.empty()) return evidence;
  evidence.settings.clear();
  if (profile.setting("message") == mavlink::raw_imu.id) {
    evidence.text =
        fmt::format("{} MAVLink packets, counts of a gyro (RAW_IMU) whose scale nothing says", packets);
    evidence.advice =
        "raw_scale_dps in [gyro.mavlink], deg/s of a count (0.0573 where it counts mrad/s); or ask the "
        "controller for "
        "SCALED_IMU or HIGHRES_IMU";
  } else {
    evidence.text = fmt::format("no IMU message among {} good MAVLink packets", packets);
    evidence.advice = "ask the controller for HIGHRES_IMU or SCALED_IMU (its stream of raw sensors)";
  }
  return evidence;
}

}  // namespace

FramedProtocol mavlink_frames() {
  return {"MAVLink packets (FE, FD)",
          [](Bytes rest) -> std::optional<std::size_t> {
            if (!is_packet_sync(rest[0])) return std::nullopt;
            if (rest.size() < header_of(rest[0]).bytes) return 0;
            return is_understood(rest) ? std::optional(packet_size(rest)) : std::nullopt;
          },
          [](Bytes frame) { return checksum_fits(packet_at(frame)); }};
}

GyroProtocol mavlink_gyro() {
  return {.name = "mavlink",
          .sends = "MAVLink packets",
          .settings = mavlink_settings,
          .bauds = mavlink_bauds,
          .clock = mavlink_clock,
          .message_bytes = mavlink_message_bytes,
          .scanner = mavlink_scanner,
          .recognise = recognise_mavlink,
          .request = mavlink_request,
          .is_told_rate = true};
}

}  // namespace thermorig::sensors

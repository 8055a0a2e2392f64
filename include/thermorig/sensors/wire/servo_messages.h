// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <variant>
#include <vector>

#include "servo_link.h"
#include "thermorig/core/chunk.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/reading.h"
#include "thermorig/sensors/wire/byte_ledger.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::wire {

// Messages of the servo link in the units of the program. Bytes: protocols/servo_link.h and servo_link.md.

struct ServoWelcome {
  std::uint8_t version = 0;
  std::string firmware;    // "1.0.0"
  std::uint8_t board = 0;  // of a servo on a bus: its ID
  std::uint8_t reset_cause = 0;
  std::uint32_t uptime_us = 0;
  double limit_pulse_min_us = 0, limit_pulse_max_us = 0;
  double limit_rate_dps = 0, limit_acceleration_dps2 = 0;
  unsigned watchdog_ms = 0;
};

struct ServoAck {
  std::uint8_t type = 0;
  std::uint32_t mcu_us = 0;
};

struct ServoNack {
  std::uint8_t type = 0;
  std::uint8_t reason = 0;  // enum servo_reason
  std::uint8_t detail = 0;
};

struct ServoPong {
  std::uint32_t token = 0, receive_us = 0, send_us = 0;
};

struct ServoEvent {
  std::uint8_t kind = 0;  // enum servo_event_kind
  std::uint16_t detail = 0;
  std::uint32_t mcu_us = 0;
};

/// An answer of a servo that does not carry our firmware: what it is an answer to, who asked knows.
struct ServoReply {
  std::uint8_t id = 0;             // on a bus
  std::uint8_t error = 0;          // 0: none
  std::vector<std::uint8_t> data;  // Dynamixel: parameters; GRBL: the line
};

using ServoBody = std::variant<ServoState, ServoWelcome, ServoAck, ServoNack, ServoPong, ServoEvent,
                               ShaftReading, ServoReply>;

struct ServoMessage {
  ServoBody body;
  std::uint8_t sequence = 0;
  StreamSpan span;
  bool lost_before = false;  // telemetry, events: the sequence number shows a loss; others: a gap before
};

/// Finds the servo's frames in a stream of bytes. A frame of unknown type (bad_value) or wrong length
/// (bad_length) is counted, not thrown. A WELCOME of another protocol version carries that version alone.
class ServoScanner {
 public:
  ServoScanner();
  void push(std::span<const std::uint8_t> bytes, std::vector<ServoMessage>& out);

  /// No more bytes will come. Nothing depends on it: a frame ends with its flag, and what has not ended stays
  /// pending. As the other scanners have it.
  void finish(std::vector<ServoMessage>& out);

  /// After finish(): the stream was interrupted, and what comes next is a stream anew. Spans and counters go
  /// on.
  void restart();
  const Counters& counters() const { return ledger_.counters; }

 private:
  std::size_t take_plain(std::span<const std::uint8_t> bytes);
  void take(std::uint8_t byte, std::vector<ServoMessage>& out);
  void take_nothing(std::uint8_t byte, bool was_overlong);
  void take_frame(std::vector<ServoMessage>& out);
  void take_damaged(bool was_overlong);
  void take_stop(bool was_open, bool was_overlong);
  void book_damage(std::uint64_t bytes);
  bool is_open() const;
  bool find_loss(const ServoMessage& message);
  bool count_missing(std::optional<std::uint8_t>& before, std::uint8_t sequence);

  servo_decoder decoder_{};
  ByteLedger ledger_;
  std::optional<std::uint8_t> telemetry_sequence_;  // of the last telemetry
  std::optional<std::uint8_t> event_sequence_;      // of the last event
  std::optional<std::uint8_t> shaft_sequence_;      // of the last reading of the shaft
  std::uint32_t telemetry_mcu_us_ = 0;              // of the last telemetry
  bool ended_ = false;
};

// Commands to bytes: one whole frame each. Angles in degrees, rates in degrees per second; values that do not
// fit their field are a bug of the caller and abort.
std::vector<std::uint8_t> hello_bytes(std::uint8_t sequence);
/// The same, and asks for readings of the shaft, if something measures it.
std::vector<std::uint8_t> asking_hello_bytes(std::uint8_t sequence);
std::vector<std::uint8_t> configure_bytes(std::uint8_t sequence, const ServoProfile& servo);
std::vector<std::uint8_t> arm_bytes(std::uint8_t sequence, double angle_deg);
std::vector<std::uint8_t> disarm_bytes(std::uint8_t sequence);
std::vector<std::uint8_t> halt_bytes(std::uint8_t sequence);
std::vector<std::uint8_t> refresh_bytes();
std::vector<std::uint8_t> ping_bytes(std::uint32_t token, std::uint16_t delay_max_us);

struct RunCommand {
  std::uint16_t leg = 0;
  bool turn_back = false;
  double rate_dps = 0;
  double acceleration_dps2 = 0;
  double duration_s = 0;
};
std::vector<std::uint8_t> run_bytes(std::uint8_t sequence, const RunCommand& run);

struct GoToCommand {
  double angle_deg = 0;
  double rate_dps = 0;
  double acceleration_dps2 = 0;
};
std::vector<std::uint8_t> go_to_bytes(std::uint8_t sequence, const GoToCommand& go_to);

/// The raw stop byte: stops the servo in any state, outside any frame.
std::vector<std::uint8_t> stop_bytes();

/// "the angle, rate or duration lies beyond a limit": for logs and errors. Unknown numbers are named as such.
std::string reason_text(std::uint8_t reason);
std::string command_name(std::uint8_t type);
std::string event_text(const ServoEvent& event);

}  // namespace thermorig::wire

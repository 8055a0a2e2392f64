// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/core/sample.h"
#include "thermorig/core/time.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::rig {

/// Times of the host's end of the servo link.
struct CommanderTimes {
  HostDuration answer = std::chrono::milliseconds(80);         // then a command is sent again
  int tries = 6;                                               // then the servo is given up
  HostDuration hello_answer = std::chrono::milliseconds(250);  // an Arduino boots for up to 2 s after opening
  int hello_tries = 40;
  HostDuration refresh = std::chrono::milliseconds(40);  // SERVO_REFRESH_MS
  // Mean; each gap lies within -30..+30 %. A bound is as good as the luckiest of the pings within about 10 s,
  // beyond which the clock may have wandered: ten a second keep it below 0.25 ms over USB-CDC.
  HostDuration ping = std::chrono::milliseconds(100);
};

/// The host's end of the servo link: stop-and-wait commands with retries, refreshes of the watchdog, pings.
/// Pure: the caller brings the time, carries the bytes and feeds the answers.
class ServoCommander {
 public:
  explicit ServoCommander(const ServoProfile& servo, const CommanderTimes& times = {});

  // Commands wait in a queue; each is sent when the one before was acknowledged.
  void greet();  // hello, disarm, configure; forgets everything queued
  void arm(double angle_deg);
  void disarm();
  void halt();
  void run(const wire::RunCommand& command);
  void go_to(const wire::GoToCommand& command);

  /// Raw stop byte ahead of everything; forgets the queue. From here on refusals are only noted.
  void stop();

  /// Forgets what is queued; a command that was sent already is still brought to its end.
  void clear();

  /// Bytes to write now; empty if there is nothing to say. Call every 10 ms or so. Throws Error:
  /// device_missing if hello is never answered, device_lost if a later command is not.
  std::vector<std::uint8_t> poll(HostTime now);

  /// An answer of the servo (welcome, ack, nack, event). Throws Error: device_missing for another version of
  /// the link ("reflash"), bad_usage for a command that the firmware refuses for its values.
  void answer(const wire::ServoMessage& message, HostTime arrived);

  /// An answer to a ping: tells whether the link is behind a latency timer, which lengthens the pings' delay.
  /// Returns how long it was under way, without what the firmware held it back; none if it is not ours.
  std::optional<HostDuration> pong(const TimedPong& pong);

  bool idle() const { return queue_.empty(); }  // everything was acknowledged
  bool greeted() const { return welcome_.has_value(); }
  bool armed() const { return armed_; }
  bool gave_up() const { return gave_up_; }                         // a command was never answered
  bool was_reset() const { return was_reset_; }                     // it must be greeted again
  std::optional<std::uint8_t> refusal() const { return refusal_; }  // enum servo_reason: fault or not armed
  HostTime last_ack() const { return last_ack_; }
  const std::optional<wire::ServoWelcome>& welcome() const { return welcome_; }
  std::uint64_t retries() const { return retries_; }
  std::uint64_t pings() const { return ping_token_; }

 private:
  struct Command {
    std::uint8_t type = 0;
    std::function<std::vector<std::uint8_t>(std::uint8_t sequence)> bytes;
    std::uint8_t sequence = 0;
    int sent = 0;  // times
    HostTime last_sent{};
  };
  struct SentPing {
    std::uint32_t token = 0;
    HostTime time{};
  };

  void push(std::uint8_t type, std::function<std::vector<std::uint8_t>(std::uint8_t)> bytes);
  void send_command(HostTime now, std::vector<std::uint8_t>& out);
  void send_refresh(HostTime now, std::vector<std::uint8_t>& out);
  void send_ping(HostTime now, std::vector<std::uint8_t>& out);
  bool is_answer_to_front(std::uint8_t type, std::uint8_t sequence) const;
  void acknowledged(HostTime arrived);
  void take(const wire::ServoWelcome& welcome, std::uint8_t sequence, HostTime arrived);
  void take(const wire::ServoNack& nack, std::uint8_t sequence);
  void take(const wire::ServoEvent& event);
  [[noreturn]] void give_up(const Command& command);
  [[noreturn]] void wrong_version(unsigned firmware) const;

  ServoProfile servo_;
  CommanderTimes times_;
  std::deque<Command> queue_;
  std::uint8_t next_sequence_ = 0;
  std::optional<wire::ServoWelcome> welcome_;
  bool armed_ = false;
  bool stopping_ = false;
  bool stop_byte_due_ = false;
  bool was_reset_ = false;
  bool gave_up_ = false;
  std::optional<std::uint8_t> refusal_;
  HostTime last_ack_{};
  HostTime last_bytes_{};
  HostTime next_ping_{};
  std::uint32_t ping_token_ = 0;
  std::deque<SentPing> pings_;
  bool latency_timer_ = false;
  std::uint64_t retries_ = 0;
  int configure_tries_ = 0;
};

}  // namespace thermorig::rig

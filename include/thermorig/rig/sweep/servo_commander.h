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
#include "thermorig/rig/sweep/servo_driver.h"
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
class ServoCommander final : public ServoDriver {
 public:
  explicit ServoCommander(const ServoProfile& servo, const CommanderTimes& times = {});

  void greet() override;  // hello, disarm, configure
  void arm(double angle_deg) override;
  void disarm() override;
  void halt() override;
  void run(const wire::RunCommand& command) override;
  void go_to(const wire::GoToCommand& command) override;
  void stop() override;  // by the raw stop byte
  void clear() override;
  std::vector<std::uint8_t> poll(HostTime now) override;

  /// Throws Error: device_missing for another version of the link ("reflash"), bad_usage for a command that
  /// the firmware refuses for its values.
  void answer(const wire::ServoMessage& message, HostTime arrived) override;

  /// Its time also shows whether the link is behind a latency timer, which lengthens the pings' delay.
  std::optional<HostDuration> pong(const TimedPong& pong) override;

  std::string how_it_rests() const override { return "its own watchdog stops it"; }
  bool idle() const override { return queue_.empty(); }
  std::uint64_t requests() const override { return ping_token_; }

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

  CommanderTimes times_;
  std::deque<Command> queue_;
  std::uint8_t next_sequence_ = 0;
  bool stopping_ = false;
  bool stop_byte_due_ = false;
  HostTime last_bytes_{};
  HostTime next_ping_{};
  std::uint32_t ping_token_ = 0;
  std::deque<SentPing> pings_;
  bool latency_timer_ = false;
  int configure_tries_ = 0;
};

}  // namespace thermorig::rig

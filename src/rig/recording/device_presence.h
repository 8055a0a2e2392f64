// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>

#include "first_bytes.h"
#include "thermorig/core/device.h"
#include "thermorig/core/error.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"
#include "thermorig/rig/discovery/detect.h"
#include "thermorig/rig/recording/recording.h"

namespace thermorig::rig {

/// "camera (/dev/ttyUSB0)", or the device alone if it has no port.
std::string place_of(Device device, const RigProfile& profile);

/// Is a device there? One that went is awaited, or done without; either way so many good messages show that
/// it is back. Pure: the caller brings time, bytes and good messages.
class DevicePresence {
 public:
  /// `patience_s`: how long it is waited for, from its going.
  DevicePresence(Device device, const RigProfile& profile, double patience_s);

  bool is_there() const { return state_ == State::there; }
  bool is_awaited() const { return state_ == State::awaited; }
  bool is_done_without() const { return state_ == State::done_without; }
  bool was_done_without() const { return was_done_without_; }
  bool has_port() const { return has_port_; }

  /// The device went while it is needed; `why` ends the recording if it does not come back. Its port may
  /// still be open (it is silent, stuck, or sends what nobody can read).
  void await(const Error& why, HostTime now);
  /// It went, and nobody waits for it.
  void do_without();
  /// It went when nothing was asked of it any more: its port is not looked for.
  void forgo();
  /// The rig has none: nobody misses it.
  void never_was_there() {
    state_ = State::done_without;
    has_port_ = false;
  }
  void lose_port();
  void open_port(HostTime now);
  /// What it sends while it is awaited.
  void received(std::span<const std::uint8_t> bytes, HostTime arrived);
  /// A good message that tells something new, in it.
  void message() { ++messages_; }

  /// Enough good messages have come from a device that went: noise gives none of a camera, a few of a gyro
  /// without a checksum.
  bool is_back() const;
  /// It is there again. Returns since when it was not.
  HostTime come_back();

  /// What is shown while it is awaited.
  std::optional<AwaitedDevice> awaited(HostTime now) const;
  /// Why the recording must end: the patience is over, or another device came back in its place.
  std::optional<Error> verdict(HostTime now) const;

 private:
  enum class State : std::uint8_t { there, awaited, done_without };
  double left_s(HostTime now) const;
  Error place_taken(const Evidence& evidence) const;
  Error overdue() const;

  Device device_;
  std::string place_;
  double patience_s_;
  State state_ = State::there;
  bool was_done_without_ = false;  // for a while at least
  bool has_port_ = true;
  std::optional<Error> why_;
  HostTime since_{};
  HostTime heard_since_{};  // the port was opened, or the device was found to be gone
  FirstBytes first_bytes_;
  std::uint64_t messages_ = 0;
};

}  // namespace thermorig::rig

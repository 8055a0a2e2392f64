// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/error.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"

namespace thermorig::rig {

/// Devices that went while a recording needs them: how long they are waited for, and what shows that one is
/// back. Pure: the caller brings time, bytes and good messages.
class Replug {
 public:
  /// `patience_s`: how long each is waited for, from its going.
  Replug(const RigProfile& profile, double patience_s);

  /// The device went; `why` ends the recording if it does not come back. `has_port`: its port is still open
  /// (it is silent, stuck, or sends what nobody can read).
  void gone(Device device, const Error& why, bool has_port, HostTime now);
  void port_lost(Device device);
  void port_opened(Device device, HostTime now);

  /// Messages that make a device one that is back: noise gives none of a camera, a few of a gyro without a
  /// checksum.
  static std::uint64_t messages_needed(Device device);

  /// What a device that is awaited sends.
  void received(Device device, std::span<const std::uint8_t> bytes, HostTime arrived);
  /// A good message that tells something new, in it.
  void message(Device device);

  bool awaits(Device device) const { return absences_[device].has_value(); }
  bool awaits_any() const;
  bool has_port(Device device) const { return !absences_[device] || absences_[device]->has_port; }

  /// Enough good messages have come from it.
  bool is_back(Device device) const;
  /// It is not awaited any more. Returns since when it was.
  HostTime forget(Device device);

  /// Why the recording must end: the patience is over, or another device came back in its place.
  std::optional<Error> verdict(HostTime now) const;

  const std::string& why(Device device) const { return absences_[device]->why.what_happened(); }
  double waited_s(Device device, HostTime now) const { return to_s(now - absences_[device]->since); }
  double left_s(Device device, HostTime now) const;

 private:
  struct Absence {
    Error why;
    HostTime since{};
    bool has_port = false;
    HostTime heard_since{};  // the port was opened, or the device was found to be gone
    std::uint64_t bytes = 0;
    std::uint64_t messages = 0;
    std::vector<std::uint8_t> first_bytes;
  };
  std::optional<Error> other_device(Device device, const Absence& absence, HostTime now) const;
  Error overdue(Device device, const Absence& absence) const;

  RigProfile profile_;
  double patience_s_;
  PerDevice<std::optional<Absence>> absences_;
};

}  // namespace thermorig::rig

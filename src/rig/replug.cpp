// SPDX-License-Identifier: MIT
#include "thermorig/rig/replug.h"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "recording_start.h"
#include "thermorig/rig/detect.h"

namespace thermorig::rig {

namespace {

constexpr double hearing_s = 3.0;  // before bytes are taken for those of another device

}  // namespace

Replug::Replug(const RigProfile& profile, double patience_s) : profile_(profile), patience_s_(patience_s) {}

std::uint64_t Replug::messages_needed(Device device) {
  constexpr PerDevice<std::uint64_t> needed{{2, 20, 10}};
  return needed[device];
}

void Replug::gone(Device device, const Error& why, bool has_port, HostTime now) {
  absences_[device] = Absence{.why = why, .since = now, .has_port = has_port, .heard_since = now};
}

void Replug::port_lost(Device device) {
  if (absences_[device]) absences_[device]->has_port = false;
}

void Replug::port_opened(Device device, HostTime now) {
  std::optional<Absence>& absence = absences_[device];
  if (!absence) return;
  absence->has_port = true;
  absence->heard_since = now;
  absence->bytes = absence->messages = 0;
  absence->first_bytes.clear();
}

void Replug::received(Device device, std::span<const std::uint8_t> bytes, HostTime arrived) {
  std::optional<Absence>& absence = absences_[device];
  if (!absence) return;
  if (absence->bytes == 0) absence->heard_since = arrived;
  absence->bytes += bytes.size();
  const std::size_t room = first_bytes_kept - std::min(first_bytes_kept, absence->first_bytes.size());
  const auto some = bytes.first(std::min(room, bytes.size()));
  absence->first_bytes.insert(absence->first_bytes.end(), some.begin(), some.end());
}

void Replug::message(Device device) {
  if (absences_[device]) ++absences_[device]->messages;
}

bool Replug::awaits_any() const {
  return std::any_of(all_devices.begin(), all_devices.end(),
                     [this](Device device) { return awaits(device); });
}

bool Replug::is_back(Device device) const {
  const std::optional<Absence>& absence = absences_[device];
  return absence && absence->has_port && absence->messages >= messages_needed(device);
}

HostTime Replug::forget(Device device) {
  return std::exchange(absences_[device], std::nullopt)->since;
}

double Replug::left_s(Device device, HostTime now) const {
  return std::max(0.0, patience_s_ - waited_s(device, now));
}

std::optional<Error> Replug::verdict(HostTime now) const {
  for (const Device device : all_devices) {
    const std::optional<Absence>& absence = absences_[device];
    if (!absence) continue;
    if (auto other = other_device(device, *absence, now)) return other;
    if (left_s(device, now) <= 0.0) return overdue(device, *absence);
  }
  return std::nullopt;
}

/// What sends the messages of another device will not become the one that is awaited.
std::optional<Error> Replug::other_device(Device device, const Absence& absence, HostTime now) const {
  if (absence.messages > 0 || absence.bytes == 0 || to_s(now - absence.heard_since) < hearing_s)
    return std::nullopt;
  const Evidence evidence = classify(absence.first_bytes);
  if (!evidence.role || *evidence.role == device) return std::nullopt;
  return Error(ExitCode::device_lost,
               fmt::format("another device is on its port now: it sends {}, that is the {}, not the {}",
                           evidence.text, name_of(*evidence.role), name_of(device)),
               place_of(device, profile_), "plug each device into its own port again, then record again");
}

Error Replug::overdue(Device device, const Absence& absence) const {
  std::string what =
      fmt::format("{}, and it did not come back within {:.0f} s", absence.why.what_happened(), patience_s_);
  if (absence.bytes > 0)
    what += fmt::format(" ({} bytes came, but too few messages of the {} in them)", absence.bytes,
                        name_of(device));
  return {ExitCode::device_lost, what, place_of(device, profile_), absence.why.advice()};
}

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#include "device_presence.h"

#include <fmt/format.h>

#include <algorithm>

namespace thermorig::rig {

namespace {

constexpr double hearing_s = 3.0;  // before bytes are taken for those of another device
constexpr PerDevice<std::uint64_t> messages_of_return{{2, 20, 10}};

}  // namespace

std::string place_of(Device device, const RigProfile& profile) {
  const std::string& port = profile.link(device).port;
  return port.empty() ? std::string(name_of(device)) : fmt::format("{} ({})", name_of(device), port);
}

DevicePresence::DevicePresence(Device device, const RigProfile& profile, double patience_s)
    : device_(device), place_(place_of(device, profile)), patience_s_(patience_s) {}

void DevicePresence::await(const Error& why, HostTime now) {
  state_ = State::awaited;
  why_ = why;
  since_ = heard_since_ = now;
  first_bytes_.clear();
  messages_ = 0;
}

void DevicePresence::do_without() {
  state_ = State::done_without;
  was_done_without_ = true;
  messages_ = 0;
}

void DevicePresence::forgo() {
  state_ = State::done_without;
  has_port_ = true;
  messages_ = 0;
}

void DevicePresence::lose_port() {
  has_port_ = false;
  if (is_done_without()) messages_ = 0;
}

void DevicePresence::open_port(HostTime now) {
  has_port_ = true;
  heard_since_ = now;
  first_bytes_.clear();
  messages_ = 0;
}

void DevicePresence::received(std::span<const std::uint8_t> bytes, HostTime arrived) {
  if (!is_awaited()) return;
  if (first_bytes_.count() == 0) heard_since_ = arrived;
  first_bytes_.add(bytes);
}

bool DevicePresence::is_back() const {
  return !is_there() && has_port_ && messages_ >= messages_of_return[device_];
}

HostTime DevicePresence::come_back() {
  state_ = State::there;
  return since_;
}

double DevicePresence::left_s(HostTime now) const {
  return std::max(0.0, patience_s_ - to_s(now - since_));
}

std::optional<AwaitedDevice> DevicePresence::awaited(HostTime now) const {
  if (!is_awaited()) return std::nullopt;
  return AwaitedDevice{why_->what_happened(), to_s(now - since_), left_s(now)};
}

/// What sends the messages of another device will not become the one that is awaited.
std::optional<Error> DevicePresence::verdict(HostTime now) const {
  if (!is_awaited()) return std::nullopt;
  const bool is_strange = messages_ == 0 && first_bytes_.count() > 0 && to_s(now - heard_since_) >= hearing_s;
  if (is_strange) {
    const Evidence evidence = classify(first_bytes_.kept());
    if (evidence.role && *evidence.role != device_) return place_taken(evidence);
  }
  if (left_s(now) > 0.0) return std::nullopt;
  return overdue();
}

Error DevicePresence::place_taken(const Evidence& evidence) const {
  return {ExitCode::device_lost,
          fmt::format("another device is on its port now: it sends {}, so it is the {}, not the {}",
                      evidence.found.text, name_of(*evidence.role), name_of(device_)),
          place_, "plug each device into its own port again, then record again"};
}

Error DevicePresence::overdue() const {
  std::string what =
      fmt::format("{}, and it did not come back within {:.0f} s", why_->what_happened(), patience_s_);
  if (first_bytes_.count() > 0)
    what += fmt::format(" ({} bytes came, with too few messages of the {})", first_bytes_.count(),
                        name_of(device_));
  return {ExitCode::device_lost, what, place_, why_->advice()};
}

}  // namespace thermorig::rig

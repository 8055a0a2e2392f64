// SPDX-License-Identifier: MIT
#include "thermorig/io/find_again.h"

#include <algorithm>

#include "thermorig/core/error.h"
#include "thermorig/io/files/holder.h"

namespace thermorig::io {

namespace {

std::vector<PortInfo> listed_ports() {
  try {
    return list_ports();
  } catch (const Error&) {  // no /sys: then names are all there is
    return {};
  }
}

bool is_pseudo_terminal_path(const std::string& path) {
  return path.starts_with("/dev/pts/");
}

/// The number of a pseudo terminal that is gone is given to the next one: to the rig's again, or to
/// somebody's shell, which has it open.
std::optional<std::string> path_behind(const std::string& name) {
  try {
    const std::string path = resolve_port(name);
    return is_pseudo_terminal_path(path) && files::other_holder_of(path) ? std::nullopt : std::optional(path);
  } catch (const Error&) {
    return std::nullopt;
  }
}

const PortInfo* with_path(const std::vector<PortInfo>& listed, const std::string& path) {
  const auto found =
      std::find_if(listed.begin(), listed.end(), [&](const PortInfo& info) { return info.path == path; });
  return found == listed.end() ? nullptr : &*found;
}

/// Camera and gyro may be on the two ports of one adapter, which sits in one socket.
bool is_same_place(const PortInfo& a, const PortInfo& b) {
  return !a.usb_path.empty() && a.usb_path == b.usb_path && a.usb_interface == b.usb_interface;
}

bool is_held(const std::string& path, const std::vector<KnownPort>& others) {
  return std::any_of(others.begin(), others.end(),
                     [&](const KnownPort& other) { return other.open_path == path; });
}

}  // namespace

KnownPort know_port(const std::string& name) {
  KnownPort port{.name = name, .info = {}};
  const std::string path = resolve_port(name);
  const std::vector<PortInfo> listed = listed_ports();
  if (const PortInfo* info = with_path(listed, path)) port.info = *info;
  port.info.path = path;
  return port;
}

std::optional<std::string> choose_again(const KnownPort& port, const std::vector<PortInfo>& listed,
                                        const std::optional<std::string>& named,
                                        const std::vector<KnownPort>& others) {
  for (const PortInfo& info : listed)
    if (is_same_place(info, port.info) && info.usb_id == port.info.usb_id && !is_held(info.path, others))
      return info.path;
  if (!named || is_held(*named, others)) return std::nullopt;
  const PortInfo* info = with_path(listed, *named);
  if (info == nullptr) return named;
  const bool is_other_kind = !port.info.usb_id.empty() && info->usb_id != port.info.usb_id;
  const bool is_others = std::any_of(
      others.begin(), others.end(), [&](const KnownPort& other) { return is_same_place(other.info, *info); });
  return is_other_kind || is_others ? std::nullopt : named;
}

std::optional<std::string> find_again(const KnownPort& port, const std::vector<KnownPort>& others) {
  return choose_again(port, listed_ports(), path_behind(port.name), others);
}

}  // namespace thermorig::io

// SPDX-License-Identifier: MIT
#include "virtual_ports.h"

#include <algorithm>
#include <array>
#include <csignal>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/io/emergency_bytes.h"

namespace thermorig::rig::test {

namespace {

constexpr auto step = std::chrono::milliseconds(2);
constexpr auto words_period = std::chrono::milliseconds(20);

constexpr std::array requests_to_stop{SIGINT, SIGTERM, SIGHUP};
std::array<volatile std::sig_atomic_t, requests_to_stop.size()> caught{};

void catch_signal(int signal) {
  for (std::size_t i = 0; i < requests_to_stop.size(); ++i)
    if (requests_to_stop[i] == signal) caught[i] = 1;
}

}  // namespace

VirtualPorts::VirtualPorts(const simulation::VirtualRigConfig& config,
                           std::unique_ptr<simulation::Firmware> firmware)
    : rig_(config, std::move(firmware)),
      now_(config.start),
      next_words_(config.start),
      next_tick_(config.start) {
  rig_.keep_truth(true);
  for (const Device device : all_devices) paths_[device] = add_port(device, {});
}

VirtualPorts::~VirtualPorts() {
  if (!signalled_) return;
  for (const int signal : requests_to_stop) std::signal(signal, SIG_DFL);
}

std::string VirtualPorts::add_port(std::optional<Device> device, Speaker speaker) {
  ports_.push_back({.path = "/dev/virtual" + std::to_string(next_number_++),
                    .device = device,
                    .speaker = std::move(speaker),
                    .opened = {}});
  return ports_.back().path;
}

std::string VirtualPorts::add(Speaker speaker) {
  return add_port(std::nullopt, std::move(speaker));
}

void VirtualPorts::set_baud(Device device, std::uint32_t baud) {
  port_at(paths_[device])->baud = baud;
}

void VirtualPorts::hold(const std::string& path) {
  port_at(path)->is_held = true;
}

VirtualPorts::Port* VirtualPorts::port_at(const std::string& path) {
  const auto found =
      std::find_if(ports_.begin(), ports_.end(), [&](const Port& port) { return port.path == path; });
  return found == ports_.end() ? nullptr : &*found;
}

VirtualPorts::Port* VirtualPorts::port_of(PortId id) {
  return opened_.at(id).is_closed ? nullptr : port_at(opened_.at(id).path);
}

void VirtualPorts::unplug(Device device) {
  const auto port =
      std::find_if(ports_.begin(), ports_.end(), [&](const Port& one) { return one.device == device; });
  const std::optional<PortId> opened = port->opened;
  ports_.erase(port);
  if (!opened) return;
  due_.push_back([this, id = *opened] {
    if (opened_[id].is_closed) return;
    const PortHandlers handlers = opened_[id].handlers;
    close(id);
    if (handlers.lost) handlers.lost("unplugged");
  });
}

std::string VirtualPorts::plug_in(Device device) {
  return paths_[device] = add_port(device, {});
}

// ---- the program's side -----------------------------------------------------------------------------

std::optional<std::string> VirtualPorts::path_behind(const std::string& name) const {
  const auto link = links_.find(name);
  const std::string& path = link == links_.end() ? name : link->second;
  const bool exists =
      std::any_of(ports_.begin(), ports_.end(), [&](const Port& port) { return port.path == path; });
  return exists ? std::optional(path) : std::nullopt;
}

std::string VirtualPorts::resolved(const std::string& name) const {
  const auto path = path_behind(name);
  if (!path) throw Error(ExitCode::device_missing, "there is no such port", name, "another one");
  return *path;
}

PortLoop::PortId VirtualPorts::open(const PortProfile& link, PortHandlers handlers, io::Refusal refusal) {
  Port& port = *port_at(resolved(link.port));
  if (port.is_held || port.opened)
    throw Error(ExitCode::no_permission,
                refusal == io::Refusal::brief ? "port is in use" : "port is in use by another program",
                port.path, "end it");
  opened_.push_back({.path = port.path, .baud = link.baud, .handlers = std::move(handlers)});
  port.opened = opened_.size() - 1;
  if (port.device) rig_.opened(*port.device, now_);
  return *port.opened;
}

void VirtualPorts::write(PortId id, std::span<const std::uint8_t> bytes) {
  const Port* port = port_of(id);
  if (port == nullptr || !port->device || (port->baud != 0 && port->baud != opened_[id].baud)) return;
  rig_.send(*port->device, bytes, now_);
  auto& written = written_[*port->device];
  written.insert(written.end(), bytes.begin(), bytes.end());
}

void VirtualPorts::keep_emergency_bytes(PortId id, std::span<const std::uint8_t> bytes) {
  if (last_words_to_ >= 0 && port_of(id) != nullptr) io::keep_emergency_bytes(last_words_to_, bytes);
}

void VirtualPorts::close(PortId id) {
  if (Port* port = port_of(id)) {
    if (port->device == Device::servo && last_words_to_ >= 0) io::forget_emergency_bytes(last_words_to_);
    port->opened.reset();
  }
  opened_.at(id).is_closed = true;
}

void VirtualPorts::every(HostDuration period, std::function<void(HostTime)> tick) {
  period_ = period;
  tick_ = std::move(tick);
  next_tick_ = now_ + period;
}

void VirtualPorts::on_signal(std::function<void(int signal)> handler) {
  signalled_ = std::move(handler);
  for (std::size_t i = 0; i < requests_to_stop.size(); ++i) {
    caught[i] = 0;
    std::signal(requests_to_stop[i], catch_signal);
  }
}

bool VirtualPorts::has_baud(const std::string& name) const {
  const auto path = path_behind(name);
  return !path || std::any_of(ports_.begin(), ports_.end(),
                              [&](const Port& port) { return port.path == *path && port.baud != 0; });
}

io::KnownPort VirtualPorts::know_port(const std::string& name) const {
  return {.name = name, .info = {.path = resolved(name)}};
}

std::optional<std::string> VirtualPorts::find_again(const io::KnownPort& port,
                                                    const std::vector<io::KnownPort>& others) const {
  if (port.name == port.info.path) return std::nullopt;
  return io::choose_again(port, {}, path_behind(port.name), others);
}

// ---- time ---------------------------------------------------------------------------------------------

/// A call at a time: what an exception or stop() leaves behind is called by the next run().
void VirtualPorts::run() {
  while (!std::exchange(is_stopped_, false)) {
    if (due_.empty()) pass_time();
    if (due_.empty()) continue;
    const std::function<void()> call = std::move(due_.front());
    due_.pop_front();
    call();
  }
}

void VirtualPorts::pass_time() {
  const bool stood_still = stands_still_ > HostDuration::zero();
  now_ += step + std::exchange(stands_still_, HostDuration::zero());
  for (Chunk& chunk : rig_.advance(now_))
    for (const Port& port : ports_)
      if (port.device == chunk.device)
        deliver(port, std::move(chunk.bytes), stood_still ? now_ : chunk.arrived);
  for (; next_words_ <= now_; next_words_ += words_period)
    for (const Port& port : ports_)
      if (port.speaker) deliver(port, port.speaker(), now_);
  take_signals();
  if (!tick_ || now_ < next_tick_) return;
  next_tick_ += ((now_ - next_tick_) / period_ + 1) * period_;
  due_.push_back([this] {
    const auto tick = tick_;  // the call may replace it
    tick(now_);
  });
}

void VirtualPorts::deliver(const Port& port, std::vector<std::uint8_t> bytes, HostTime arrived) {
  if (!port.opened) {
    if (port.device) bytes_unheard_[*port.device] += bytes.size();
    return;
  }
  if (bytes.empty() || (port.baud != 0 && port.baud != opened_[*port.opened].baud)) return;
  due_.push_back([this, id = *port.opened, device = port.device, bytes = std::move(bytes), arrived] {
    give(id, device, bytes, arrived);
  });
}

void VirtualPorts::give(PortId id, std::optional<Device> device, std::span<const std::uint8_t> bytes,
                        HostTime arrived) {
  if (opened_[id].is_closed) return;
  if (device) delivered_[*device].insert(delivered_[*device].end(), bytes.begin(), bytes.end());
  const PortHandlers handlers = opened_[id].handlers;
  handlers.received(bytes, arrived);
}

void VirtualPorts::let_pass(HostDuration time) {
  now_ += time;
  next_words_ = std::max(next_words_, now_);
  for (const Chunk& chunk : rig_.advance(now_)) bytes_unheard_[chunk.device] += chunk.bytes.size();
}

void VirtualPorts::take_signals() {
  if (!signalled_) return;
  for (std::size_t i = 0; i < requests_to_stop.size(); ++i) {
    if (caught[i] == 0) continue;
    caught[i] = 0;
    due_.push_back([this, signal = requests_to_stop[i]] { signalled_(signal); });
  }
}

}  // namespace thermorig::rig::test

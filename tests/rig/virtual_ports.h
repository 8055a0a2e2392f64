// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/rig/discovery/port_loop.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig::rig::test {

/// A simulated rig on three ports of a computer in virtual time, and the loop of the program that opens them.
/// The ports are pseudo terminals unless they have a baud rate. Signals are those of this process. What
/// io::Loop and the kernel do between the two is not shown here.
class VirtualPorts : public PortLoop {
 public:
  using Speaker = std::function<std::vector<std::uint8_t>()>;  // gives the bytes of each 20 ms

  explicit VirtualPorts(const simulation::VirtualRigConfig& config,
                        std::unique_ptr<simulation::Firmware> firmware = simulation::make_host_firmware());
  ~VirtualPorts() override;

  // What happens to the computer.
  const PerDevice<std::string>& paths() const { return paths_; }
  /// One more port, on which something speaks that hears nothing. Returns its path.
  std::string add(Speaker speaker);
  /// From now on a device's port is one with a wire: what it sends is understood at that rate alone.
  void set_baud(Device device, std::uint32_t baud);
  void unplug(Device device);
  /// The plug is put back: a port under another name, which is returned.
  std::string plug_in(Device device);
  void link(const std::string& name, const std::string& path) { links_[name] = path; }
  void remove_link(const std::string& name) { links_.erase(name); }
  /// Another program has the port open.
  void hold(const std::string& path);
  /// Nothing runs on this computer for so long; bytes that come meanwhile arrive behind it.
  void stand_still(HostDuration time) { stands_still_ = time; }
  /// The rig goes on without the program for so long.
  void let_pass(HostDuration time);
  /// Last words of a port go to this descriptor: this process is about to die.
  void say_last_words_to(int descriptor) { last_words_to_ = descriptor; }

  simulation::VirtualRig& rig() { return rig_; }
  /// Bytes of a device that no program had the port open for.
  std::uint64_t bytes_unheard(Device device) const { return bytes_unheard_[device]; }
  /// What the program was given of a device, in order.
  const std::vector<std::uint8_t>& delivered(Device device) const { return delivered_[device]; }
  /// What the program wrote to a device that was there.
  const std::vector<std::uint8_t>& written(Device device) const { return written_[device]; }

  HostTime now() const override { return now_; }
  PortId open(const PortProfile& link, PortHandlers handlers, io::Refusal refusal) override;
  void write(PortId port, std::span<const std::uint8_t> bytes) override;
  void keep_emergency_bytes(PortId port, std::span<const std::uint8_t> bytes) override;
  void close(PortId port) override;
  void every(HostDuration period, std::function<void(HostTime)> tick) override;
  void on_signal(std::function<void(int signal)> handler) override;
  void run() override;
  void stop() override { is_stopped_ = true; }
  bool has_baud(const std::string& port) const override;
  io::KnownPort know_port(const std::string& name) const override;
  std::optional<std::string> find_again(const io::KnownPort& port,
                                        const std::vector<io::KnownPort>& others) const override;

 private:
  struct Port {
    std::string path;
    std::optional<Device> device;
    Speaker speaker;
    std::uint32_t baud = 0;  // 0: a pseudo terminal
    bool is_held = false;    // by another program
    std::optional<PortId> opened;
  };
  struct Opened {
    std::string path;
    std::uint32_t baud = 0;
    PortHandlers handlers;
    bool is_closed = false;
  };

  std::string add_port(std::optional<Device> device, Speaker speaker);
  Port* port_at(const std::string& path);
  Port* port_of(PortId id);
  std::optional<std::string> path_behind(const std::string& name) const;
  std::string resolved(const std::string& name) const;
  void pass_time();
  void deliver(const Port& port, std::vector<std::uint8_t> bytes, HostTime arrived);
  void give(PortId id, std::optional<Device> device, std::span<const std::uint8_t> bytes, HostTime arrived);
  void take_signals();

  simulation::VirtualRig rig_;
  HostTime now_;
  HostDuration stands_still_{};
  HostTime next_words_;
  PerDevice<std::string> paths_;
  int next_number_ = 0;
  std::vector<Port> ports_;
  std::map<std::string, std::string> links_;
  std::vector<Opened> opened_;
  std::deque<std::function<void()>> due_;  // calls of handlers
  std::function<void(HostTime)> tick_;
  HostDuration period_{};
  HostTime next_tick_;
  std::function<void(int)> signalled_;
  bool is_stopped_ = false;
  int last_words_to_ = -1;
  PerDevice<std::vector<std::uint8_t>> delivered_, written_;
  PerDevice<std::uint64_t> bytes_unheard_{};
};

}  // namespace thermorig::rig::test

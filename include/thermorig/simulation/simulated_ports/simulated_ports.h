// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/simulation/firmware.h"
#include "thermorig/simulation/virtual_rig.h"

namespace thermorig {

enum class FirmwareChoice : std::uint8_t {
  avr_image,   // the real image in simavr; the host build where that is not installed
  host_build,  // the same sources compiled for this machine
};

std::unique_ptr<simulation::Firmware> make_firmware(FirmwareChoice choice);

/// The image of the servo's firmware (Intel HEX) that came with this program; nothing where there is none.
std::optional<std::filesystem::path> servo_firmware_image();

/// What became of the bytes of one simulated port.
/// Sent by the device: bytes_delivered + bytes_unheard + bytes_overrun, and up to 48 KiB that still wait.
struct PortTally {
  std::uint64_t bytes_delivered = 0;  // written to the port while a program had it open
  std::uint64_t bytes_unheard = 0;    // no program had the port open, or it was unplugged
  std::uint64_t bytes_overrun = 0;    // a program had it open but did not read: no room
  std::uint64_t bytes_delayed = 0;  // the terminal had no room, they waited: the program, or the kernel, late
  std::uint64_t bytes_received = 0;  // written by the program to the device
};

/// How well the wall clock was kept, and what it cost.
struct ServingTally {
  PerDevice<PortTally> ports;
  std::uint64_t chunks = 0;   // delivered, all devices
  double mean_lag_s = 0.0;    // from a chunk's arrival in the rig's time to its write
  double worst_lag_s = 0.0;   // the same, largest
  double thread_cpu_s = 0.0;  // of the serving thread; a simulated micro-controller's process not counted
  double elapsed_s = 0.0;     // since start()
};

/// The simulated rig on three pseudo terminals, on the wall clock, which any program can open as it opens
/// real ports. Served by a thread of its own; rig time is host time (io::now()), so a pause is caught up
/// with. DTR is not modelled: opening a port resets nothing.
class SimulatedPorts {
 public:
  /// `config.start` is ignored: the rig is switched on by start().
  SimulatedPorts(const simulation::VirtualRigConfig& config, FirmwareChoice choice);
  SimulatedPorts(const simulation::VirtualRigConfig& config, std::unique_ptr<simulation::Firmware> firmware);
  ~SimulatedPorts();
  SimulatedPorts(const SimulatedPorts&) = delete;
  SimulatedPorts& operator=(const SimulatedPorts&) = delete;

  const PerDevice<std::string>& paths() const;
  /// "AVR image" or "host build".
  const std::string& firmware_description() const;

  /// Keeps what rig() and delivered() give, for tests; memory grows with time. Before start().
  void keep_truth();

  /// Switches the rig on, once.
  void start();
  /// Ends the serving thread. Throws Error(failed) if it ended by itself (the micro-controller's process
  /// died); the ports were unplugged then.
  void stop();

  /// Pulls the plug: a program that has the port open loses it, the path is gone.
  void unplug(Device device);

  /// Puts the plug back that was pulled: a pseudo terminal under another name, which is returned.
  std::string plug_in(Device device);

  /// May be called at any time, from any thread.
  ServingTally tally() const;

  /// After stop(): what the rig did in truth, in host time.
  const simulation::VirtualRig& rig() const;
  /// After stop(): the bytes that were delivered to programs, in order.
  const std::vector<std::uint8_t>& delivered(Device device) const;

 private:
  struct Server;
  std::unique_ptr<Server> server_;
};

}  // namespace thermorig

// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <chrono>
#include <memory>
#include <utility>

#include "heard.h"
#include "simulation/simulated_ports/rig_server.h"

namespace thermorig {

/// A port in memory: what waits between program and device, and who has it open.
struct Line {
  std::size_t room = 16 * 1024;  // toward the program, bytes
  bool is_open = false;          // by the program
  bool is_plugged = true;
  Bytes to_program, to_device;
};

/// The device's side of a line.
class LineEnd final : public io::DeviceSide {
 public:
  explicit LineEnd(std::shared_ptr<Line> line) : line_(std::move(line)) {}
  ~LineEnd() override { line_->is_plugged = false; }

  int fd() const override { return -1; }
  bool is_open() override { return line_->is_open; }
  std::size_t write(std::span<const std::uint8_t> bytes) override {
    if (!is_open()) return 0;
    const auto taken = bytes.first(std::min(bytes.size(), line_->room - line_->to_program.size()));
    line_->to_program.insert(line_->to_program.end(), taken.begin(), taken.end());
    return taken.size();
  }
  Bytes read() override { return std::exchange(line_->to_device, {}); }

 private:
  std::shared_ptr<Line> line_;
};

/// The simulated rig on three ports in memory, in virtual time, and a program that reads those which it has
/// open a thousand times a second.
class VirtualPorts {
 public:
  explicit VirtualPorts(std::unique_ptr<simulation::Firmware> firmware = simulation::make_host_firmware())
      : server_(rig_config(), std::move(firmware), new_ends(), [this] { return now_; }) {
    server_.keep_truth();
    server_.switch_on();
  }

  RigServer& server() { return server_; }
  Line& line(Device device) { return *lines_[device]; }
  const Heard& heard() const { return heard_; }

  void open_all() {
    for (const Device device : all_devices) line(device).is_open = true;
  }

  /// What nobody has read is gone with the last program that had the port open.
  void close(Device device) {
    line(device).is_open = false;
    line(device).to_program.clear();
  }

  void plug_in(Device device) {
    lines_[device] = std::make_shared<Line>();
    server_.plug_in(device, std::make_unique<LineEnd>(lines_[device]));
  }

  void write(Device device, const Bytes& command) {
    Bytes& waiting = line(device).to_device;
    waiting.insert(waiting.end(), command.begin(), command.end());
  }

  /// The program leaves what it is sent where it is.
  void stop_reading(Device device) { reads_[device] = false; }
  void read_again(Device device) { reads_[device] = true; }

  /// Time goes on, and nobody serves the ports.
  void stand_still(std::chrono::milliseconds time) { now_ += time; }

  void let_pass(std::chrono::milliseconds time) {
    for (; time.count() > 0; --time) {
      now_ += std::chrono::milliseconds(1);
      server_.serve();
      read();
    }
  }

 private:
  PerDevice<std::unique_ptr<io::DeviceSide>> new_ends() {
    PerDevice<std::unique_ptr<io::DeviceSide>> ends;
    for (const Device device : all_devices) {
      lines_[device] = std::make_shared<Line>();
      ends[device] = std::make_unique<LineEnd>(lines_[device]);
    }
    return ends;
  }

  void read() {
    for (const Device device : all_devices)
      if (reads_[device]) heard_.take(device, std::exchange(line(device).to_program, {}));
  }

  HostTime now_{std::chrono::seconds(1000)};
  PerDevice<std::shared_ptr<Line>> lines_;
  PerDevice<bool> reads_{{true, true, true}};
  Heard heard_;
  RigServer server_;
};

}  // namespace thermorig

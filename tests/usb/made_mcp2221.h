// SPDX-License-Identifier: MIT
#pragma once

#include <fcntl.h>
#include <linux/uhid.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <cstdio>
#include <mutex>
#include <thread>

#include "../i2c/fake_bus.h"
#include "thermorig/io/port.h"

namespace thermorig {

/// A made-up Microchip MCP2221A whose reports the kernel's own driver (hid-mcp2221) writes and reads, and an
/// MLX90640 on its bus. Source: the data sheet of the MCP2221A (DS20005565), section 3.1.
class MadeMcp2221 {
 public:
  explicit MadeMcp2221(test::FakeBus::Measure measure)
      : bus_(std::move(measure)), uhid_(::open("/dev/uhid", O_RDWR | O_CLOEXEC)) {
    bus_.bus_hz = 1e12;  // the driver's own time is enough
    bus_.now = io::now();
    bus_.next_measurement = bus_.now;
    uhid_event create{};
    create.type = UHID_CREATE2;
    // 64 bytes in, 64 bytes out, of the vendor's own page.
    constexpr std::array<std::uint8_t, 34> description{
        0x06, 0x00, 0xFF, 0x09, 0x01, 0xA1, 0x01, 0x09, 0x01, 0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08, 0x95,
        0x40, 0x81, 0x02, 0x09, 0x01, 0x15, 0x00, 0x26, 0xFF, 0x00, 0x75, 0x08, 0x95, 0x40, 0x91, 0x02, 0xC0};
    std::copy(description.begin(), description.end(), create.u.create2.rd_data);
    create.u.create2.rd_size = description.size();
    std::snprintf(reinterpret_cast<char*>(create.u.create2.name), sizeof create.u.create2.name, "MCP2221");
    create.u.create2.bus = 3;  // USB
    create.u.create2.vendor = 0x04D8;
    create.u.create2.product = 0x00DD;
    std::thread([this] { serve(); }).detach();  // it is waited for by a read that only the kernel ends
    is_made_ = ::write(uhid_, &create, sizeof create) == sizeof create;
  }

  bool is_made() const { return is_made_; }
  void move_sensor_to(std::uint8_t address) {
    const std::lock_guard lock(mutex_);
    bus_.address = address;
  }
  /// The kernel waits in it until nobody has the bus open.
  void unplug() {
    std::thread([this] {
      uhid_event destroy{};
      destroy.type = UHID_DESTROY;
      if (::write(uhid_, &destroy, sizeof destroy) < 0) std::perror("uhid");
    }).detach();
  }

 private:
  using Report = std::array<std::uint8_t, 64>;

  void serve() {
    uhid_event event{};
    while (::read(uhid_, &event, sizeof event) > 0) {
      if (event.type != UHID_OUTPUT) continue;
      Report asked{};
      std::copy_n(event.u.output.data, asked.size(), asked.begin());
      const Report answer = answer_to(asked);
      uhid_event input{};
      input.type = UHID_INPUT2;
      input.u.input2.size = answer.size();
      std::copy(answer.begin(), answer.end(), input.u.input2.data);
      if (::write(uhid_, &input, sizeof input) < 0) return;
    }
  }

  Report answer_to(const Report& asked) {
    const std::lock_guard lock(mutex_);
    if (io::now() > bus_.now) bus_.pass(io::now() - bus_.now);
    constexpr std::uint8_t status = 0x10, write = 0x90, read = 0x91, read_again = 0x93, write_on = 0x94,
                           fetch = 0x40;
    constexpr std::uint8_t not_acknowledged = 0x25, complete = 0x55;
    const std::size_t length = asked[1] | asked[2] << 8U;
    const auto device = static_cast<std::uint8_t>(asked[3] >> 1U);
    Report answer{asked[0]};
    const auto refuse = [&] {
      answer[1] = 1;
      answer[2] = not_acknowledged;
    };
    switch (asked[0]) {
      case status:
        answer[3] = asked[3];
        break;
      case write_on:
      case write: {
        written_.assign(asked.begin() + 4, asked.begin() + 4 + static_cast<std::ptrdiff_t>(length));
        if (asked[0] == write_on ? device != bus_.address : bus_.transfer(device, written_, {}) != 0)
          refuse();
        break;
      }
      case read:
      case read_again: {
        fetched_.assign(length, 0);
        fetched_at_ = 0;
        if (asked[0] == read) written_.clear();
        if (bus_.transfer(device, written_, fetched_) != 0) refuse();
        break;
      }
      case fetch: {
        const std::size_t piece = std::min<std::size_t>(60, fetched_.size() - fetched_at_);
        answer[2] = complete;
        answer[3] = static_cast<std::uint8_t>(piece);
        std::copy_n(fetched_.begin() + static_cast<std::ptrdiff_t>(fetched_at_), piece, answer.begin() + 4);
        fetched_at_ += piece;
        break;
      }
      default:
        break;
    }
    return answer;
  }

  test::FakeBus bus_;
  int uhid_;
  bool is_made_ = false;
  std::mutex mutex_;
  std::vector<std::uint8_t> written_, fetched_;
  std::size_t fetched_at_ = 0;
};

}  // namespace thermorig

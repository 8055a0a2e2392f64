// SPDX-License-Identifier: MIT
#include "boot_loader.h"

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <pty.h>
#include <signal.h>
#include <termios.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <utility>

namespace thermorig::rig::test {

namespace {

constexpr std::size_t flash_size = 32 * 1024, line_size = 16;
constexpr int answered_pages = 10;  // of a board that stops then
// Of Atmel's application note AVR061.
constexpr std::uint8_t in_sync = 0x14, ok = 0x10;

}  // namespace

BootLoader::BootLoader(int baud, BootFault fault, std::function<void(int)> on_page)
    : baud_(baud), fault_(fault), on_page_(std::move(on_page)), flash_(flash_size, 0xFF) {
  std::array<char, 64> name{};
  termios settings{};
  cfmakeraw(&settings);
  int theirs = -1;
  EXPECT_EQ(openpty(&ours_, &theirs, name.data(), &settings, nullptr), 0);
  close(theirs);
  path_ = name.data();
  sigset_t all, before;
  sigfillset(&all);
  pthread_sigmask(SIG_SETMASK, &all, &before);  // signals are for whoever flashes
  thread_ = std::thread([this] {
    try {
      serve();
    } catch (const Unplugged&) {
    }
  });
  pthread_sigmask(SIG_SETMASK, &before, nullptr);
}

BootLoader::~BootLoader() {
  is_over_ = true;
  thread_.join();
  close(ours_);
}

void BootLoader::serve() {
  constexpr int look_again_ms = 20;
  while (true) {
    const auto command = next(look_again_ms);
    if (!command || fault_ == BootFault::silent) continue;
    try {
      if (is_at_its_speed())
        answer(*command);
      else
        send({0xF0});
    } catch (const Restarted&) {
    }
  }
}

void BootLoader::answer(std::uint8_t command) {
  const auto reply = [this](int arguments, std::vector<std::uint8_t> words = {}) {
    rest(arguments);
    words.insert(words.begin(), in_sync);
    words.push_back(ok);
    send(std::move(words));
  };
  switch (command) {
    case 0x30:
      return reply(1);  // are you there?
    case 0x41:
      return reply(2, {3});  // a parameter
    case 0x42:
      return reply(21);  // which device it takes it for
    case 0x45:
      return reply(6);  // more of that
    case 0x50:
      return reply(1);  // programming begins
    case 0x56:
      return reply(5, {0});  // bytes for the chip's own programming port: optiboot has none
    case 0x75:
      return fault_ == BootFault::other_chip ? reply(1, {0x1E, 0x98, 0x01}) : reply(1, {0x1E, 0x95, 0x0F});
    case 0x51:
      reply(1);
      has_left_ = true;
      return;
    case 0x55: {  // address in words
      const auto bytes = rest(2);
      address_ = 2U * (bytes[0] | bytes[1] << 8U);
      return reply(1);
    }
    case 0x64: {  // write a page
      const auto head = rest(3);
      const auto page = rest(head[0] << 8U | head[1]);
      ASSERT_LE(address_ + page.size(), flash_.size());
      std::copy(page.begin(), page.end(), flash_.begin() + static_cast<std::ptrdiff_t>(address_));
      ++pages_;
      if (on_page_) on_page_(pages_);
      if (fault_ == BootFault::stops_answering && pages_ >= answered_pages) fault_ = BootFault::silent;
      if (fault_ != BootFault::silent) reply(1);
      return;
    }
    case 0x74: {  // read a page
      const auto head = rest(3);
      const auto begin = flash_.begin() + static_cast<std::ptrdiff_t>(address_);
      return reply(1, {begin, begin + (head[0] << 8 | head[1])});
    }
    default:
      ADD_FAILURE() << "avrdude sent command " << int(command);
  }
}

std::optional<std::uint8_t> BootLoader::next(int patience_ms) {
  if (is_over_) throw Unplugged();
  pollfd port{ours_, POLLIN, 0};
  std::uint8_t byte = 0;
  if (poll(&port, 1, patience_ms) == 1 && read(ours_, &byte, 1) == 1) return byte;
  if ((port.revents & POLLHUP) != 0) usleep(1000);  // nobody has it open
  return std::nullopt;
}

std::vector<std::uint8_t> BootLoader::rest(int count) {
  constexpr int watchdog_ms = 1000;
  std::vector<std::uint8_t> bytes;
  while (count-- > 0) {
    const auto byte = next(watchdog_ms);
    if (!byte) throw Restarted();
    bytes.push_back(*byte);
  }
  return bytes;
}

void BootLoader::send(std::vector<std::uint8_t> bytes) const {
  [[maybe_unused]] const ssize_t heard = write(ours_, bytes.data(), bytes.size());
}

bool BootLoader::is_at_its_speed() const {
  termios settings{};
  tcgetattr(ours_, &settings);  // those of the other end
  return cfgetospeed(&settings) == (baud_ == 115200 ? B115200 : baud_ == 57600 ? B57600 : B9600);
}

std::string BootLoader::hex() const {
  std::string text;
  for (std::size_t begin = 0; begin < flash_.size(); begin += line_size) {
    std::uint8_t sum = 0;
    std::string line;
    const auto add = [&](std::size_t value) {
      sum = static_cast<std::uint8_t>(sum + value);
      line += fmt::format("{:02X}", static_cast<std::uint8_t>(value));
    };
    for (const std::size_t value : {line_size, begin >> 8U, begin & 0xFFU, std::size_t{0}}) add(value);
    for (std::size_t i = begin; i < begin + line_size; ++i) add(flash_[i]);
    add(0x100U - sum);
    text += ":" + line + "\n";
  }
  return text + ":00000001FF\n";
}

}  // namespace thermorig::rig::test

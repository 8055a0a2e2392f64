// SPDX-License-Identifier: MIT
#include <gmock/gmock.h>
#include <poll.h>
#include <signal.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>
#include <set>
#include <stdexcept>
#include <thread>

#include "one_loop.h"
#include "thermorig/io/host.h"

namespace thermorig::io {
namespace {

TEST(Loop, DeliversChunksInOrderWhateverTheirSizes) {
  Wire device;
  Loop loop;
  Collected collected;
  loop.attach(device.plug(), collected.handlers());
  const Bytes sent = numbered_bytes(40'000);
  std::size_t offset = 0;
  std::size_t size = 1;
  run_until(loop, [&] {
    const std::size_t length = std::min(size, sent.size() - offset);
    offset += device.write(std::span(sent).subspan(offset, length));
    size = size * 7 % 5003;
    return collected.bytes.size() == sent.size();
  });
  EXPECT_EQ(collected.bytes, sent);
  EXPECT_TRUE(std::is_sorted(collected.times.begin(), collected.times.end()));
}

TEST(Loop, StampsAChunkBetweenItsWritingAndItsHandling) {
  Wire device;
  Loop loop;
  HostTime arrived{};
  HostTime handled{};
  loop.attach(device.plug(), {[&](std::span<const std::uint8_t>, HostTime time) {
                                arrived = time;
                                handled = now();
                                loop.stop();
                              },
                              {}});
  const HostTime written = now();
  device.write(Bytes{1, 2, 3});
  loop.run();
  EXPECT_LE(written, arrived);
  EXPECT_LE(arrived, handled);
}

/// Writes everything, waiting where the terminal has no room, as a device with flow control would.
void write_all(Pty& device, std::span<const std::uint8_t> bytes) {
  while (!bytes.empty()) {
    pollfd room{.fd = device.fd(), .events = POLLOUT, .revents = 0};
    poll(&room, 1, 100);
    bytes = bytes.subspan(device.write(bytes));
  }
}

TEST(Loop, LosesNothingOfABurstWhileTheHandlerIsSlow) {
  Pty device;
  Loop loop;
  const Bytes sent = numbered_bytes(500'000);
  Bytes received;
  loop.open(port_at(device.path()), {[&](std::span<const std::uint8_t> chunk, HostTime) {
                                       received.insert(received.end(), chunk.begin(), chunk.end());
                                       std::this_thread::sleep_for(std::chrono::microseconds(500));
                                       if (received.size() >= sent.size()) loop.stop();
                                     },
                                     {}});
  std::thread writer([&] { write_all(device, sent); });
  loop.run();
  writer.join();
  EXPECT_EQ(received, sent);
}

/// What the kernel calls what is open: "/dev/pts/3", "socket:[4711]", "anon_inode:[timerfd]".
std::string what_is_open_as(const std::string& fd) {
  std::error_code closed_since;
  return std::filesystem::read_symlink("/proc/self/fd/" + fd, closed_since);
}

/// What each epoll set of this process waits for.
std::vector<std::multiset<std::string>> epoll_sets() {
  std::vector<std::multiset<std::string>> sets;
  for (const auto& entry : std::filesystem::directory_iterator("/proc/self/fdinfo")) {
    std::ifstream info(entry.path());
    std::multiset<std::string> members;
    for (std::string key, fd; info >> key;) {
      if (key != "tfd:" || !(info >> fd)) continue;
      members.insert(what_is_open_as(fd));
    }
    if (!members.empty()) sets.push_back(members);
  }
  return sets;
}

// A poll of an empty terminal waits for the kernel's workers, with every other port and the servo's stop.
TEST(Loop, DoesNotItselfAskAPortWhetherItIsReady) {
  Wire gyro, camera;
  files::Descriptor gyro_port = gyro.plug(), camera_port = camera.plug();
  const std::string gyro_name = what_is_open_as(std::to_string(gyro_port.get()));
  const std::string camera_name = what_is_open_as(std::to_string(camera_port.get()));
  Loop loop;
  Collected collected;
  loop.attach(std::move(gyro_port), collected.handlers());
  const auto full = loop.attach(std::move(camera_port), collected.handlers());
  loop.write(full, numbered_bytes(100'000));  // more than it takes: nor does it ask whether there is room
  gyro.write(Bytes{1});
  camera.write(Bytes{2});
  run_until(loop, [&] { return collected.bytes.size() == 2; });
  std::vector<std::multiset<std::string>> with_a_port;
  for (const auto& set : epoll_sets())
    if (set.count(gyro_name) + set.count(camera_name) > 0) with_a_port.push_back(set);
  const auto watched = [](const std::string& port) {
    return std::multiset<std::string>{port, "anon_inode:[eventfd]"};
  };
  EXPECT_THAT(with_a_port, testing::UnorderedElementsAre(watched(gyro_name), watched(camera_name)));
}

TEST(Loop, GivesEveryPortAndTheTimerTheirTurnWhileOneSendsWithoutEnd) {
  Wire busy, quiet;
  Loop loop;
  std::size_t chunks = 0, heard_at = 0;
  bool was_sent = false, is_over = false;
  loop.attach(busy.plug(), {[&](std::span<const std::uint8_t> bytes, HostTime) {
                              ++chunks;
                              busy.write(bytes);  // there is always more to read
                            },
                            {}});
  loop.attach(quiet.plug(), {[&](std::span<const std::uint8_t>, HostTime) { heard_at = chunks; }, {}});
  busy.write(numbered_bytes(1000));
  int ticks = 0;
  loop.every(tick_period, [&](HostTime) {
    if (++ticks >= 3 && chunks > 0 && !was_sent) was_sent = quiet.write(Bytes{1}) == 1;
    is_over = heard_at > 0;
    if (is_over || ticks > patience_ticks) loop.stop();
  });
  loop.run();
  EXPECT_TRUE(is_over);
}

TEST(Loop, WritesInOrderEvenMoreThanTheSystemTakesAtOnce) {
  Wire device;
  Loop loop;
  Collected collected;
  const auto port = loop.attach(device.plug(), collected.handlers());
  const Bytes sent = numbered_bytes(100'000);
  for (std::size_t begin = 0; begin < sent.size(); begin += 1000)
    loop.write(port, std::span(sent).subspan(begin, 1000));
  Bytes received = device.read();
  EXPECT_LT(received.size(), sent.size()) << "the system takes all of it at once";
  run_until(loop, [&] {
    const Bytes some = device.read();
    received.insert(received.end(), some.begin(), some.end());
    return received.size() == sent.size();
  });
  EXPECT_EQ(received, sent);
}

TEST(Loop, ThrowsAwayWhatCameBeforeThePortWasOpened) {
  Pty device;
  {
    Loop earlier;
    Collected ignored;
    earlier.open(port_at(device.path()), ignored.handlers());
    device.write(Bytes{'o', 'l', 'd'});
  }
  Loop loop;
  Collected collected;
  loop.open(port_at(device.path()), collected.handlers());
  device.write(Bytes{'n', 'e', 'w'});
  run_until(loop, [&] { return collected.bytes.size() >= 3; });
  EXPECT_EQ(collected.bytes, (Bytes{'n', 'e', 'w'}));
}

TEST(Loop, ReportsAnUnpluggedPortOnceAndGoesOnWithTheOthers) {
  Pty unplugged;
  Pty staying;
  Loop loop;
  Collected first;
  Collected second;
  const auto port = loop.open(port_at(unplugged.path()), first.handlers());
  loop.open(port_at(staying.path()), second.handlers());
  unplugged.write(Bytes{7});
  run_until(loop, [&] { return first.bytes.size() == 1; });
  unplugged.unplug();
  run_until(loop, [&] { return !first.losses.empty(); });
  loop.write(port, Bytes{1, 2, 3});
  staying.write(Bytes{8, 9});
  run_until(loop, [&] { return second.bytes.size() == 2; });
  run_ticks(loop, 20);
  EXPECT_EQ(first.losses.size(), 1U);
  EXPECT_TRUE(second.losses.empty());
}

TEST(Loop, ReadsAllThatCameBeforeAnEndAndReportsItOnce) {
  Wire device;
  Loop loop;
  Collected collected;
  loop.attach(device.plug(), collected.handlers());
  const Bytes sent = numbered_bytes(40'000);
  const std::size_t written = device.write(sent);
  device.unplug();
  run_until(loop, [&] { return !collected.losses.empty(); });
  run_ticks(loop, 10);
  EXPECT_EQ(collected.bytes, Bytes(sent.begin(), sent.begin() + static_cast<std::ptrdiff_t>(written)));
  EXPECT_THAT(collected.losses, testing::ElementsAre("unplugged"));
}

TEST(Loop, DoesNotSpinOnAnUnpluggedPort) {
  Pty device;
  Loop loop;
  Collected collected;
  loop.open(port_at(device.path()), collected.handlers());
  device.unplug();
  run_until(loop, [&] { return !collected.losses.empty(); });
  const double cpu_before_s = thread_cpu_s();
  const HostTime begin = now();
  run_ticks(loop, 200);
  EXPECT_LT(thread_cpu_s() - cpu_before_s, 0.5 * to_s(now() - begin));
}

TEST(Loop, MayCloseAPortFromItsOwnHandler) {
  Wire device;
  Loop loop;
  int calls = 0;
  Loop::PortId port = 0;
  port = loop.attach(device.plug(), {[&](std::span<const std::uint8_t>, HostTime) {
                                       ++calls;
                                       loop.close(port);
                                     },
                                     [&](const std::string&) { ADD_FAILURE() << "closed, not lost"; }});
  device.write(Bytes{1});
  run_until(loop, [&] { return calls > 0; });
  EXPECT_FALSE(device.is_open());
  EXPECT_EQ(device.write(Bytes{2}), 0U);
  run_ticks(loop, 10);
  EXPECT_EQ(calls, 1);
}

TEST(Loop, MayOpenAPortAgainAfterItWasClosed) {
  Pty device;
  Loop loop;
  Collected first;
  Collected second;
  const auto port = loop.open(port_at(device.path()), first.handlers());
  run_ticks(loop, 2);
  loop.close(port);
  loop.open(port_at(device.path()), second.handlers());
  device.write(Bytes{5});
  run_until(loop, [&] { return !second.bytes.empty(); });
  EXPECT_TRUE(first.bytes.empty());
  EXPECT_TRUE(first.losses.empty());
}

TEST(Loop, LetsAnExceptionOfAHandlerOutOfRun) {
  Wire device;
  Loop loop;
  loop.attach(device.plug(),
              {[](std::span<const std::uint8_t>, HostTime) { throw std::runtime_error("disk full"); }, {}});
  device.write(Bytes{1});
  EXPECT_THROW(loop.run(), std::runtime_error);
  run_ticks(loop, 2);
}

TEST(Loop, CanBeDestroyedWhilePortsAreOpenAndBytesWait) {
  Wire device;
  auto loop = std::make_unique<Loop>();
  Collected collected;
  const auto port = loop->attach(device.plug(), collected.handlers());
  loop->every(tick_period, [](HostTime) { ADD_FAILURE() << "the loop does not run"; });
  loop->on_signal([](int) {});
  loop->write(port, numbered_bytes(100'000));
  device.write(Bytes{1});
  loop.reset();
  EXPECT_TRUE(collected.bytes.empty());
  EXPECT_TRUE(collected.losses.empty());
  EXPECT_FALSE(device.is_open());
}

TEST(Loop, TicksUntilTheTickIsReplaced) {
  Loop loop;
  int first = 0;
  int second = 0;
  loop.every(tick_period, [&](HostTime) {
    if (++first < 3) return;
    loop.every(tick_period, [&](HostTime) {
      if (++second == 3) loop.stop();
    });
  });
  loop.run();
  EXPECT_EQ(first, 3);
  EXPECT_EQ(second, 3);
}

TEST(Loop, TicksNeverBeforeTheirPeriodHasPassed) {
  Loop loop;
  const HostTime begin = now();
  std::vector<HostTime> times;
  loop.every(tick_period, [&](HostTime time) {
    times.push_back(time);
    if (times.size() == 5) loop.stop();
  });
  loop.run();
  for (std::size_t i = 0; i < times.size(); ++i) EXPECT_GE(times[i] - begin, tick_period * (i + 1));
}

TEST(Loop, HandsSignalsToItsHandlerInsteadOfEnding) {
  Loop loop;
  std::vector<int> signals;
  loop.on_signal([&](int signal) { signals.push_back(signal); });
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGINT}) {
    const std::size_t before = signals.size();
    ASSERT_EQ(kill(getpid(), signal), 0);
    run_until(loop, [&] { return signals.size() > before; });
  }
  EXPECT_THAT(signals, testing::ElementsAre(SIGINT, SIGTERM, SIGHUP, SIGINT));
}

TEST(Loop, LeavesSignalsAsTheyWereWhenItIsGone) {
  {
    Loop loop;
    loop.on_signal([](int) {});
  }
  struct sigaction action {};
  sigaction(SIGTERM, nullptr, &action);
  EXPECT_EQ(action.sa_handler, SIG_DFL);
}

}  // namespace
}  // namespace thermorig::io

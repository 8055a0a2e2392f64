// SPDX-License-Identifier: MIT
#include "avr_firmware.h"

#include <signal.h>
#include <spawn.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <filesystem>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/simulation/simulated_ports/lock_step.h"

extern char** environ;

namespace thermorig {
namespace {

namespace fs = std::filesystem;
using namespace lock_step;

struct Paths {
  fs::path program;
  fs::path image;
};

/// Where they may be, the first place first.
std::vector<Paths> places() {
  const auto in = [](const fs::path& libexec, const fs::path& data) -> Paths {
    return {libexec / "thermorig-avr", data / "servo_firmware.hex"};
  };
  if (const char* set = std::getenv("THERMORIG_LIBEXEC")) return {in(set, set)};
  std::error_code error;
  const fs::path beside = fs::read_symlink("/proc/self/exe", error).parent_path();
  return {in(beside, beside), in(beside / THERMORIG_LIBEXEC_FROM_BIN, beside / THERMORIG_DATA_FROM_BIN)};
}

std::optional<Paths> find_paths() {
  std::error_code error;
  for (const Paths& paths : places())
    if (fs::is_regular_file(paths.program, error) && fs::is_regular_file(paths.image, error)) return paths;
  return std::nullopt;
}

[[noreturn]] void throw_dead(const std::string& why) {
  throw Error(ExitCode::failed, "the simulated micro-controller stopped: " + why, "thermorig-avr",
              "run the program again; if it happens again, rebuild it");
}

std::string system_text(int error_number) {
  return std::generic_category().message(error_number);
}

/// The other process: bytes to and from it. Of a process group of its own, so that a Ctrl-C on the terminal
/// does not end it before its rig is at rest.
class Child {
 public:
  explicit Child(const Paths& paths) {
    int ends[2];
    if (socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, ends) != 0) throw_dead(system_text(errno));
    socket_ = ends[0];
    const int failure = spawn(paths, ends[1]);
    close(ends[1]);
    if (failure == 0) return;
    close(socket_);
    throw_dead(system_text(failure));
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;
  ~Child() {
    close(socket_);
    kill(process_, SIGKILL);
    while (waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
    }
  }

  void write(const void* data, std::size_t size) {
    const auto* at = static_cast<const char*>(data);
    while (size > 0) {
      const ssize_t done = ::send(socket_, at, size, MSG_NOSIGNAL);
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) throw_dead(system_text(errno));
      at += done;
      size -= static_cast<std::size_t>(done);
    }
  }

  void read(void* data, std::size_t size) {
    auto* at = static_cast<char*>(data);
    while (size > 0) {
      const ssize_t done = ::recv(socket_, at, size, 0);
      if (done < 0 && errno == EINTR) continue;
      if (done < 0) throw_dead(system_text(errno));
      if (done == 0) throw_dead("it closed its connection");
      at += done;
      size -= static_cast<std::size_t>(done);
    }
  }

 private:
  int spawn(const Paths& paths, int child_end) {
    posix_spawn_file_actions_t actions;
    posix_spawnattr_t attributes;
    posix_spawn_file_actions_init(&actions);
    posix_spawnattr_init(&attributes);
    posix_spawn_file_actions_adddup2(&actions, child_end, STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions, child_end, STDOUT_FILENO);
    posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETPGROUP);
    std::string program = paths.program.string(), image = paths.image.string();
    char* arguments[] = {program.data(), image.data(), nullptr};
    const int failure = posix_spawn(&process_, program.c_str(), &actions, &attributes, arguments, environ);
    posix_spawnattr_destroy(&attributes);
    posix_spawn_file_actions_destroy(&actions);
    return failure;
  }

  int socket_ = -1;
  pid_t process_ = -1;
};

template <class Item>
std::vector<Item> read_items(Child& child, std::uint64_t count) {
  std::vector<Item> items(count);
  child.read(items.data(), count * sizeof(Item));
  return items;
}

class AvrFirmware final : public simulation::Firmware {
 public:
  explicit AvrFirmware(const Paths& paths) : child_(paths) {}

  void receive(std::uint8_t byte, std::int64_t time_us) override { waiting_.push_back({time_us, byte}); }

  void sense(const simulation::SensorRegisters& registers) override {
    sensor_ = {.is_there = 1,
               .bus = static_cast<std::uint8_t>(registers.bus),
               .status = registers.status,
               .gain = registers.gain,
               .raw = registers.raw};
  }

  simulation::FirmwareOutput run_until(std::int64_t time_us) override {
    const RunRequest request{time_us, waiting_.size(), sensor_};
    child_.write(&request, sizeof request);
    child_.write(waiting_.data(), waiting_.size() * sizeof(TimedByte));
    waiting_.clear();
    return read_output();
  }

  std::string description() const override { return "AVR image"; }

 private:
  simulation::FirmwareOutput read_output() {
    simulation::FirmwareOutput output;
    RunReply head;
    child_.read(&head, sizeof head);
    for (const TimedByte& byte : read_items<TimedByte>(child_, head.bytes))
      output.bytes.push_back({byte.time_us, static_cast<std::uint8_t>(byte.value)});
    for (const TimedPulse& pulse : read_items<TimedPulse>(child_, head.pulses))
      output.pulses.push_back({pulse.rise_us, pulse.width_us});
    for (const RegisterByte& write : read_items<RegisterByte>(child_, head.writes))
      output.writes.push_back({write.address, write.value});
    return output;
  }

  Child child_;
  std::vector<TimedByte> waiting_;
  Sensor sensor_;
};

}  // namespace

std::optional<fs::path> servo_firmware_image() {
  std::error_code error;
  for (const Paths& paths : places())
    if (fs::is_regular_file(paths.image, error)) return paths.image.lexically_normal();
  return std::nullopt;
}

std::unique_ptr<simulation::Firmware> make_avr_firmware() {
  const std::optional<Paths> paths = find_paths();
  return paths ? std::make_unique<AvrFirmware>(*paths) : nullptr;
}

}  // namespace thermorig

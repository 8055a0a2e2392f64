// SPDX-License-Identifier: MIT
#include "thermorig/rig/port_recording.h"

#include <fmt/format.h>

#include <csignal>
#include <utility>

#include "thermorig/io/port.h"
#include "thermorig/wire/servo_messages.h"

namespace thermorig::rig {

namespace {

constexpr auto tick_period = std::chrono::milliseconds(10);
constexpr auto last_words = std::chrono::milliseconds(50);  // for the stop byte to leave after a failure

/// The recording with its three ports on one loop.
class PortSession {
 public:
  explicit PortSession(const PortOptions& options);
  RecordingResult run();

 private:
  io::Loop::PortId open(Device device);
  void open_ports();
  void tick(HostTime now);
  void signalled();
  void notice(const std::string& sentence) {
    if (options_.notice) options_.notice(sentence);
  }
  void run_loop();
  RecordingResult leave_journal();

  const PortOptions& options_;
  io::Loop loop_;
  std::optional<Recording> recording_;
  PerDevice<std::optional<io::Loop::PortId>> ports_;  // none: it is not there, and not needed
  std::vector<std::pair<Device, Error>> missing_;
  HostTime next_progress_{};
  int signals_ = 0;
};

PortSession::PortSession(const PortOptions& options) : options_(options) {
  // Ports first: nothing is created on the disk for a rig that is not there.
  open_ports();
  recording_.emplace(options.recording, io::now(), [this](std::span<const std::uint8_t> bytes) {
    loop_.write(*ports_[Device::servo], bytes);
  });
  for (const auto& [device, error] : missing_) recording_->missing(device, error, io::now());
}

void PortSession::open_ports() {
  for (const Device device : all_devices) {
    const bool needed = device == Device::servo || options_.recording.needed[device];
    if (!needed && options_.recording.profile.link(device).port.empty()) {
      missing_.emplace_back(
          device, Error(ExitCode::device_missing, "no port is named for it", std::string(name_of(device)),
                        fmt::format("--{} PORT, or a rig profile that names it", name_of(device))));
      continue;
    }
    try {
      ports_[device] = open(device);
    } catch (const Error& error) {
      if (needed || error.code() != ExitCode::device_missing) throw;
      missing_.emplace_back(device, error);
    }
  }
}

io::Loop::PortId PortSession::open(Device device) {
  io::Loop::PortHandlers handlers;
  handlers.received = [this, device](std::span<const std::uint8_t> bytes, HostTime arrived) {
    recording_->received(device, bytes, arrived);
  };
  handlers.lost = [this, device](const std::string& why) { recording_->lost(device, why, io::now()); };
  return loop_.open(options_.recording.profile.link(device), std::move(handlers));
}

void PortSession::tick(HostTime now) {
  if (options_.orders)
    for (const Order& order : options_.orders()) recording_->carry_out(order, now);
  recording_->tick(now);
  if (options_.progress && now >= next_progress_) {
    options_.progress(recording_->progress(now));
    next_progress_ = now + options_.progress_period;
  }
  if (recording_->done()) loop_.stop();
}

void PortSession::signalled() {
  if (++signals_ == 1) {
    notice(options_.recording.keep
               ? "stopping the servo, then closing the file (Ctrl-C again leaves it for `thermorig recover`)"
               : "stopping the servo");
    recording_->request_stop(io::now());
  }
}

void PortSession::run_loop() {
  loop_.on_signal([this](int) { signalled(); });
  loop_.every(tick_period, [this](HostTime now) { tick(now); });
  try {
    loop_.run();
  } catch (...) {  // e.g. the disk is full: the servo must not run on until its watchdog notices
    loop_.write(*ports_[Device::servo], wire::stop_bytes());
    loop_.every(last_words, [this](HostTime) { loop_.stop(); });
    loop_.run();
    throw;
  }
}

RecordingResult PortSession::leave_journal() {
  RecordingResult result;
  const HostTime now = io::now();
  result.duration_s = recording_->progress(now).elapsed_s;
  const SessionFile file = recording_->close(now);
  result.exit = ExitCode::interrupted;
  result.message = "stopped twice";
  result.state = session::State::partial;
  if (!recording_->keeps()) return result;
  result.message += "; the recording was left as a journal";
  result.advice = "thermorig recover " + file.journal.string();
  result.acquisition = file.acquisition;
  result.journal = file.journal;
  return result;
}

RecordingResult PortSession::run() {
  run_loop();
  if (options_.progress) options_.progress(recording_->progress(io::now()));
  for (const Device device : all_devices)
    if (ports_[device]) loop_.close(*ports_[device]);
  if (signals_ > 1) return leave_journal();
  return conclude(*recording_, io::now());
}

}  // namespace

RecordingResult record_ports(const PortOptions& options) {
  return PortSession(options).run();
}

}  // namespace thermorig::rig

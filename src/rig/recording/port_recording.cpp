// SPDX-License-Identifier: MIT
#include "thermorig/rig/recording/port_recording.h"

#include <fmt/format.h>

#include <csignal>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "thermorig/core/device.h"
#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"
#include "thermorig/core/time.h"
#include "thermorig/io/emergency_bytes.h"
#include "thermorig/rig/discovery/port_loop.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::rig {

namespace {

/// Looks for the ports of devices that went, now and then.
class PortSearch {
 public:
  explicit PortSearch(const PortLoop& loop) : loop_(loop) {}

  static constexpr auto period = std::chrono::milliseconds(500);
  static constexpr auto long_period = std::chrono::seconds(10);  // once it was refused for good

  /// The port was open under that name: by what it is now, it will be found again.
  void opened(Device device, const std::string& name);

  /// It was found again, at `path`, and is open.
  void reopened(Device device, const std::string& path);

  /// The port was never there: its name is all that is known of it.
  void missing(Device device, const std::string& name);

  /// Where the device's port is now; none: it is not there, or it was looked for just now.
  std::optional<std::string> look(Device device, HostTime now);

  /// The port is there, but did not open. True once, when that has lasted: rules for a new device file, and
  /// programs that look at every new port, take some seconds.
  bool is_hopeless(Device device, const Error& error, HostTime now);

 private:
  struct Sought {
    std::optional<io::KnownPort> port;  // none: it has no name
    std::optional<HostTime> last_look;
    std::optional<HostTime> refused_since;
    bool is_hopeless = false;
  };
  static void forgive(Sought& sought);

  const PortLoop& loop_;
  PerDevice<Sought> sought_;
};

constexpr auto longest_refusal = std::chrono::seconds(10);

void PortSearch::opened(Device device, const std::string& name) {
  sought_[device] = Sought{.port = loop_.know_port(name)};
  sought_[device].port->open_path = sought_[device].port->info.path;
}

void PortSearch::reopened(Device device, const std::string& path) {
  sought_[device].port->open_path = path;
}

void PortSearch::missing(Device device, const std::string& name) {
  sought_[device] = Sought{.port = io::KnownPort{.name = name, .info = {}}};
}

std::optional<std::string> PortSearch::look(Device device, HostTime now) {
  Sought& sought = sought_[device];
  if (!sought.port) return std::nullopt;
  sought.port->open_path.clear();
  const HostDuration wait = sought.is_hopeless ? HostDuration(long_period) : HostDuration(period);
  if (sought.last_look && now - *sought.last_look < wait) return std::nullopt;
  sought.last_look = now;
  std::vector<io::KnownPort> others;
  for (const Device other : all_devices)
    if (other != device && sought_[other].port) others.push_back(*sought_[other].port);
  auto found = loop_.find_again(*sought.port, others);
  if (!found) forgive(sought);
  return found;
}

void PortSearch::forgive(Sought& sought) {
  sought.refused_since.reset();
  sought.is_hopeless = false;
}

bool PortSearch::is_hopeless(Device device, const Error& error, HostTime now) {
  Sought& sought = sought_[device];
  if (error.code() != ExitCode::no_permission) {
    forgive(sought);
    return false;
  }
  if (!sought.refused_since) sought.refused_since = now;
  return now - *sought.refused_since >= longest_refusal && !std::exchange(sought.is_hopeless, true);
}

constexpr auto tick_period = std::chrono::milliseconds(10);
constexpr auto emergency_wait = std::chrono::milliseconds(50);  // for the stop byte to leave after a failure
constexpr int tries_of_emergency_bytes = 1000;

/// The recording with its three ports on the loop.
class PortSession {
 public:
  PortSession(const PortOptions& options, PortLoop& loop);
  RecordingResult run();

 private:
  PortLoop::PortId open(Device device);
  PortLoop::PortId open(Device device, const PortProfile& link, io::Refusal refusal);
  void open_ports();
  void look_for_ports(HostTime now);
  void reopen(Device device, const PortProfile& link, io::Refusal refusal);
  void refuse(Device device, const PortProfile& link, HostTime now);
  void tick(HostTime now);
  std::vector<std::uint8_t> emergency_bytes() const {
    return sensors::servo_protocol(options_.recording.profile.servo.protocol).emergency_bytes();
  }
  void signalled();
  void notice(const std::string& sentence) {
    if (options_.notice) options_.notice(sentence);
  }
  void run_loop();
  RecordingResult leave_journal();

  const PortOptions& options_;
  PortLoop& loop_;
  std::optional<Recording> recording_;
  PerDevice<std::optional<PortLoop::PortId>> ports_;  // none: it is not there, and not needed
  std::vector<std::pair<Device, Error>> missing_;
  PortSearch search_;
  HostTime next_progress_{};
  int signals_ = 0;
};

PortSession::PortSession(const PortOptions& options, PortLoop& loop)
    : options_(options), loop_(loop), search_(loop) {
  // Ports first: nothing is created on the disk for a rig that is not there.
  open_ports();
  recording_.emplace(options.recording, loop_.now(), [this](Device to, std::span<const std::uint8_t> bytes) {
    if (ports_[to]) loop_.write(*ports_[to], bytes);
  });
  for (const auto& [device, error] : missing_) recording_->missing(device, error, loop_.now());
}

void PortSession::open_ports() {
  for (const Device device : all_devices) {
    if (!options_.recording.profile.has(device)) continue;
    const bool needed = device == Device::servo || options_.recording.needed[device];
    if (!needed && options_.recording.profile.link(device).port.empty()) {
      missing_.emplace_back(
          device, Error(ExitCode::device_missing, "no port is given for it", std::string(name_of(device)),
                        fmt::format("--{} PORT, or a rig profile that names it", name_of(device))));
      continue;
    }
    try {
      ports_[device] = open(device);
    } catch (const Error& error) {
      if (needed || error.code() != ExitCode::device_missing) throw;
      missing_.emplace_back(device, error);
      search_.missing(device, options_.recording.profile.link(device).port);
    }
  }
}

PortLoop::PortId PortSession::open(Device device) {
  const PortProfile& link = options_.recording.profile.link(device);
  const PortLoop::PortId port = open(device, link, io::Refusal::names_holder);
  search_.opened(device, link.port);
  return port;
}

PortLoop::PortId PortSession::open(Device device, const PortProfile& link, io::Refusal refusal) {
  PortLoop::PortHandlers handlers;
  handlers.received = [this, device](std::span<const std::uint8_t> bytes, HostTime arrived) {
    recording_->received(device, bytes, arrived);
  };
  handlers.lost = [this, device](const std::string& why) { recording_->lost(device, why, loop_.now()); };
  const PortLoop::PortId port = loop_.open(link, std::move(handlers), refusal);
  if (device == Device::servo) loop_.keep_emergency_bytes(port, emergency_bytes());
  return port;
}

void PortSession::look_for_ports(HostTime now) {
  for (const Device device : recording_->lost_ports()) {
    const auto found = search_.look(device, now);
    if (!found) continue;
    PortProfile link = options_.recording.profile.link(device);
    link.port = *found;
    try {
      reopen(device, link, io::Refusal::brief);
    } catch (const Error& error) {
      if (search_.is_hopeless(device, error, now)) refuse(device, link, now);
    }
  }
}

void PortSession::reopen(Device device, const PortProfile& link, io::Refusal refusal) {
  ports_[device] = open(device, link, refusal);
  search_.reopened(device, link.port);
  recording_->returned(device, loop_.now());
}

/// Once more, to say who holds it; that takes a while, so it is not asked at each try.
void PortSession::refuse(Device device, const PortProfile& link, HostTime now) {
  try {
    reopen(device, link, io::Refusal::names_holder);
  } catch (const Error& error) {
    recording_->refused(device, error, now);
  }
}

void PortSession::tick(HostTime now) {
  if (options_.orders)
    for (const Order& order : options_.orders()) recording_->carry_out(order, now);
  recording_->tick(now);
  look_for_ports(now);
  if (options_.progress && now >= next_progress_) {
    options_.progress(recording_->progress(now));
    next_progress_ = now + options_.progress_period;
  }
  if (recording_->done()) loop_.stop();
}

void PortSession::signalled() {
  if (++signals_ == 1) {
    std::string stopping = options_.recording.profile.servo.is_there() ? "stopping the servo" : "stopping";
    if (options_.recording.keep)
      stopping += ", then closing the file (Ctrl-C again leaves it for `thermorig recover`)";
    notice(stopping);
    recording_->request_stop(loop_.now());
  }
}

void PortSession::run_loop() {
  loop_.on_signal([this](int) { signalled(); });
  loop_.every(tick_period, [this](HostTime now) { tick(now); });
  try {
    loop_.run();
  } catch (...) {                // e.g. the disk is full: the servo must not run on by itself
    io::send_emergency_bytes();  // at once: there may be no memory left for more
    if (ports_[Device::servo]) loop_.write(*ports_[Device::servo], emergency_bytes());
    bool is_over = false;
    loop_.every(emergency_wait, [&](HostTime) {
      is_over = true;
      loop_.stop();
    });
    for (int tries = 0; !is_over && tries < tries_of_emergency_bytes; ++tries) {
      try {
        loop_.run();
      } catch (const std::exception&) {  // of a journal that takes no more: the first one counts
      }
    }
    throw;
  }
}

RecordingResult PortSession::leave_journal() {
  RecordingResult result;
  const HostTime now = loop_.now();
  result.duration_s = recording_->progress(now).elapsed_s;
  const SessionFile file = recording_->close(now);
  result.exit = ExitCode::interrupted;
  result.message = "stopped twice";
  result.state = session::State::partial;
  if (!options_.recording.keep) return result;
  result.message += "; the recording was left as a journal";
  result.advice = "thermorig recover " + shell_word(file.journal.string());
  result.acquisition = file.acquisition;
  result.journal = file.journal;
  return result;
}

RecordingResult PortSession::run() {
  run_loop();
  if (options_.progress) options_.progress(recording_->progress(loop_.now()));
  for (const Device device : all_devices)
    if (ports_[device]) loop_.close(*ports_[device]);
  if (signals_ > 1) return leave_journal();
  if (signals_ > 0)  // what was said of another Ctrl-C holds while the session is made, too
    for (const int signal : {SIGINT, SIGTERM, SIGHUP}) std::signal(signal, SIG_DFL);
  return conclude(*recording_, loop_.now());
}

}  // namespace

RecordingResult record_ports(const PortOptions& options) {
  SystemPortLoop loop;
  return record_ports(options, loop);
}

RecordingResult record_ports(const PortOptions& options, PortLoop& loop) {
  return PortSession(options, loop).run();
}

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <tuple>
#include <utility>
#include <variant>

#include "commands.h"
#include "found_ports.h"
#include "live/live_tui.h"
#include "print/output.h"
#include "print/terminal_width.h"
#include "thermorig/rig/discovery/detect.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::app {

namespace {

constexpr auto drawn_every = std::chrono::milliseconds(500);
constexpr int lines_every = 2;  // of those, where nothing is drawn over

/// One device that is looked at: its bytes in, what it sends now out.
class LookedAt {
 public:
  virtual ~LookedAt() = default;
  /// How many messages these bytes complete.
  virtual std::size_t push(std::span<const std::uint8_t> bytes, HostTime arrived) = 0;
  /// One line for a person, of what came within `span_s` since the last call of next().
  virtual std::string line(double span_s) const = 0;
  virtual nlohmann::json json(double span_s) const = 0;
  /// What is drawn above the line, on a terminal with colours.
  virtual std::string picture() const { return ""; }
  virtual void next() = 0;
  virtual std::uint64_t damaged() const = 0;
};

std::uint64_t damaged_messages(const wire::Counters& counters) {
  return counters.bad_checksum + counters.bad_length + counters.bad_value;
}

class LookedAtCamera : public LookedAt {
 public:
  explicit LookedAtCamera(const CameraProfile& profile)
      : mirrored_(profile.mirrored), scanner_(sensors::camera_scanner(profile)) {}

  std::size_t push(std::span<const std::uint8_t> bytes, HostTime) override {
    scanner_.push(bytes, messages_);
    for (const wire::CameraMessage& message : messages_) last_ = message;
    const std::size_t came = std::exchange(messages_, {}).size();
    count_ += came;
    return came;
  }
  std::string line(double span_s) const override {
    if (!last_) return "no frame yet";
    const auto [low, high] = range();
    std::string text = fmt::format("{:.2f} frames/s  {:.1f} to {:.1f} degC", rate_hz(span_s), low, high);
    if (std::isfinite(last_->frame.sensor_temp_c))
      text += fmt::format("  sensor {:.1f} degC", last_->frame.sensor_temp_c);
    return text + (last_->fresh.both_fresh()  ? "  both halves new"
                   : last_->fresh.one_fresh() ? "  one half new"
                                              : "");
  }
  nlohmann::json json(double span_s) const override {
    nlohmann::json object{{"rate_hz", rate_hz(span_s)}, {"low_c", nullptr}, {"high_c", nullptr}};
    if (last_) std::tie(object["low_c"], object["high_c"]) = range();
    return object;
  }
  std::string picture() const override {
    return last_ ? half_blocks(last_->frame, mirrored_, terminal_colours()) : "";
  }
  void next() override { count_ = 0; }
  std::uint64_t damaged() const override { return damaged_messages(scanner_.counters()); }

 private:
  double rate_hz(double span_s) const { return static_cast<double>(count_) / span_s; }
  std::pair<float, float> range() const {
    const auto [low, high] = std::minmax_element(last_->frame.temp_c.begin(), last_->frame.temp_c.end());
    return {*low, *high};
  }

  bool mirrored_;
  sensors::CameraScanner scanner_;
  std::vector<wire::CameraMessage> messages_;
  std::optional<wire::CameraMessage> last_;
  std::size_t count_ = 0;
};

/// Its rates, and how far it has turned about each axis: a quarter turn by hand shows which axis it is, which
/// way it counts, and whether the unit is right.
class LookedAtGyro : public LookedAt {
 public:
  LookedAtGyro(const GyroProfile& profile, bool has_unit)
      : has_unit_(has_unit), scanner_(sensors::gyro_scanner(profile)) {}

  std::size_t push(std::span<const std::uint8_t> bytes, HostTime arrived) override {
    scanner_.push(bytes, messages_);
    if (messages_.empty()) return 0;
    std::array<double, 3> sums{};
    for (const wire::GyroMessage& message : messages_)
      for (std::size_t axis = 0; axis < 3; ++axis) sums[axis] += double{message.reading.rate_dps[axis]};
    const double since_s = last_ ? to_s(arrived - *last_) : 0.0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      sums_[axis] += sums[axis];
      turned_deg_[axis] += sums[axis] / static_cast<double>(messages_.size()) * since_s;
    }
    count_ += messages_.size();
    last_ = arrived;
    return std::exchange(messages_, {}).size();
  }
  std::string line(double span_s) const override {
    if (count_ == 0) return "no sample";
    std::string text = fmt::format("{:.1f} samples/s ", static_cast<double>(count_) / span_s);
    for (std::size_t axis = 0; axis < 3; ++axis)
      text += fmt::format(" {} {:+.2f}", "xyz"[axis], rate_dps(axis));
    text += has_unit_ ? " deg/s  turned" : " of an unknown unit  turned";
    for (const double turned_deg : turned_deg_) text += fmt::format(" {:+.1f}", turned_deg);
    return text + (has_unit_ ? " deg" : "");
  }
  nlohmann::json json(double span_s) const override {
    nlohmann::json object{{"rate_hz", static_cast<double>(count_) / span_s}, {"unit_is_known", has_unit_}};
    for (std::size_t axis = 0; axis < 3; ++axis) {
      object["rate_dps"].push_back(count_ == 0 ? nlohmann::json() : nlohmann::json(rate_dps(axis)));
      object["turned_deg"].push_back(turned_deg_[axis]);
    }
    return object;
  }
  void next() override {
    count_ = 0;
    sums_ = {};
  }
  std::uint64_t damaged() const override { return damaged_messages(scanner_.counters()); }

 private:
  double rate_dps(std::size_t axis) const { return sums_[axis] / static_cast<double>(count_); }

  bool has_unit_;
  sensors::GyroScanner scanner_;
  std::vector<wire::GyroMessage> messages_;
  std::array<double, 3> sums_{}, turned_deg_{};
  std::size_t count_ = 0;
  std::optional<HostTime> last_;
};

/// Its firmware and what it does; it is told nothing but hello, and nothing moves.
class LookedAtServo : public LookedAt {
 public:
  LookedAtServo(std::string_view protocol, const ServoProfile& profile)
      : protocol_(sensors::servo_protocol(protocol)), scanner_(protocol_.scanner(profile)) {}

  std::size_t push(std::span<const std::uint8_t> bytes, HostTime) override {
    scanner_.push(bytes, messages_);
    for (const wire::ServoMessage& message : messages_) {
      if (const auto* welcome = std::get_if<wire::ServoWelcome>(&message.body)) firmware_ = welcome->firmware;
      if (const auto* state = std::get_if<ServoState>(&message.body)) state_ = *state;
      count_ += std::holds_alternative<ServoState>(message.body) ? 1U : 0U;
    }
    return std::exchange(messages_, {}).size();
  }
  std::string line(double span_s) const override {
    std::string text = firmware_.empty() ? fmt::format("no answer to {} yet", protocol_.greeted_as)
                                         : "firmware " + firmware_;
    if (state_)
      text += fmt::format("  {:.0f} messages/s  {}  {:+.1f} deg  {:+.1f} deg/s",
                          static_cast<double>(count_) / span_s, is_at_rest(*state_) ? "at rest" : "moving",
                          state_->angle_deg, state_->rate_dps);
    return text;
  }
  nlohmann::json json(double span_s) const override {
    return {{"firmware", firmware_},
            {"rate_hz", static_cast<double>(count_) / span_s},
            {"angle_deg", state_ ? nlohmann::json(state_->angle_deg) : nlohmann::json()},
            {"rate_dps", state_ ? nlohmann::json(state_->rate_dps) : nlohmann::json()}};
  }
  void next() override { count_ = 0; }
  std::uint64_t damaged() const override { return damaged_messages(scanner_.counters()); }

 private:
  const sensors::ServoProtocol& protocol_;
  sensors::ServoScanner scanner_;
  std::vector<wire::ServoMessage> messages_;
  std::string firmware_;
  std::optional<ServoState> state_;
  std::size_t count_ = 0;
};

/// The profile of what was found, as far as it is needed to read it.
RigProfile profile_of(const rig::PortFinding& finding) {
  RigProfile profile;
  PortProfile& link = profile.link(*finding.role);
  link.port = finding.info.path;
  link.baud = finding.baud;
  if (finding.role == Device::camera) profile.camera.protocol = finding.protocol;
  if (finding.role == Device::gyro) {
    profile.gyro.protocol = finding.protocol;
    profile.gyro.settings = finding.settings;
    if (finding.text_format) profile.gyro.text = finding.text_format->columns;
    if (finding.text_format && !finding.text_format->scale_known) profile.gyro.text.scale_dps = 1.0;
  }
  return profile;
}

std::unique_ptr<LookedAt> look_at(const rig::PortFinding& finding, const RigProfile& profile) {
  if (finding.role == Device::camera) return std::make_unique<LookedAtCamera>(profile.camera);
  if (finding.role == Device::servo) return std::make_unique<LookedAtServo>(finding.protocol, profile.servo);
  return std::make_unique<LookedAtGyro>(profile.gyro,
                                        !finding.text_format || finding.text_format->scale_known);
}

/// The one device to look at. Throws Error(device_missing) if there is none, or if it cannot be read, with
/// what to try; bad_usage if several could be meant.
rig::PortFinding one_of_them(const std::vector<rig::PortFinding>& findings) {
  std::vector<const rig::PortFinding*> found;
  for (const rig::PortFinding& finding : findings)
    if (finding.role) found.push_back(&finding);
  if (found.size() == 1) return *found[0];
  if (found.size() > 1) {
    std::string ports;
    for (const rig::PortFinding* finding : found)
      ports +=
          fmt::format("{}{} ({})", ports.empty() ? "" : ", ", finding->info.path, name_of(*finding->role));
    throw Error(ExitCode::bad_usage, "several devices can be looked at", ports,
                "thermorig look " + found[0]->info.path);
  }
  const auto heard = std::find_if(findings.begin(), findings.end(),
                                  [](const rig::PortFinding& finding) { return finding.problem.empty(); });
  const rig::PortFinding& first = heard == findings.end() ? findings.front() : *heard;
  throw Error(first.code == ExitCode::ok ? ExitCode::device_missing : first.code, first.how, first.info.path,
              first.advice.empty() ? "check power and cable; thermorig doctor" : first.advice);
}

/// Draws or prints what a device sends until the user, or the time, ends it.
class Look {
 public:
  Look(const LookOptions& options, const rig::PortFinding& finding)
      : options_(options),
        finding_(finding),
        profile_(profile_of(finding)),
        device_(look_at(finding, profile_)),
        draws_(!options.json && escapes_allowed(stdout)) {}

  ExitCode run() {
    rig::SystemPortLoop loop;
    const std::vector<std::uint8_t> ask_for_next = sensors::next_request(*finding_.role, profile_);
    std::optional<rig::PortLoop::PortId> port;
    rig::PortLoop::PortHandlers handlers;
    handlers.received = [&](std::span<const std::uint8_t> bytes, HostTime arrived) {
      const std::size_t came = device_->push(bytes, arrived);
      for (std::size_t i = 0; i < came && !ask_for_next.empty(); ++i) loop.write(*port, ask_for_next);
    };
    handlers.lost = [&](const std::string& why) {
      lost_ = why;
      loop.stop();
    };
    port = loop.open(profile_.link(*finding_.role), std::move(handlers), io::Refusal::names_holder);
    for (const auto& command : requests()) loop.write(*port, command);
    loop.on_signal([&](int) { loop.stop(); });
    const HostTime begin = loop.now();
    last_ = begin;
    loop.every(drawn_every, [&](HostTime now) {
      tick(now);
      if (options_.seconds > 0.0 && to_s(now - begin) >= options_.seconds) loop.stop();
    });
    loop.run();
    loop.close(*port);
    if (!lost_.empty())
      throw Error(ExitCode::device_lost, lost_, finding_.info.path,
                  "check power and cable; thermorig doctor");
    return ExitCode::ok;
  }

 private:
  sensors::Commands requests() const {
    if (finding_.role == Device::servo) return {sensors::servo_protocol(finding_.protocol).greeting()};
    return sensors::stream_request(*finding_.role, profile_, 0);
  }

  void tick(HostTime now) {
    if (!draws_ && ++ticks_ % lines_every != 0) return;
    const double span_s = to_s(now - *last_);
    if (options_.json) {
      nlohmann::json object = device_->json(span_s);
      object["event"] = "look";
      object["device"] = name_of(*finding_.role);
      object["damaged"] = device_->damaged();
      print_json(object);
    } else {
      std::string text = draws_ ? device_->picture() : "";
      std::string line = device_->line(span_s);
      if (device_->damaged() > 0) line += fmt::format("  {} damaged", count_text(device_->damaged()));
      text += line.substr(0, draws_ ? terminal_width() - 1 : line.npos) + "\n";
      print("{}{}", draws_ ? erasing(drawn_) : "", text);
      drawn_ = static_cast<std::size_t>(std::count(text.begin(), text.end(), '\n'));
      flush_output();
    }
    require_printed();
    device_->next();
    last_ = now;
  }

  LookOptions options_;
  rig::PortFinding finding_;
  RigProfile profile_;
  std::unique_ptr<LookedAt> device_;
  bool draws_;
  int ticks_ = 0;
  std::size_t drawn_ = 0;
  std::optional<HostTime> last_;
  std::string lost_;
};

}  // namespace

ExitCode run(const LookOptions& options) {
  const std::vector<io::PortInfo> ports =
      ports_to_hear(options.port.empty() ? std::vector<std::string>() : std::vector{options.port});
  if (ports.empty())
    throw Error(ExitCode::device_missing, "this computer has no serial port", "",
                "plug the device in; without hardware: thermorig simulate, then name its ports");
  if (!options.json) {
    print("listening to {} port{} for up to 6 s ...\n", ports.size(), ports.size() == 1 ? "" : "s");
    flush_output();
  }
  const rig::PortFinding finding = one_of_them(rig::identify_devices(ports));
  if (!options.json) {
    print("{}  {}{}: {}\n", name_of(*finding.role), printable(finding.info.path),
          finding.baud == 0 ? "" : fmt::format(" at {} baud", finding.baud), printable(finding.how));
    if (finding.text_format && !finding.is_known())
      print("note   {}\n", printable(sensors::open_question(*finding.text_format)));
    print("Ctrl-C ends it.\n");
  }
  return Look(options, finding).run();
}

}  // namespace thermorig::app

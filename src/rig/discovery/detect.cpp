// SPDX-License-Identifier: MIT
#include "thermorig/rig/discovery/detect.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"
#include "thermorig/sensors/hand_turn.h"
#include "thermorig/sensors/servo_protocol.h"

namespace thermorig::rig {

namespace {

constexpr double share_needed = 0.3;   // a short look begins and ends in the middle of a message
constexpr double share_of_text = 0.5;  // of the time of a search: sketches print a sample or two a second
constexpr auto listening_tick = std::chrono::milliseconds(20);
constexpr auto greeting_period = std::chrono::milliseconds(200);

constexpr double listened_share = 0.35;  // of a step, before a port that is silent is greeted

/// A pty has no baud rate, nor has a bus: it is listened to once, and greeted once in each way.
std::vector<sensors::SearchStep> steps_without_baud() {
  constexpr double listen_share = 0.2, greet_share = 0.3;
  std::vector<sensors::SearchStep> steps;
  for (sensors::SearchStep& step : sensors::search_steps()) {
    const auto is_same = [&](const auto& other) { return other.greeting == step.greeting; };
    if (!steps.empty() && (step.greeting.empty() || std::any_of(steps.begin(), steps.end(), is_same)))
      continue;
    step.at.share = step.greeting.empty() ? listen_share : greet_share;
    steps.push_back(std::move(step));
  }
  return steps;
}

/// Listens on one port, step by step.
class Listener {
 public:
  Listener(PortLoop& loop, const io::PortInfo& info, double listen_s)
      : loop_(loop),
        has_baud_(loop.has_baud(info.path)),
        steps_(has_baud_ ? sensors::search_steps() : steps_without_baud()),
        listen_s_(listen_s) {
    finding_.info = info;
    finding_.how = fmt::format("silent at {} baud rates", steps_.size());
  }

  bool done() const { return step_ == steps_.size(); }
  const PortFinding& finding() const { return finding_; }

  void tick(HostTime now) {
    if (done()) return;
    if (!port_) return open(now);
    const sensors::SearchStep& step = steps_[step_];
    const double share = to_s(now - opened_) / listen_s_ / step.at.share;
    if (is_to_be_greeted(step, share) && now - last_greeting_ >= greeting_period) {
      loop_.write(*port_, step.greeting);
      last_greeting_ = now;
    }
    const double wanted =
        sensors::is_readable(bytes_) ? std::max(step.at.share, share_of_text) : step.at.share;
    if (to_s(now - opened_) >= wanted * listen_s_) judge(now);
  }

 private:
  bool is_to_be_greeted(const sensors::SearchStep& step, double share) const {
    return !step.greeting.empty() && (!step.only_if_silent || (bytes_.empty() && share >= listened_share));
  }

  void open(HostTime now) {
    bytes_.clear();
    opened_ = now;
    PortLoop::PortHandlers handlers;
    handlers.received = [this](std::span<const std::uint8_t> bytes, HostTime arrived) {
      if (bytes_.empty()) {
        first_arrival_ = arrived;
        first_chunk_bytes_ = bytes.size();
      }
      last_arrival_ = arrived;
      bytes_.insert(bytes_.end(), bytes.begin(), bytes.end());
    };
    handlers.lost = [this](const std::string& why) { give_up(why); };
    try {
      port_ = loop_.open({.port = finding_.info.path, .baud = steps_[step_].at.baud}, std::move(handlers),
                         step_ == 0 ? io::Refusal::names_holder : io::Refusal::brief);
    } catch (const Error& error) {
      finding_.code = error.code();
      give_up(error.what_happened());
    }
  }

  void give_up(const std::string& why) {
    finding_.problem = why;
    finding_.how = why;
    step_ = steps_.size();
  }

  void judge(HostTime now) {
    loop_.close(*port_);
    port_.reset();
    Evidence evidence = classify(bytes_, to_s(now - opened_));
    const bool is_named = evidence.explained_share > 0.0;
    if (!is_named && evidence.found.advice.empty())  // a guess, which is shown if no other rate gives more
      if (auto guess = sensors::recognise_unread(bytes_)) evidence.found = *std::move(guess);
    const bool is_text = sensors::is_readable(bytes_);
    if (!bytes_.empty() && (is_named || finding_.advice.empty() || (is_text && !heard_text_))) {
      heard_text_ |= is_text;
      finding_.how = evidence.found.text;
      finding_.advice = evidence.found.advice;
    }
    ++step_;
    if (!is_named) return;
    finding_.role = evidence.role;
    finding_.baud = has_baud_ ? steps_[step_ - 1].at.baud : 0;
    finding_.protocol = evidence.protocol;
    finding_.text_format = evidence.found.text_format;
    if (!evidence.found.is_asked_otherwise) finding_.settings = evidence.found.settings;
    finding_.rate_hz = rate_hz(evidence.found, now);
    step_ = steps_.size();
  }

  /// While it spoke: a board that was reset by the opening boots for a second. By the bytes, as the first
  /// chunk may have waited in the system, and what is cut at either end is no message.
  double rate_hz(const sensors::Evidence& found, HostTime now) const {
    const auto heard = static_cast<double>(found.messages);
    const double spoke_s = to_s(last_arrival_ - first_arrival_);
    if (found.messages == 0 || spoke_s <= 0.0) return heard / to_s(now - opened_);
    const double bytes_a_message = static_cast<double>(found.bytes) / heard;
    return static_cast<double>(bytes_.size() - first_chunk_bytes_) / bytes_a_message / spoke_s;
  }

  PortLoop& loop_;
  bool has_baud_;
  std::vector<sensors::SearchStep> steps_;
  double listen_s_;
  PortFinding finding_;
  std::size_t step_ = 0;
  std::optional<PortLoop::PortId> port_;
  std::vector<std::uint8_t> bytes_;
  bool heard_text_ = false;  // that was not named; it is worth more than a guess at another baud rate
  HostTime opened_{}, first_arrival_{}, last_arrival_{};
  std::size_t first_chunk_bytes_ = 0;
  HostTime last_greeting_{};
};

/// A rate that is as near to the profile's as a short look can tell is the profile's.
constexpr double same_rate = 0.03;

/// Three digits, as a look of a second tells.
double rounded_hz(double rate_hz) {
  const double unit = std::pow(10.0, std::floor(std::log10(rate_hz)) - 2.0);
  return std::round(rate_hz / unit) * unit;
}

void apply_gyro(const PortFinding& finding, GyroProfile& gyro) {
  const sensors::GyroProtocol& protocol = sensors::gyro_protocol(finding.protocol);
  if (gyro.protocol != finding.protocol) {
    const double rate_hz = gyro.output_rate_hz;
    sensors::choose_gyro(finding.protocol, gyro);
    gyro.output_rate_hz = rate_hz;
    gyro.settings = finding.settings;
    if (finding.text_format) {
      gyro.sketch = finding.text_format->sketch;
      if (const sensors::GyroSketch* sketch = sensors::find_gyro_sketch(gyro.sketch))
        gyro.model = sketch->title;
      gyro.text = finding.text_format->columns;
    }
  }
  if (finding.axis) gyro.axis = *finding.axis;
  const bool is_other = std::abs(finding.rate_hz / gyro.output_rate_hz - 1.0) > same_rate;
  if (!protocol.is_told_rate && finding.rate_hz >= 1.0 && is_other)
    gyro.output_rate_hz = rounded_hz(finding.rate_hz);
}

void apply_servo(const PortFinding& finding, ServoProfile& servo) {
  sensors::choose_servo(finding.protocol, servo);
  if (const auto id = finding.settings.find("bus_id"); id != finding.settings.end())
    servo.bus_id = static_cast<int>(id->second);
}

/// "A and B", "A, B and C".
std::string listed(const std::vector<const PortFinding*>& findings) {
  std::string text;
  for (const PortFinding* finding : findings) {
    if (!text.empty()) text += finding == findings.back() ? " and " : ", ";
    text += finding->info.path;
  }
  return text;
}

/// What nothing recognises. Readable bytes came at the right baud rate.
sensors::Evidence unknown_bytes(std::span<const std::uint8_t> bytes) {
  if (bytes.empty()) return {.text = "silent"};
  const auto line = sensors::first_text_line(bytes);
  if (!line || !sensors::is_readable(bytes))
    return {.text = fmt::format("{} bytes that no known device sends", bytes.size())};
  return {.text = fmt::format("text without samples, such as \"{}\"", line->text.substr(0, 60)),
          .advice = "its baud rate is right, as it can be read: it needs another sketch or setting"};
}

/// Throws Error(interrupted) where a signal ends it.
void run_until_stopped(PortLoop& loop) {
  bool is_interrupted = false;
  loop.on_signal([&](int) {
    is_interrupted = true;
    loop.stop();
  });
  loop.run();
  if (is_interrupted)
    throw Error(ExitCode::interrupted, "stopped while it listened: nothing was written", "ports", "");
}

}  // namespace

Evidence classify(std::span<const std::uint8_t> bytes, double heard_s) {
  Evidence best;
  best.found = unknown_bytes(bytes);
  for (sensors::Recognised& found : sensors::recognise(bytes, heard_s)) {
    const double share = static_cast<double>(found.evidence.bytes) / static_cast<double>(bytes.size());
    if (share < share_needed || share <= best.explained_share) continue;
    best = {.role = found.is_usable() ? found.role : std::nullopt,
            .protocol = std::string(found.protocol),
            .explained_share = share,
            .found = std::move(found.evidence)};
  }
  return best;
}

std::vector<PortFinding> identify_devices(const std::vector<io::PortInfo>& ports, double listen_s) {
  SystemPortLoop loop;
  return identify_devices(ports, loop, listen_s);
}

std::vector<PortFinding> identify_devices(const std::vector<io::PortInfo>& ports, PortLoop& loop,
                                          double listen_s) {
  std::vector<std::unique_ptr<Listener>> listeners;
  for (const io::PortInfo& port : ports)
    listeners.push_back(std::make_unique<Listener>(loop, port, listen_s));
  loop.every(listening_tick, [&](HostTime now) {
    for (const auto& listener : listeners) listener->tick(now);
    if (std::all_of(listeners.begin(), listeners.end(), [](const auto& l) { return l->done(); })) loop.stop();
  });
  run_until_stopped(loop);
  std::vector<PortFinding> findings;
  for (const auto& listener : listeners) findings.push_back(listener->finding());
  return findings;
}

std::optional<PortFinding> hear_hand_turn(PortFinding finding, PortLoop& loop) {
  std::vector<std::uint8_t> bytes;
  const HostTime begin = loop.now();
  PortLoop::PortHandlers handlers;
  std::optional<HostTime> first;
  HostTime last = begin;
  handlers.received = [&](std::span<const std::uint8_t> more, HostTime arrived) {
    if (!first) first = arrived;
    last = arrived;
    bytes.insert(bytes.end(), more.begin(), more.end());
  };
  handlers.lost = [&](const std::string&) { loop.stop(); };
  const PortLoop::PortId port = loop.open({.port = finding.info.path, .baud = finding.baud},
                                          std::move(handlers), io::Refusal::names_holder);
  loop.every(listening_tick, [&](HostTime now) {
    if (to_s(now - begin) >= hand_turn_s) loop.stop();
  });
  run_until_stopped(loop);
  loop.close(port);
  if (!first || !finding.text_format) return std::nullopt;
  const auto turn = sensors::turned_by_hand(bytes, *finding.text_format, to_s(last - *first));
  if (!turn) return std::nullopt;
  finding.text_format = turn->format;
  finding.axis = turn->axis;
  return finding;
}

RigProfile apply_findings(RigProfile profile, const std::vector<PortFinding>& findings,
                          std::vector<std::string>& ambiguous) {
  for (const Device device : all_devices) {
    std::vector<const PortFinding*> of_role;
    for (const PortFinding& finding : findings)
      if (finding.role == device) of_role.push_back(&finding);
    if (of_role.size() > 1)
      ambiguous.push_back(fmt::format("{} ports look like a {}: {}; name the right one with --{}",
                                      of_role.size(), name_of(device), listed(of_role), name_of(device)));
    if (of_role.size() != 1) continue;
    const bool reads_text = device == Device::gyro && profile.gyro.protocol == of_role[0]->protocol;
    if (!of_role[0]->is_known() && !reads_text) continue;  // a guess is not saved
    PortProfile& link = profile.link(device);
    link.port = of_role[0]->info.path;
    link.usb_path = of_role[0]->info.usb_path;
    if (device == Device::camera) profile.camera.protocol = of_role[0]->protocol;
    if (device == Device::gyro) apply_gyro(*of_role[0], profile.gyro);
    if (device == Device::servo) apply_servo(*of_role[0], profile.servo);
    if (of_role[0]->baud != 0) link.baud = of_role[0]->baud;  // before which the usual one was taken
  }
  return profile;
}

}  // namespace thermorig::rig

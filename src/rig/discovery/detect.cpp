// SPDX-License-Identifier: MIT
#include "thermorig/rig/discovery/detect.h"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/sensors/device_stream.h"

namespace thermorig::rig {

namespace {

constexpr double share_needed = 0.3;  // a short look begins and ends in the middle of a message
constexpr auto listening_tick = std::chrono::milliseconds(20);
constexpr auto greeting_period = std::chrono::milliseconds(200);

/// A pty has no baud rate: it is listened to once, and greeted by all that want to be greeted.
std::vector<sensors::SearchStep> steps_of_pty() {
  constexpr double listen_share = 0.2, greet_share = 0.3;
  std::vector<sensors::SearchStep> steps = sensors::search_steps();
  std::erase_if(steps, [&](const auto& step) { return &step != &steps.front() && step.greeting.empty(); });
  for (sensors::SearchStep& step : steps) step.at.share = step.greeting.empty() ? listen_share : greet_share;
  return steps;
}

/// Listens on one port, step by step.
class Listener {
 public:
  Listener(PortLoop& loop, const io::PortInfo& info, double listen_s)
      : loop_(loop),
        has_baud_(!loop.is_pseudo_terminal(info.path)),
        steps_(has_baud_ ? sensors::search_steps() : steps_of_pty()),
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
    if (!step.greeting.empty() && now - last_greeting_ >= greeting_period) {
      loop_.write(*port_, step.greeting);
      last_greeting_ = now;
    }
    if (to_s(now - opened_) >= step.at.share * listen_s_) judge(now);
  }

 private:
  void open(HostTime now) {
    bytes_.clear();
    opened_ = now;
    PortLoop::PortHandlers handlers;
    handlers.received = [this](std::span<const std::uint8_t> bytes, HostTime) {
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
    const Evidence evidence = classify(bytes_, to_s(now - opened_));
    if (!bytes_.empty()) finding_.how = evidence.text;
    if (evidence.role) {
      finding_.role = evidence.role;
      finding_.baud = has_baud_ ? steps_[step_].at.baud : 0;
      finding_.protocol = evidence.protocol;
      finding_.text_format = evidence.text_format;
      finding_.rate_hz = static_cast<double>(evidence.messages) / to_s(now - opened_);
      step_ = steps_.size();
    } else {
      ++step_;
    }
  }

  PortLoop& loop_;
  bool has_baud_;
  std::vector<sensors::SearchStep> steps_;
  double listen_s_;
  PortFinding finding_;
  std::size_t step_ = 0;
  std::optional<PortLoop::PortId> port_;
  std::vector<std::uint8_t> bytes_;
  HostTime opened_{};
  HostTime last_greeting_{};
};

void apply_gyro(const PortFinding& finding, GyroProfile& gyro) {
  if (gyro.protocol == finding.protocol) return;
  gyro.protocol = finding.protocol;
  gyro.settings.clear();
  if (finding.text_format) gyro.text = finding.text_format->columns;
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

}  // namespace

Evidence classify(std::span<const std::uint8_t> bytes, double heard_s) {
  Evidence best{.text = bytes.empty() ? "silent"
                                      : fmt::format("{} bytes that no known device sends", bytes.size())};
  for (sensors::Recognised& found : sensors::recognise(bytes, heard_s)) {
    const double share = static_cast<double>(found.evidence.bytes) / static_cast<double>(bytes.size());
    if (share < share_needed || share <= best.explained_share) continue;
    best = {.role = found.role,
            .protocol = std::string(found.protocol),
            .messages = found.evidence.messages,
            .explained_share = share,
            .text = std::move(found.evidence.text),
            .text_format = std::move(found.evidence.text_format)};
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
  loop.run();
  std::vector<PortFinding> findings;
  for (const auto& listener : listeners) findings.push_back(listener->finding());
  return findings;
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
    PortProfile& link = profile.link(device);
    link.port = of_role[0]->info.path;
    link.usb_path = of_role[0]->info.usb_path;
    if (of_role[0]->baud != 0) link.baud = of_role[0]->baud;
    if (device == Device::camera) profile.camera.protocol = of_role[0]->protocol;
    if (device == Device::gyro) apply_gyro(*of_role[0], profile.gyro);
  }
  return profile;
}

}  // namespace thermorig::rig

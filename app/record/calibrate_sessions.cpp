// SPDX-License-Identifier: MIT
#include "calibrate_sessions.h"

#include <fmt/format.h>

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "sessions/session_files.h"
#include "thermorig/core/error.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::app {

namespace {

using rig::CalibrationKind;

/// One session, without the hour of messages that it was measured on.
struct Measured {
  std::filesystem::path path;
  RecordingHeader header;
  CalibrationResult result;
};

CalibrationResult measure(const CalibrateOptions& options, const session::Session& session) {
  switch (options.kind) {
    case CalibrationKind::bias:
      return calibration::measure_bias(session);
    case CalibrationKind::latency:
      return calibration::measure_latency(session);
    case CalibrationKind::orientation:
      return calibration::measure_orientation(session);
    case CalibrationKind::lens:
      return calibration::measure_lens(session);
    case CalibrationKind::encoder:
      return calibration::measure_encoder(session);
    case CalibrationKind::check:
      throw std::logic_error("a check measures nothing for a profile");
    case CalibrationKind::scale:
      break;
  }
  if (!options.marks) return calibration::measure_scale(session);
  return calibration::measure_scale_by_marks(session, options.angle_deg.value_or(full_turn_deg));
}

CalibrationResult combined(const std::vector<Measured>& sessions) {
  return std::visit(
      [&](const auto& first) -> CalibrationResult {
        using Result = std::decay_t<decltype(first)>;
        std::vector<Result> results;
        for (const Measured& session : sessions) results.push_back(std::get<Result>(session.result));
        return calibration::combined(results);
      },
      sessions.front().result);
}

std::string utc_of(const std::vector<Measured>& sessions) {
  std::string newest;
  for (const Measured& session : sessions) newest = std::max(newest, session.header.start_time_utc);
  const auto fraction = newest.find('.');
  if (fraction != std::string::npos) newest = fmt::format("{}Z", newest.substr(0, fraction));
  return newest;
}

std::string seed_text(const RecordingHeader& header) {
  if (!header.simulated) return "a real rig";
  return header.simulation_seed ? fmt::format("simulated with seed {}", *header.simulation_seed)
                                : "simulated by another program";
}

/// A real device is known by its place in the USB tree; a port's name may change with every plugging in.
bool is_same_port(const PortProfile& one, const PortProfile& other) {
  if (!one.usb_path.empty() && !other.usb_path.empty()) return one.usb_path == other.usb_path;
  return one.port == other.port;
}

/// How two sessions are not of one rig; nothing if they are.
std::optional<std::string> difference(const RecordingHeader& one, const RecordingHeader& other) {
  if (one.simulated != other.simulated || one.simulation_seed != other.simulation_seed)
    return fmt::format("one is {}, the other {}", seed_text(one), seed_text(other));
  if (one.simulated) return std::nullopt;  // its ports are new ones every time
  for (const Device device : all_devices) {
    const PortProfile& mine = one.profile.link(device);
    const PortProfile& theirs = other.profile.link(device);
    if (!is_same_port(mine, theirs))
      return fmt::format("the {} is on {} in one and on {} in the other", name_of(device), mine.port,
                         theirs.port);
  }
  return std::nullopt;
}

void check_one_rig(const std::vector<Measured>& sessions) {
  const Measured& first = sessions.front();
  for (const Measured& session : sessions)
    if (const auto differing = difference(first.header, session.header))
      throw Error(ExitCode::bad_usage, "the sessions are of different rigs: " + *differing,
                  fmt::format("{} and {}", first.path.string(), session.path.string()),
                  "sessions of one rig only");
}

class Collection {
 public:
  explicit Collection(const CalibrateOptions& options) : options_(options) {}

  void add(const std::filesystem::path& path) {
    const session::Session session = session::read_session(path);
    const RecordingHeader& header = session.raw.header;
    const auto is_same = [&](const Measured& known) { return known.header.uuid == header.uuid; };
    const auto known = std::find_if(measured_.begin(), measured_.end(), is_same);
    if (known != measured_.end())
      return skip(path, fmt::format("the same session as {}: it counts once", known->path.string()));
    try {
      measured_.push_back({path, header, measure(options_, session)});
    } catch (const Error& error) {
      if (error.code() != ExitCode::finished_lossy) throw;
      skip(path, error.what_happened());
      if (!failure_) failure_ = Error(error.code(), error.what_happened(), path.string(), error.advice());
    }
  }

  MeasuredSessions take() {
    if (measured_.empty()) refuse();
    check_one_rig(measured_);
    MeasuredSessions all{combined(measured_), {}, std::move(skipped_), {}, utc_of(measured_)};
    for (const Measured& session : measured_) all.paths.push_back(session.path);
    all.header = std::move(measured_.front().header);
    return all;
  }

 private:
  void skip(const std::filesystem::path& path, const std::string& reason) {
    skipped_.push_back({path, reason});
  }
  [[noreturn]] void refuse() const {
    if (skipped_.size() == 1) throw Error(*failure_);
    throw Error(failure_->code(),
                fmt::format("none of the {} sessions is enough; the first: {}", skipped_.size(),
                            failure_->what_happened()),
                failure_->where(), failure_->advice());
  }

  const CalibrateOptions& options_;
  std::vector<Measured> measured_;
  std::vector<SkippedSession> skipped_;
  std::optional<Error> failure_;  // of the first that cannot tell
};

}  // namespace

MeasuredSessions measure_sessions(const CalibrateOptions& options,
                                  const std::vector<std::filesystem::path>& paths) {
  Collection collection(options);
  for (const auto& path : session_files_at(paths)) collection.add(path);
  return collection.take();
}

}  // namespace thermorig::app

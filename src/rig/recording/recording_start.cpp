// SPDX-License-Identifier: MIT
#include "recording_start.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <random>
#include <utility>

#include "thermorig/io/files/part_file.h"
#include "thermorig/io/host.h"
#include "thermorig/io/port.h"

namespace thermorig::rig {

namespace {

constexpr double least_step_s = 1.0;  // whatever the reading of two clocks and a leap second make
constexpr double fastest_slew = 1e-3;

// RFC 4122, section 4.4.
std::string random_uuid() {
  std::random_device device;
  std::array<std::uint32_t, 4> words{};
  for (std::uint32_t& word : words) word = device();
  words[1] = (words[1] & 0xFFFF0FFFU) | 0x00004000U;
  words[2] = (words[2] & 0x3FFFFFFFU) | 0x80000000U;
  return fmt::format("{:08x}-{:04x}-{:04x}-{:04x}-{:04x}{:08x}", words[0], words[1] >> 16U,
                     words[1] & 0xFFFFU, words[2] >> 16U, words[2] & 0xFFFFU, words[3]);
}

/// In virtual time the first second of a recording is dated with the wall's clock.
std::int64_t realtime_offset_ns(const RecordingOptions& options, HostTime now) {
  const std::int64_t offset_ns = wall_offset_ns(options);
  return options.virtual_time ? offset_ns + to_ns(io::now()) - to_ns(now) : offset_ns;
}

}  // namespace

std::int64_t wall_offset_ns(const RecordingOptions& options) {
  return options.realtime_offset_ns ? options.realtime_offset_ns() : io::realtime_offset_ns();
}

std::int64_t clock_set_ns(std::int64_t offset_at_begin_ns, std::int64_t offset_at_end_ns, double run_s) {
  const std::int64_t step_ns = offset_at_end_ns - offset_at_begin_ns;
  return std::abs(1e-9 * static_cast<double>(step_ns)) > least_step_s + fastest_slew * run_s ? step_ns : 0;
}

RecordingHeader make_header(const RecordingOptions& options, HostTime now) {
  RecordingHeader header;
  header.uuid = random_uuid();
  header.environment = options.environment;
  header.title = options.title;
  header.licence = options.licence;
  header.operator_name = options.operator_name;
  header.place = options.place;
  header.note = options.note;
  header.time_reference = now;
  header.realtime_offset_ns = realtime_offset_ns(options, now);
  header.start_time_utc = io::utc_text(now, header.realtime_offset_ns);
  header.simulated = options.simulated;
  header.simulation_seed = options.simulation_seed;
  header.simulation = options.simulation;
  header.profile = options.profile;
  header.plan_name = options.plan.name;
  header.plan_toml = to_toml(options.plan);
  header.frames_per_leg = options.plan.frames_per_leg;
  header.live_model = options.live_model;
  header.estimators = options.estimators;
  header.creator = options.creator;
  header.creator_git = options.creator_git;
  header.host_name = files::host_name();
  header.kernel = io::kernel_release();
  return header;
}

RecordingStart::RecordingStart(const RecordingOptions& options)
    : profile_(options.profile),
      mode_(options.preflight),
      moves_(!options.plan.leg_rates_dps.empty() || !options.profile.servo.is_there()),
      is_allowed_(!options.wait_for_start) {}

bool RecordingStart::allow() {
  return !std::exchange(is_allowed_, true);
}

bool RecordingStart::greeted() {
  return !std::exchange(is_greeted_, true);
}

void RecordingStart::ready(HostTime now, const PreflightCounts& counts) {
  if (state_ == State::awaiting_devices) {
    state_ = State::ready;
    listen_anew(now, counts);
  }
  watch_.counted(now, counts);
}

void RecordingStart::listen_anew(HostTime now, const PreflightCounts& counts) {
  if (state_ == State::ready) watch_.begin(now, counts, profile_);
}

bool RecordingStart::is_due(HostTime now, const PreflightCounts& counts) {
  if (!is_allowed_) return false;
  if (mode_ == PreflightMode::off) return true;
  if (watch_.heard_s(now) < PreflightWatch::needed_s(profile_, counts.gone)) return false;
  report_ = judge_now(now, counts);
  return true;
}

bool RecordingStart::is_to_be_refused() const {
  return report_ && !report_->passed() && mode_ == PreflightMode::refuse && moves_;
}

PreflightReport RecordingStart::judge_now(HostTime now, const PreflightCounts& counts) const {
  return judge(watch_.facts(now, counts, profile_), profile_);
}

std::optional<PreflightReport> RecordingStart::report(HostTime now, const PreflightCounts& counts) const {
  constexpr double least_s = 1.0;
  if (report_) return report_;
  if (mode_ == PreflightMode::off || watch_.heard_s(now) < least_s) return std::nullopt;
  return judge_now(now, counts);
}

}  // namespace thermorig::rig

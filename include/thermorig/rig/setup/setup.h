// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/profile.h"
#include "thermorig/rig/discovery/detect.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/rig/sweep/plan.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::rig {

/// The steps of a first run, in order: which port is which device; what each of them sends; small moves of
/// the servo; turns there and back; the checks and a session. The profile is written between the last two.
enum class SetupStep : std::uint8_t { ports, look, servo, turns, session };
inline constexpr std::array<std::string_view, 5> setup_step_names{"ports", "look", "servo", "turns",
                                                                  "session"};

/// What a setup finds its way by: ports, a person, recordings. Each member may throw Error, which ends it.
class SetupWorld {
 public:
  virtual ~SetupWorld() = default;
  /// A step begins.
  virtual void begin(SetupStep step) = 0;
  /// Listens to every port that may be the rig's.
  virtual std::vector<PortFinding> listen() = 0;
  /// Shows for some seconds what each device sends. Nothing moves.
  virtual void show(const RigProfile& profile) = 0;
  /// Records the plan and returns the session. Throws Error of a recording that ended early.
  virtual session::Session record(const RigProfile& profile, const SweepPlan& plan) = 0;
  /// One thing to know: lines for people.
  virtual void say(const std::string& text) = 0;
  /// Asks for a yes, and returns then. Throws Error(interrupted) for a no. What moves is asked before.
  virtual void confirm(const std::string& question) = 0;
  /// Asks for something that only a person can do. Throws Error(device_missing) where there is nobody.
  virtual void ask_to(const std::string& request) = 0;
  /// Flashes the servo's firmware onto the board on that port, if it was told to. False: it was not.
  virtual bool flash(const std::string& port) = 0;
  /// The file to flash.
  virtual std::string firmware_image() const = 0;
  /// What to type to do it again, from a step on if the profile is there that knows what comes before.
  virtual std::string command_again(std::optional<SetupStep> from) const = 0;
};

/// What the devices of a rig sent before a person is asked whether they are the right ones.
struct DevicesSeen {
  std::optional<TimedFrame> frame;  // the last one
  RecordingProgress progress;
};

/// Opens the profile's ports until all devices have sent for 3 s. `recording` has the profile. Nothing is
/// kept, and nothing moves. Throws Error: device_missing, no_permission; interrupted when a signal asks it to
/// stop.
DevicesSeen see_devices(RecordingOptions recording, PortLoop& loop);

/// What is known of a rig so far.
struct SetupState {
  RigProfile profile;
  bool knows_gyro_unit = true;   // false: of a text gyro whose lines do not say it
  bool knows_gyro_axis = false;  // by the servo's own moves
};

// Each step takes what is known so far, and gives what is known behind it. Throw Error that says why the step
// could not be done and what to try; the state of the caller is then as before.

/// Finds camera, gyro and servo. Of two ports that look alike a person is asked to unplug one. A servo that
/// does not answer may be a board without the firmware: how to flash it is said.
SetupState set_up_ports(SetupState state, SetupWorld& world);

/// Shows each device, for a person to confirm.
SetupState set_up_look(SetupState state, SetupWorld& world);

/// Moves the servo by some degrees both ways: which axis of the gyro turns with it, with which sign, and, of
/// a gyro whose unit is known, the servo's travel.
SetupState set_up_servo(SetupState state, SetupWorld& world);

/// Turns there and back: the gyro's unit by the images, the servo's travel, the camera's orientation and
/// latency.
SetupState set_up_turns(SetupState state, SetupWorld& world);

/// The steps from `from` up to the turns, then writes the profile to `path`, in one replace: whatever ends it
/// before leaves no profile there, or the old one. Begins with the profile that is there; from a later step
/// than the first there must be one, else throws Error(bad_usage). Returns what was written; of the last
/// step, which is the caller's, what was there.
RigProfile set_up(const std::filesystem::path& path, SetupStep from, SetupWorld& world);

/// The step by its name. Throws Error(bad_usage) with the names that there are.
SetupStep setup_step_named(const std::string& name);

/// The moves of set_up_servo() at that speed, and the turns of set_up_turns(): about half a minute.
SweepPlan setup_moves_plan(const ServoProfile& servo, const CameraProfile& camera, double rate_dps);
SweepPlan setup_turns_plan(const ServoProfile& servo, const CameraProfile& camera);

}  // namespace thermorig::rig

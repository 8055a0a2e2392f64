// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "acceptance/served_rig.h"
#include "app/program.h"
#include "thermorig/session/session.h"

namespace thermorig::tests {

/// What may happen to a run.
enum class Mishap : std::uint8_t {
  camera_unplugged,
  gyro_unplugged,
  servo_unplugged,
  host_frozen,
  program_killed
};
std::string name_of(Mishap mishap);

/// The built program on three ports that this process serves, and something that goes wrong while the servo
/// moves. The two have the ports in common and nothing else.
class Drill : public ProgramTest {
 protected:
  Drill();

  /// Runs `thermorig COMMAND...` with the rig, the environment and a plan of two legs of so many frames; in
  /// the first leg the mishap happens. The ports are stopped afterwards.
  Outcome suffer(const std::vector<std::string>& command, Mishap mishap, int frames_per_leg);

  /// In its own time, 300 ms after the last byte that it received before `mishap` took its commands away, the
  /// servo turns by less than 1 deg/s, and it moved before.
  void expect_rest(Mishap mishap) const;

  /// In its own time, 300 ms after the port was gone that `suffer` unplugged, the servo turns by less than
  /// 1 deg/s to the end, and it moved before.
  void expect_rest_at_once() const;

  /// Every byte of each device in the session lies in one piece in what was delivered to the program, and but
  /// for what it could not read any more nothing is missing behind it.
  void expect_complete(const session::Session& session) const;

  session::Session only_session() const;

  ServedRig rig_{3, "garden"};

 private:
  void wait_until(const std::function<bool()>& happened) const;
  void strike(Mishap mishap, pid_t process);
  void unplug(Device device);

  std::int64_t unplugged_us_ = 0;  // of the micro-controller
};

}  // namespace thermorig::tests

// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "acceptance/served_rig.h"
#include "app/program.h"
#include "thermorig/storage/session/session.h"

namespace thermorig::tests {

/// What may happen to a run.
enum class Mishap : std::uint8_t {
  camera_unplugged,
  gyro_unplugged,
  servo_unplugged,
  host_frozen,
  program_killed,
  interrupted,
  hung_up,
  quit,
  disk_full
};
std::string name_of(Mishap mishap);

/// The built program on three ports that this process serves, and something that goes wrong while the servo
/// moves. The two have the ports in common and nothing else.
class Drill : public ProgramTest {
 protected:
  Drill();

  /// Runs `thermorig COMMAND...` with the rig, the environment and a plan of two legs of so many frames; in
  /// the first leg the mishap happens. The ports are stopped afterwards. While this computer keeps everybody
  /// waiting for longer than the servo waits for an answer, nothing but the servo's rest and limits can be
  /// judged: such a run is void and another one takes its place, at most three times; the last one counts. A
  /// drill that fails then may be tried again later; other failures, and a servo that did not rest or left
  /// its limits in any run, get no second try.
  Outcome suffer(const std::vector<std::string>& command, Mishap mishap, int frames_per_leg);

  /// In its own time, 300 ms after the last byte that it received before `mishap` took its commands away, the
  /// servo turns by less than 1 deg/s, and it moved before. This and the next two print "drill: ..." with the
  /// time that it took.
  void expect_rest(Mishap mishap);

  /// In its own time, 300 ms after the port was gone that `suffer` unplugged, the servo turns by less than
  /// 1 deg/s to the end, and it moved before.
  void expect_rest_at_once();

  /// In its own time, 300 ms after the mishap that ended the program, the servo turns by less than 1 deg/s to
  /// the end, and it moved before.
  void expect_rest_after_the_end();

  /// From the first pulse to the last no pulse asked for an angle or, from one to the next, for a speed
  /// beyond the profile's limits.
  void expect_within_limits();

  /// Every byte of each device in the session lies in one piece in what was delivered to the program, and but
  /// for what it could not read any more nothing is missing behind it.
  void expect_complete(const session::Session& session) const;

  session::Session only_session() const;

  std::optional<ServedRig> rig_;

 private:
  void make_rig();
  Outcome suffer_once(const std::vector<std::string>& command, Mishap mishap, int frames_per_leg);
  void expect_rest_in_the_end();
  void expect_rest_from(std::int64_t from_us, std::int64_t until_us);
  void wait_until(const std::function<bool()>& happened) const;
  void strike(Mishap mishap, pid_t process);
  void unplug(Device device);
  void print_rest(std::int64_t from_us, std::int64_t until_us) const;

  std::string command_;
  Mishap mishap_{};
  std::int64_t unplugged_us_ = 0;  // of the micro-controller
  std::int64_t struck_us_ = 0;     // 0: the program ended before
};

}  // namespace thermorig::tests

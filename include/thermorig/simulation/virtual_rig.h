// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/chunk.h"
#include "thermorig/core/profile.h"
#include "thermorig/core/time.h"
#include "thermorig/simulation/firmware.h"
#include "thermorig/simulation/world.h"

namespace thermorig::simulation {

enum class UsbLink : std::uint8_t { ftdi, ch340, cdc };
enum class GyroGrade : std::uint8_t { calibrated, typical, mpu6050_raw };

/// When a gyro begins to send samples. Protocols whose gyros are deaf have but the first.
enum class GyroStart : std::uint8_t {
  by_itself,
  when_asked,
  when_asked_of_old  // by the request that older devices of its protocol know
};

/// How the camera's bridge begins, and whether it hears commands.
enum class CameraStart : std::uint8_t {
  by_itself,
  when_asked,  // query mode
  deaf         // by itself, and nothing that it is told arrives
};

struct LinkConfig {
  UsbLink kind = UsbLink::ftdi;
  double latency_timer_s = 0.016;  // FTDI only
  bool loaded_host = false;        // reads stall now and then, as on a busy machine
};

/// Nothing of a device arrives: a byte whose stop bit ends from `begin` to before `end` is lost before the
/// host (its USB plug is out). Whatever is sent to it still reaches it.
struct Outage {
  Device device = Device::camera;
  HostTime begin{};
  HostTime end{};
};

/// Somebody turns the whole rig by hand, smoothly, from rest to rest: camera and gyro see it, the servo does
/// not.
struct HandTurn {
  HostTime begin{};
  double duration_s = 10.0;
  double angle_deg = 360.0;
};

/// Everything that a simulated rig is made of. The rest follows from `seed` and `environment`.
struct VirtualRigConfig {
  std::uint64_t seed = 1;
  std::string environment = "laboratory";  // a name, as a recording has it
  std::string scene = {};                  // one of scene_names(); empty: scene_of(environment)
  RigProfile profile;  // lens, rates, bauds, servo geometry: what the program is told as well
  GyroGrade gyro_grade = GyroGrade::typical;
  bool half_fresh = true;             // one fresh chess half a frame; false: both
  bool warm = true;                   // the camera has been on for long
  double camera_clock_error = -0.02;  // relative: 2 % slow
  double servo_loop_hz = 8.0;         // bandwidth of the servo's position loop
  std::optional<double>
      camera_latency_s;  // of this board, from the exposure's end to the first byte; drawn if not set
  std::uint32_t camera_bus_baud = 0;  // of a camera that the profile gives no baud: so fast is its bus
  std::optional<double> gyro_latency_s;
  CameraStart camera_start = CameraStart::by_itself;
  GyroStart gyro_start = GyroStart::by_itself;
  bool has_encoder = false;         // an AS5600 on the shaft
  bool gyro_zeroes_itself = false;  // at rest, after a second, as WitMotion's do
  DynamixelHabits dynamixel;        // of a servo that speaks that
  GrblHabits grbl;                  // likewise
  Sts3215Habits sts3215;            // likewise
  World world;                      // what its devices do beyond that; begins as the honest one
  std::vector<Outage> outages;
  std::vector<HandTurn> hand_turns;
  PerDevice<LinkConfig> links;
  HostTime start{};  // host time at which the rig is switched on
};

/// What the simulator knows and the program must not: for tests.
struct TruthSample {
  HostTime time{};
  double angle_deg = 0.0;  // of the shaft, hand turns included: where camera and gyro point
  double rate_dps = 0.0;
};

/// A frame or gyro sample as the device sent it. `sent_frames()[i].index == i`, lost messages counted; a
/// message that the program decoded is found by its place in the bytes: `span` equals what the scanner says.
/// Times are those of the host's clock, rates per second of true time. Exposed is the span of time whose
/// motion the message shows: earlier than its integration by the lag of the camera's membranes, than its
/// averaging by the group delay of the gyro's filter. Of rows that are read one after the other it is that of
/// the middle ones; of a frame with a half that is older because one was lost, it begins with that half's; of
/// a frame that is sent again, it is that of what it shows.
struct SentMessage {
  std::uint64_t index = 0;
  HostTime exposure_begin{};  // gyro: start of its averaging interval
  HostTime exposure_end{};
  double mean_rate_dps = 0.0;  // true mean rate of the shaft, hand turns included, over the exposure
  HostTime sent{};             // when its first byte began on the wire
  StreamSpan span;             // of its bytes in all that reach the host from this device
  bool arrives = true;         // whole: no outage took a byte of it
};

/// What stands at the servo's end of the line, by the protocol of the rig's profile: the firmware's host
/// build, or a servo on a bus.
std::unique_ptr<Firmware> make_servo(const VirtualRigConfig& config);

/// Whether anything measures the shaft: an AS5600 that its board asks, or the servo itself.
bool measures_shaft(const VirtualRigConfig& config);

/// A whole rig in virtual time: physics, devices and USB links. Deterministic by its configuration.
/// The same object serves ptys on the wall clock when its caller paces it.
class VirtualRig {
 public:
  /// `firmware` is the servo's micro-controller: of make_servo(), or the AVR image.
  VirtualRig(const VirtualRigConfig& config, std::unique_ptr<Firmware> firmware);
  ~VirtualRig();

  /// Bytes from the host to a device, written at host time `now` (not before the last `advance`). A camera or
  /// gyro hears of a write what stands whole in it.
  void send(Device to, std::span<const std::uint8_t> bytes, HostTime now);

  /// A program has opened the device's port: some boards are reset by that.
  void opened(Device device, HostTime now);

  /// Runs the rig to host time `until` and returns the chunks that arrive up to then, in order of arrival.
  std::vector<Chunk> advance(HostTime until);

  /// The instant at which the clock of the servo's micro-controller read `mcu`.
  HostTime when_servo_clock_read(ServoTime mcu) const;

  /// The shaft since the start, a sample a millisecond. Kept only when asked for by `keep_truth`.
  const std::vector<TruthSample>& shaft() const;
  const std::vector<SentMessage>& sent_frames() const;
  const std::vector<SentMessage>& sent_gyro() const;
  const std::vector<PulseEdge>& pulses() const;
  void keep_truth(bool keep);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// The default rig of the README: 6-turn winch, 55 degree lens, half-fresh 8 frames/s at 460800 baud,
/// WitMotion at 200 Hz; and the profile that describes it.
RigProfile default_profile();
VirtualRigConfig default_rig(std::uint64_t seed, const std::string& environment);

/// The rig in that world. Its profile states the gyro's bandwidth in a world whose gyro has the honest one's:
/// who carries another filter has not looked it up.
void put_in_world(const World& world, VirtualRigConfig& config);

/// `half` (of the default rig), `full`, `query`, `text`, `binary`, `raw`, `i2c`: what --simulated-camera
/// takes.
std::span<const std::string_view> camera_kinds();

/// The rig with such a camera, in the world that it has by then: what it sends, how, and how late. Throws
/// Error(bad_usage) for a kind that there is not.
void choose_camera(std::string_view kind, VirtualRigConfig& config);

}  // namespace thermorig::simulation

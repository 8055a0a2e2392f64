// SPDX-License-Identifier: MIT
#include "wrong_rigs.h"

#include <algorithm>
#include <array>
#include <memory>
#include <utility>

#include "servo_link.h"
#include "thermorig/core/frame.h"
#include "thermorig/sensors/wire/device_bytes.h"

namespace thermorig::doctor::test {

using rig::test::SimulatedBus;

namespace {

/// What the doctor would hear of a rig: nothing is armed. An Error is a check as well.
std::vector<Check> rig_with(const simulation::VirtualRigConfig& config, const RigProfile& profile,
                            const std::function<void(SimulatedBus&)>& wrong) {
  SimulatedBus bus(config);
  wrong(bus);
  rig::VirtualOptions options;
  options.recording.profile = profile;
  options.recording.plan = rig::test::short_plan();
  options.recording.keep = false;
  options.recording.wait_for_start = true;
  options.recording.preflight = rig::PreflightMode::warn;
  bool heard = false;
  options.progress = [&](const rig::RecordingProgress& progress) { heard = progress.heard_s >= 5.0; };
  options.stop_requested = [&] { return heard; };
  try {
    const rig::RecordingResult result = rig::record_virtual(bus, options);
    if (!result.preflight)
      return {{.name = "rig", .code = result.exit, .result = result.message, .advice = result.advice}};
    return judge_rig(*result.preflight);
  } catch (const Error& error) {
    return {{.name = "rig",
             .code = error.code(),
             .result = error.where() + ": " + error.what_happened(),
             .advice = error.advice()}};
  }
}

simulation::VirtualRigConfig good_rig() {
  return simulation::default_rig(3, "kitchen");
}

std::vector<Check> device_with(const std::function<void(RigProfile&)>& differs) {
  simulation::VirtualRigConfig config = good_rig();
  config.camera_start = simulation::CameraStart::deaf;  // what it is asked for, it does not do
  differs(config.profile);
  return rig_with(config, good_rig().profile, [](SimulatedBus&) {});
}

/// Loses every n-th chunk whole.
SimulatedBus::Damage losing_every(int n) {
  return [n, count = 0](std::vector<std::uint8_t> bytes, HostTime) mutable {
    return ++count % n == 0 ? std::vector<std::uint8_t>() : bytes;
  };
}

/// Works on whole camera frames: `change` gets one and its number, and says what is sent for it.
SimulatedBus::Damage frame_by_frame(
    std::function<std::vector<std::uint8_t>(std::vector<std::uint8_t> frame, std::size_t number)> change) {
  return [change = std::move(change), kept = std::vector<std::uint8_t>(), number = std::size_t{0}](
             std::vector<std::uint8_t> bytes, HostTime) mutable {
    kept.insert(kept.end(), bytes.begin(), bytes.end());
    std::vector<std::uint8_t> out;
    while (kept.size() >= wire::camera_frame_bytes) {
      const auto end = kept.begin() + static_cast<std::ptrdiff_t>(wire::camera_frame_bytes);
      const auto sent = change({kept.begin(), end}, number++);
      out.insert(out.end(), sent.begin(), sent.end());
      kept.erase(kept.begin(), end);
    }
    return out;
  };
}

std::vector<std::uint8_t> welcome_of_version(std::uint8_t version) {
  std::vector<std::uint8_t> payload(SERVO_WELCOME_SIZE, 0);
  payload[0] = version;
  std::vector<std::uint8_t> bytes(SERVO_FRAME_MAX);
  bytes.resize(servo_frame(bytes.data(), SERVO_WELCOME, 0, payload.data(), SERVO_WELCOME_SIZE));
  return bytes;
}

/// Each port sends what the other one should, as it comes.
void swap_camera_and_gyro(SimulatedBus& bus) {
  const auto queues = std::make_shared<std::array<std::vector<std::uint8_t>, 2>>();
  const auto crossed = [queues](std::size_t own) {
    return [queues, own](const std::vector<std::uint8_t>& bytes, HostTime) {
      auto& mine = (*queues)[own];
      mine.insert(mine.end(), bytes.begin(), bytes.end());
      return std::exchange((*queues)[1 - own], {});
    };
  };
  bus.from_device[0] = crossed(0);
  bus.from_device[1] = crossed(1);
}

/// The odd half of the chess pattern stays what it was in the first frame.
std::vector<std::uint8_t> with_odd_half_of(const std::vector<std::uint8_t>& first,
                                           std::vector<std::uint8_t> frame) {
  constexpr std::size_t header_bytes = 4;
  for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) {
    if (subpage_of(pixel / frame_columns, pixel % frame_columns) == 0) continue;
    const std::size_t at = header_bytes + 2 * pixel;
    frame[at] = first[at];
    frame[at + 1] = first[at + 1];
  }
  return frame;
}

}  // namespace

std::vector<Check> rig_with(const std::function<void(SimulatedBus&)>& wrong) {
  return rig_with(good_rig(), good_rig().profile, wrong);
}

std::vector<Misconfiguration> wrong_rigs() {
  return {
      {"camera and gyro are swapped", [] { return rig_with(swap_camera_and_gyro); }, "rig", "not the",
       "thermorig ports", ExitCode::device_missing},
      {"the gyro speaks another protocol",
       [] { return device_with([](RigProfile& rig) { rig.gyro.protocol = "text"; }); }, "rig",
       "WitMotion packets", "protocol = \"text\"", ExitCode::device_missing},
      {"no servo",
       [] {
         return rig_with([](SimulatedBus& bus) {
           bus.is_cut = [](Device device, HostTime) { return device == Device::servo; };
         });
       },
       "rig", "hello", "thermorig ports", ExitCode::device_missing},
      {"another version of the servo's firmware",
       [] {
         return rig_with([](SimulatedBus& bus) {
           bus.from_device[2] = [](std::vector<std::uint8_t>, HostTime) { return welcome_of_version(7); };
         });
       },
       "rig", "version 7", "reflash", ExitCode::device_missing},
      {"the gyro sends half as often as the profile says",
       [] { return device_with([](RigProfile& rig) { rig.gyro.output_rate_hz = 100.0; }); },
       "preflight: gyro_rate", "nominal 200", "output_rate_hz", ExitCode::check_failed},
      {"the camera sends half as often as the profile says",
       [] { return device_with([](RigProfile& rig) { rig.camera.output_rate_hz = 4.0; }); },
       "preflight: camera_rate", "nominal 8", "--camera-rate", ExitCode::check_failed},
      {"the gyro loses 5 %",
       [] {
         return rig_with([](SimulatedBus& bus) {
           bus.from_device[1] = [count = 0](std::vector<std::uint8_t> bytes, HostTime) mutable {
             if (++count % 7 == 0) bytes.erase(bytes.begin() + 3);  // one of about 21 packets
             return bytes;
           };
         });
       },
       "preflight: gyro_damaged", "gyro's bytes", "cable", ExitCode::check_failed},
      {"the camera drops a frame in six",
       [] {
         return rig_with([](SimulatedBus& bus) {
           bus.from_device[0] = frame_by_frame([](std::vector<std::uint8_t> frame, std::size_t number) {
             return number % 6 == 5 ? std::vector<std::uint8_t>() : frame;
           });
         });
       },
       "preflight: camera_lost", "frames are missing", "cable", std::nullopt},
      {"the camera's bridge misses most of the half-frames",
       [] {
         simulation::VirtualRigConfig config = good_rig();
         config.world.camera.lost_subpages = 0.75;
         return rig_with(config, config.profile, [](SimulatedBus&) {});
       },
       "preflight: camera_halves", "the camera skips", "frame rate", ExitCode::check_failed},
      {"the camera sends each frame twice",
       [] {
         return rig_with([](SimulatedBus& bus) {
           bus.from_device[0] =
               frame_by_frame([kept = std::vector<std::uint8_t>()](std::vector<std::uint8_t> frame,
                                                                   std::size_t number) mutable {
                 if (number % 2 == 0) kept = std::move(frame);
                 return kept;
               });
         });
       },
       "preflight: camera_repeats", "repeat", "frame rate", ExitCode::check_failed},
      {"one half of the camera's chess pattern stands still",
       [] {
         simulation::VirtualRigConfig config = good_rig();
         config.profile.camera.checksum = ChecksumPolicy::ignore;
         return rig_with(config, config.profile, [](SimulatedBus& bus) {
           bus.from_device[0] = frame_by_frame(
               [first = std::vector<std::uint8_t>()](std::vector<std::uint8_t> frame, std::size_t) mutable {
                 if (first.empty()) first = frame;
                 return with_odd_half_of(first, std::move(frame));
               });
         });
       },
       "preflight: camera_fresh", "the odd half-frame", "frame rate", ExitCode::check_failed},
      {"somebody turns the rig",
       [] {
         simulation::VirtualRigConfig config = good_rig();
         config.hand_turns.push_back({host_time_ns(2'000'000'000), 8.0, 40.0});
         return rig_with(config, config.profile, [](SimulatedBus&) {});
       },
       "preflight: gyro_noise", "varies by", "do not touch it", ExitCode::check_failed},
      {"the servo loses every fifth answer",
       [] { return rig_with([](SimulatedBus& bus) { bus.from_device[2] = losing_every(5); }); },
       "preflight: servo_lost", "messages are missing", "cable", ExitCode::check_failed},
      {"a servo that may turn faster than its firmware lets it",
       [] {
         rig::PreflightFacts facts;
         facts.answers = rig::PreflightAnswers{.limit_rate_dps = 150.0};
         return judge_rig(rig::judge(facts, good_rig().profile));
       },
       "preflight: servo_limits", "220", "max_rate_dps", ExitCode::check_failed},
      {"the servo's supply broke down",
       [] {
         rig::PreflightFacts facts;
         facts.answers = rig::PreflightAnswers{.firmware = "1.0", .reset_cause = 4, .limit_rate_dps = 300.0};
         return judge_rig(rig::judge(facts, good_rig().profile));
       },
       "servo board", "brown-out", "a supply of its own", std::nullopt},
      {"the camera is cold",
       [] {
         simulation::VirtualRigConfig config = good_rig();
         config.warm = false;
         return rig_with(config, config.profile, [](SimulatedBus&) {});
       },
       "camera warm-up", "degC a minute", "4 minutes", std::nullopt},
  };
}

}  // namespace thermorig::doctor::test

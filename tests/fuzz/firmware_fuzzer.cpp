// SPDX-License-Identifier: MIT
// Any bytes to the servo's firmware at any time, and well-formed commands with any values among them:
// whatever comes, its limits hold in every step, a fault brings it to rest, and there is no pulse that was
// not armed for.
#include <array>
#include <cstdint>
#include <cstdlib>

#include "fuzz_require.h"

extern "C" {
#include "servo.h"
}

namespace {

using thermorig::test::fuzz_require;
using thermorig::test::FuzzScript;

constexpr int steps_max = 20'000;  // of one input
constexpr int rest_steps = 200;    // 300 deg/s and 2000 deg/s^2: 150

/// The firmware as a board drives it, and what must hold after each step.
class Board {
 public:
  Board() { servo_init(&servo_, SERVO_BOARD_HOST, 1); }

  void receive(std::uint8_t byte) {
    servo_receive(&servo_, byte, time_us_);
    drain();
  }

  void send(std::uint8_t type, const std::uint8_t* payload, std::uint8_t size) {
    std::array<std::uint8_t, SERVO_FRAME_MAX> frame{};
    const std::uint8_t bytes = servo_frame(frame.data(), type, servo_.expected_sequence, payload, size);
    for (std::uint8_t i = 0; i < bytes; ++i) receive(frame[i]);
  }

  void step() {
    if (++steps_ > steps_max) return;
    const std::int32_t before = servo_.motion.rate;
    time_us_ += SERVO_TICK_US;
    servo_tick(&servo_, time_us_);
    if (servo_ping_is_due(&servo_, time_us_)) servo_answer_ping(&servo_, time_us_);
    drain();
    check_speed(before);
    check_pulse();
    check_fault();
  }

 private:
  void drain() {
    while (!servo_output_is_empty(&servo_.output)) servo_output_take(&servo_.output);
  }

  void check_speed(std::int32_t before) const {
    const auto& limits = servo_.configuration;
    const std::int32_t rate = servo_.motion.rate;
    const std::int64_t most = std::int64_t{MOTION_RATE_PER_CDPS} * limits.limit_rate_cdps;
    fuzz_require(rate <= most && rate >= -most);
    const std::int32_t change = rate > before ? rate - before : before - rate;
    fuzz_require(change <= static_cast<std::int32_t>(SERVO_EMERGENCY_DPS2));
    if (servo_.fault == SERVO_FAULT_NONE) fuzz_require(change <= limits.limit_acceleration_dps2);
    if (!servo_.armed || limits.kind != SERVO_KIND_POSITIONAL) return;
    const std::int32_t angle = servo_.motion.angle_cdeg;
    fuzz_require(angle >= limits.angle_min_cdeg && angle <= limits.angle_max_cdeg);
    fuzz_require(angle < limits.angle_max_cdeg || servo_.motion.angle_udeg == 0);
  }

  void check_pulse() const {
    const std::uint16_t ticks = servo_next_pulse(&servo_);
    fuzz_require((ticks != 0) == servo_.armed);
    if (ticks == 0) return;
    fuzz_require(servo_.configured);
    fuzz_require(ticks >= servo_.configuration.pulse_min_us * SERVO_TICKS_PER_US);
    fuzz_require(ticks <= servo_.configuration.pulse_max_us * SERVO_TICKS_PER_US);
  }

  void check_fault() {
    faulty_ = servo_.fault == SERVO_FAULT_NONE ? 0 : faulty_ + 1;
    if (faulty_ > rest_steps) fuzz_require(servo_.motion.rate == 0);
  }

  servo servo_{};
  std::uint32_t time_us_ = 0;
  int steps_ = 0;
  int faulty_ = 0;
};

struct Shape {
  std::uint8_t type, size;
};
constexpr std::array<Shape, 9> commands{{{SERVO_HELLO, SERVO_HELLO_SIZE},
                                         {SERVO_CONFIGURE, SERVO_CONFIGURE_SIZE},
                                         {SERVO_ARM, SERVO_ARM_SIZE},
                                         {SERVO_DISARM, 0},
                                         {SERVO_RUN, SERVO_RUN_SIZE},
                                         {SERVO_GO_TO, SERVO_GO_TO_SIZE},
                                         {SERVO_HALT, 0},
                                         {SERVO_REFRESH, 0},
                                         {SERVO_PING, SERVO_PING_SIZE}}};

void configure_and_arm(Board& board, std::uint8_t kind) {
  const std::uint8_t hello[SERVO_HELLO_SIZE] = {SERVO_LINK_VERSION};
  std::array<std::uint8_t, SERVO_CONFIGURE_SIZE> configure{};
  configure[0] = kind;
  servo_put_u16(&configure[1], 500);
  servo_put_u16(&configure[3], 2500);
  servo_put_u32(&configure[5], 216'000);
  servo_put_u32(&configure[9], 22'000);
  servo_put_u16(&configure[13], 2000);
  servo_put_u32(&configure[15], static_cast<std::uint32_t>(-9'000));
  servo_put_u32(&configure[19], 9'000);
  const std::array<std::uint8_t, SERVO_ARM_SIZE> arm{};
  board.send(SERVO_HELLO, hello, SERVO_HELLO_SIZE);
  board.send(SERVO_CONFIGURE, configure.data(), SERVO_CONFIGURE_SIZE);
  board.send(SERVO_ARM, arm.data(), SERVO_ARM_SIZE);
}

/// A sane run or go-to, so that something moves when the mischief comes.
void move(Board& board, FuzzScript& script) {
  std::array<std::uint8_t, SERVO_RUN_SIZE> run{};
  servo_put_u16(&run[0], script.byte());
  run[2] = script.byte() & 1U;
  servo_put_u32(&run[3], static_cast<std::uint32_t>(std::int32_t{script.number<std::int16_t>()} % 22'001));
  servo_put_u16(&run[7], static_cast<std::uint16_t>(100 + script.number<std::uint16_t>() % 1901));
  servo_put_u32(&run[9], 1U + script.number<std::uint16_t>() % 60'000U);
  board.send(SERVO_RUN, run.data(), SERVO_RUN_SIZE);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  FuzzScript script(data, size);
  Board board;
  while (!script.done()) {
    const std::uint8_t what = script.byte();
    if (what < 96) {  // a well-formed command of any values
      const Shape& command = commands[what % commands.size()];
      std::array<std::uint8_t, SERVO_PAYLOAD_MAX> payload{};
      for (std::uint8_t i = 0; i < command.size; ++i) payload[i] = script.byte();
      board.send(command.type, payload.data(), command.size);
    } else if (what < 128) {
      configure_and_arm(board, what & 1U);
    } else if (what < 160) {
      move(board, script);
    } else if (what < 224) {
      for (unsigned ms = (what - 159U) * 4U; ms > 0; --ms) board.step();
    } else {
      for (unsigned count = what - 223U; count > 0; --count) board.receive(script.byte());
    }
    board.step();
  }
  for (int i = 0; i < 1000; ++i) board.step();
  return 0;
}

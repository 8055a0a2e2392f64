// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "thermorig/core/time.h"

namespace thermorig::io {

/// An I2C bus: this computer's, or a test's.
class I2cBus {
 public:
  virtual ~I2cBus() = default;

  /// Writes to the device at that address, then reads behind a repeated start; one of both may be empty. What
  /// errno says, 0 if all went well. May take as long as the bytes need, or the bus's time-out.
  virtual int transfer(std::uint8_t device, std::span<const std::uint8_t> written,
                       std::span<std::uint8_t> read) = 0;
};

/// Reads a thermal sensor on a bus, and makes a stream of bytes of what it holds: protocols/mlx_raw.md. An
/// MLX90640 at 0x33 or an MLX90642 at 0x66. Nothing is written to either but the MLX90640's registers from
/// 0x8000 on, which it forgets when it is switched off. It has no thread and no clock of its own: its owner
/// calls turn() when it is due.
class I2cCamera {
 public:
  using Clock = std::function<HostTime()>;
  using Send = std::function<void(std::span<const std::uint8_t>)>;

  /// `name`: of the bus, for errors.
  I2cCamera(I2cBus& bus, std::string name, Clock clock, Send send);

  /// Asks which sensor is there. Throws Error(device_missing) if none answers, or one that does not measure
  /// temperatures by itself.
  void find();

  /// What the program writes: commands of protocols/mlx_raw.h. All else is not understood and left out.
  void hear(std::span<const std::uint8_t> bytes);

  /// Does what is due now, and says when it wants the next turn. Nothing: the sensor or its bus is gone, and
  /// why_gone() says why.
  std::optional<HostTime> turn();
  const std::string& why_gone() const { return why_gone_; }

 private:
  struct Sensor;
  static const Sensor mlx90640, mlx90642;

  bool answers(const Sensor& sensor);
  void check_mlx90642();
  int due_work();
  int send_eeprom();
  int set_rate();
  int look_for_data();
  int read_measurement();
  bool is_fast_enough(unsigned rate) const;
  void pause_if_too_slow();
  std::optional<HostTime> failed(int error, HostTime begin);

  int read_words(std::uint16_t address, std::span<std::uint8_t> bytes);
  int read_word(std::uint16_t address, std::uint16_t& word);
  int write_word(std::uint16_t address, std::uint16_t word);
  int read_long(std::uint16_t address, std::size_t words);
  void begin_message(std::uint8_t kind);
  void end_message();

  I2cBus& bus_;
  std::string name_;
  Clock clock_;
  Send send_;
  const Sensor* sensor_ = nullptr;
  std::size_t piece_bytes_;  // read at once: some bridges take no more than 512
  std::string heard_;        // of a command that has not ended
  std::vector<std::uint8_t> message_;

  std::optional<unsigned> wanted_rate_;  // the register's digit
  bool owes_eeprom_ = true;
  bool is_settling_ = false;  // what is under way was begun before a setting was changed
  bool is_paused_ = false;    // its bus is too slow
  unsigned rate_ = 0;         // that it has: 0.5 a second, doubled so often
  double reading_s_ = std::numeric_limits<double>::infinity();  // a measurement takes at least
  HostTime next_{};
  std::optional<HostTime> failing_since_;
  std::string why_gone_;
};

}  // namespace thermorig::io

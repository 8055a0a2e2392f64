// SPDX-License-Identifier: MIT
// Source of addresses and bits: protocols/mlx_raw.md, from the data sheet of the MLX90640 (11.1, "Measurement
// flow") and the maker's driver of the MLX90642.
#include "thermorig/io/i2c_camera.h"

#include <fmt/format.h>
#include <mlx_raw.h>

#include <algorithm>
#include <cerrno>
#include <cmath>
#include <cstring>
#include <utility>

#include "thermorig/core/error.h"

namespace thermorig::io {

/// Where a sensor keeps what, and how its addresses count.
struct I2cCamera::Sensor {
  const char* name;
  std::uint8_t address;
  std::uint16_t status, new_data;  // its register, and the bit that says so
  std::uint16_t memory;            // of the measurement
  std::size_t memory_words;
  std::size_t bytes_per_address;
  std::uint8_t kind;  // of the message
};
const I2cCamera::Sensor I2cCamera::mlx90640{"MLX90640", 0x33, 0x8000, 0x0008, 0x0400, 832, 2, MLX_RAW_HALF};
const I2cCamera::Sensor I2cCamera::mlx90642{"MLX90642", 0x66, 0x3C14, 0x0100, 0x342C, 769, 1, MLX_RAW_IMAGE};

namespace {

constexpr std::uint16_t eeprom_address = 0x2400, control_address = 0x800D;
constexpr std::uint16_t status_cleared = 0x0030;  // memory may be overwritten; start of a measurement
constexpr std::uint16_t rate_mask = 0x0380, chess_and_subpages = 0x1001, repeats_subpage = 0x0008;
constexpr unsigned rate_shift = 7, most_rate = 7;
constexpr std::uint16_t rate_of_90642 = 0x11F0, settings_of_90642 = 0x11F4;
constexpr std::uint16_t is_no_temperature = 0x0100, measures_when_asked = 0x0800;

constexpr auto poll_period = std::chrono::milliseconds(1);
constexpr double asked_from = 0.85;  // of a period on, whether it has measured: its clock is 5 % off at most
constexpr double reading_share = 0.9;  // of a period that reading may take: later it is overwritten
constexpr auto pause = std::chrono::milliseconds(100);
constexpr auto failure_pause = std::chrono::milliseconds(20);
constexpr auto longest_failure = std::chrono::seconds(1);
constexpr int tries_at_begin = 5;  // a bridge that was just plugged in may not answer yet
constexpr std::size_t small_piece_bytes = 512;
constexpr std::size_t longest_command = 8;

double period_s(unsigned rate) {
  return std::ldexp(2.0, -static_cast<int>(rate));
}

bool is_absence(int error) {
  return error == ENXIO || error == EREMOTEIO;
}
bool is_end_of_bus(int error) {
  return error == ENODEV || error == ESHUTDOWN || error == EBADF || error == ENOENT;
}

std::uint16_t word_in(std::span<const std::uint8_t> bytes) {
  return static_cast<std::uint16_t>(bytes[0] << 8 | bytes[1]);
}
std::uint8_t high_byte(std::uint16_t word) {
  return static_cast<std::uint8_t>(word >> 8U);
}
std::uint8_t low_byte(std::uint16_t word) {
  return static_cast<std::uint8_t>(word & 0xFFU);
}

}  // namespace

I2cCamera::I2cCamera(I2cBus& bus, std::string name, Clock clock, Send send)
    : bus_(bus),
      name_(std::move(name)),
      clock_(std::move(clock)),
      send_(std::move(send)),
      piece_bytes_(2 * MLX_RAW_HALF_WORDS) {}

void I2cCamera::find() {
  for (const Sensor* sensor : {&mlx90640, &mlx90642})
    if (answers(*sensor)) {
      owes_eeprom_ = sensor == &mlx90640;
      if (sensor == &mlx90642) check_mlx90642();
      next_ = clock_();
      return;
    }
  throw Error(ExitCode::device_missing,
              "no thermal sensor answers on this bus, at 0x33 (MLX90640) or 0x66 (MLX90642)", name_,
              "check its four wires (3.3 V, ground, SDA, SCL); `i2cdetect -y " +
                  name_.substr(name_.rfind('-') + 1) + "` shows what answers");
}

bool I2cCamera::answers(const Sensor& sensor) {
  sensor_ = &sensor;
  std::uint16_t status = 0;
  int error = 0;
  for (int i = 0; i < tries_at_begin; ++i) {
    error = read_word(sensor.status, status);
    if (error == 0 || is_absence(error) || is_end_of_bus(error)) break;
  }
  if (error == 0 || is_absence(error)) return error == 0;
  throw Error(ExitCode::device_missing, fmt::format("the bus does not work: {}", std::strerror(error)), name_,
              "check that SDA and SCL are not exchanged and have their resistors to 3.3 V; unplug a bridge "
              "and plug it in again");
}

/// Its settings are in a memory that wears, so they are taken as they are.
void I2cCamera::check_mlx90642() {
  std::uint16_t rate = 0, settings = 0;
  if (read_word(rate_of_90642, rate) != 0 || read_word(settings_of_90642, settings) != 0) return;
  rate_ = std::clamp(rate & 7U, 2U, 6U);
  if ((settings & (is_no_temperature | measures_when_asked)) == 0) return;
  throw Error(ExitCode::device_missing,
              (settings & is_no_temperature) != 0 ? "this MLX90642 is set to send no temperatures"
                                                  : "this MLX90642 is set to measure only when it is asked",
              name_, "set it back with its maker's tool: continuous measurement, temperatures");
}

void I2cCamera::hear(std::span<const std::uint8_t> bytes) {
  for (const std::uint8_t byte : bytes) {
    const char c = static_cast<char>(byte);
    if (c != '\n') {
      heard_ += c;
      if (heard_.size() > longest_command) heard_.erase(0, 1);
      continue;
    }
    const std::string command = std::exchange(heard_, {});
    const std::string begin = MLX_RAW_COMMAND;
    if (command.size() <= begin.size() || !command.substr(0, command.size() - 1).ends_with(begin)) continue;
    const char digit = command.back();
    if (digit < '0' || digit > static_cast<char>('0' + most_rate)) {
      if (digit != '-') continue;
    } else {
      wanted_rate_ = static_cast<unsigned>(digit - '0');
    }
    owes_eeprom_ = sensor_ == &mlx90640;
    is_paused_ = false;
    next_ = clock_();
  }
}

std::optional<HostTime> I2cCamera::turn() {
  if (clock_() < next_) return next_;
  const HostTime begin = clock_();
  if (const int error = due_work(); error != 0) return failed(error, begin);
  failing_since_.reset();
  return next_;
}

int I2cCamera::due_work() {
  if (owes_eeprom_) return send_eeprom();
  if (wanted_rate_) return set_rate();
  if (!is_paused_) return look_for_data();
  next_ = clock_() + pause;
  return 0;
}

/// A driver may wait for seconds for an answer that does not come.
std::optional<HostTime> I2cCamera::failed(int error, HostTime begin) {
  const HostTime now = clock_();
  if (!failing_since_) failing_since_ = begin;
  if (!is_end_of_bus(error) && now - *failing_since_ < longest_failure) {
    next_ = now + failure_pause;
    return next_;
  }
  why_gone_ = is_end_of_bus(error) ? "unplugged"
              : is_absence(error)
                  ? fmt::format("the {} does not answer any more: a loose wire, or no power", sensor_->name)
                  : fmt::format("its bus does not work any more: {}", std::strerror(error));
  return std::nullopt;
}

// ---- what it does in its turns ---------------------------------------------------------------------------

int I2cCamera::send_eeprom() {
  std::uint16_t control = 0;
  if (const int error = read_word(control_address, control); error != 0) return error;
  rate_ = (control & rate_mask) >> rate_shift;
  begin_message(MLX_RAW_EEPROM);
  const HostTime begin = clock_();
  if (const int error = read_long(eeprom_address, MLX_RAW_EEPROM_WORDS); error != 0) return error;
  reading_s_ = std::min(reading_s_, to_s(clock_() - begin));
  end_message();
  owes_eeprom_ = false;
  if (!wanted_rate_ && !is_fast_enough(rate_)) {  // nobody has asked for it
    wanted_rate_ = rate_;
    while (*wanted_rate_ > 0 && !is_fast_enough(*wanted_rate_)) --*wanted_rate_;
  }
  return 0;
}

/// Also chess halves in turn, which another program may have left otherwise.
int I2cCamera::set_rate() {
  if (sensor_ == &mlx90640) {
    std::uint16_t control = 0;
    if (const int error = read_word(control_address, control); error != 0) return error;
    const unsigned others = control & ~unsigned{rate_mask} & ~unsigned{repeats_subpage};
    const auto wanted =
        static_cast<std::uint16_t>(others | chess_and_subpages | (*wanted_rate_ << rate_shift));
    if (wanted != control) {
      if (const int error = write_word(control_address, wanted); error != 0) return error;
      if (const int error = read_word(control_address, control); error != 0) return error;
      if (control != wanted) return EIO;
      is_settling_ = true;
    }
    rate_ = *wanted_rate_;
  }
  wanted_rate_.reset();
  pause_if_too_slow();
  return 0;
}

/// Nothing measured yet is fast enough.
bool I2cCamera::is_fast_enough(unsigned rate) const {
  return !std::isfinite(reading_s_) || reading_s_ <= reading_share * period_s(rate);
}

void I2cCamera::pause_if_too_slow() {
  if (is_fast_enough(rate_)) return;
  is_paused_ = true;
  begin_message(MLX_RAW_TOO_SLOW);
  for (const unsigned word : {rate_, static_cast<unsigned>(std::min(1e3 * reading_s_, 65535.0))}) {
    message_.push_back(high_byte(static_cast<std::uint16_t>(word)));
    message_.push_back(low_byte(static_cast<std::uint16_t>(word)));
  }
  end_message();
}

int I2cCamera::look_for_data() {
  std::uint16_t status = 0;
  if (const int error = read_word(sensor_->status, status); error != 0) return error;
  const HostTime seen = clock_();
  next_ = seen + poll_period;
  if ((status & sensor_->new_data) == 0) return 0;
  if (std::exchange(is_settling_, false)) return write_word(sensor_->status, status_cleared);
  begin_message(MLX_RAW_NEW_DATA);
  message_.push_back(high_byte(status));
  message_.push_back(low_byte(status));
  end_message();
  if (const int error = read_measurement(); error != 0) return error;
  next_ = std::max(next_, seen + from_s(asked_from * period_s(rate_)));
  return 0;
}

/// The bit is cleared first: if it is set again when all was read, what was read is of two measurements. An
/// MLX90642 clears it by itself when its first word is read.
int I2cCamera::read_measurement() {
  if (sensor_ == &mlx90640)
    if (const int error = write_word(sensor_->status, status_cleared); error != 0) return error;
  begin_message(sensor_->kind);
  const HostTime begin = clock_();
  if (const int error = read_long(sensor_->memory, sensor_->memory_words); error != 0) return error;
  reading_s_ = std::min(reading_s_, to_s(clock_() - begin));
  if (sensor_ == &mlx90640)
    if (const int error = read_long(control_address, 1); error != 0) return error;
  if (const int error = read_long(sensor_->status, 1); error != 0) return error;
  end_message();
  pause_if_too_slow();
  return 0;
}

// ---- words on the bus ------------------------------------------------------------------------------------

int I2cCamera::read_words(std::uint16_t address, std::span<std::uint8_t> bytes) {
  const std::array<std::uint8_t, 2> pointer{high_byte(address), low_byte(address)};
  return bus_.transfer(sensor_->address, pointer, bytes);
}

int I2cCamera::read_word(std::uint16_t address, std::uint16_t& word) {
  std::array<std::uint8_t, 2> bytes{};
  const int error = read_words(address, bytes);
  if (error == 0) word = word_in(bytes);
  return error;
}

int I2cCamera::write_word(std::uint16_t address, std::uint16_t word) {
  if (sensor_ != &mlx90640 || address < mlx90640.status)
    return EPERM;  // below it lies what the factory wrote
  const std::array<std::uint8_t, 4> bytes{high_byte(address), low_byte(address), high_byte(word),
                                          low_byte(word)};
  return bus_.transfer(sensor_->address, bytes, {});
}

/// Appends words to the message: in one piece where the bus takes that.
int I2cCamera::read_long(std::uint16_t address, std::size_t words) {
  const std::size_t begin = message_.size(), size = 2 * words;
  message_.resize(begin + size);
  for (std::size_t at = 0; at < size;) {
    const std::size_t piece = std::min(piece_bytes_, size - at);
    const int error = read_words(static_cast<std::uint16_t>(address + at / sensor_->bytes_per_address),
                                 std::span(message_).subspan(begin + at, piece));
    const bool is_too_long = error == EINVAL || error == EOPNOTSUPP || error == EMSGSIZE;
    if (is_too_long && piece > small_piece_bytes) {
      piece_bytes_ = small_piece_bytes;
      continue;
    }
    if (error != 0) return error;
    at += piece;
  }
  return 0;
}

void I2cCamera::begin_message(std::uint8_t kind) {
  message_.resize(MLX_RAW_HEADER_BYTES);
  mlx_raw_header(message_.data(), kind, mlx_raw_words(kind));
}

void I2cCamera::end_message() {
  const std::uint16_t sum = mlx_raw_sum(0, message_.data(), message_.size());
  message_.push_back(high_byte(sum));
  message_.push_back(low_byte(sum));
  send_(message_);
}

}  // namespace thermorig::io

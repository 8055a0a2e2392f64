// SPDX-License-Identifier: MIT
#include "checkpoint_bytes.h"

#include <zlib.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

namespace thermorig::training {

namespace {

static_assert(std::endian::native == std::endian::little, "a checkpoint holds little-endian values");

constexpr std::string_view magic = "THRCKPT1";
constexpr std::size_t header_bytes = 8 + 3 * sizeof(std::int32_t) + sizeof(std::uint64_t);
constexpr std::size_t epoch_bytes = sizeof(std::int32_t) + 6 * sizeof(double) + 1;
constexpr std::size_t crc_bytes = sizeof(std::uint32_t);

std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

class Writer {
 public:
  template <typename Value>
  void put(Value value) {
    text_.append(reinterpret_cast<const char*>(&value), sizeof(value));
  }
  void put_all(const std::vector<float>& values) {
    text_.append(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float));
  }
  void put_text(std::string_view text) { text_ += text; }
  std::string& text() { return text_; }

 private:
  std::string text_;
};

/// Reads what is known to be there.
class Reader {
 public:
  explicit Reader(std::string_view bytes) : bytes_(bytes) {}

  template <typename Value>
  Value take() {
    Value value;
    std::memcpy(&value, bytes_.data(), sizeof(value));
    bytes_.remove_prefix(sizeof(value));
    return value;
  }
  std::vector<float> take_all(std::size_t count) {
    std::vector<float> values(count);
    std::memcpy(values.data(), bytes_.data(), count * sizeof(float));
    bytes_.remove_prefix(count * sizeof(float));
    return values;
  }
  std::size_t left() const { return bytes_.size(); }

 private:
  std::string_view bytes_;
};

void put_epoch(Writer& writer, const EpochReport& report) {
  writer.put(static_cast<std::int32_t>(report.epoch));
  for (const double value : {report.loss, report.training_mse, report.held_out_mse,
                             report.held_out_thermal_mse, report.gain_mean, report.seconds})
    writer.put(value);
  writer.put(static_cast<std::uint8_t>(report.kept));
}

EpochReport take_epoch(Reader& reader) {
  EpochReport report;
  report.epoch = reader.take<std::int32_t>();
  for (double* value : {&report.loss, &report.training_mse, &report.held_out_mse,
                        &report.held_out_thermal_mse, &report.gain_mean, &report.seconds})
    *value = reader.take<double>();
  report.kept = reader.take<std::uint8_t>() != 0;
  return report;
}

bool all_finite(const std::vector<float>& values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}

bool is_sound(const Checkpoint& checkpoint, const TrainingConfig& config) {
  for (const auto* values : {&checkpoint.weights.values, &checkpoint.kept.values, &checkpoint.optimiser.first,
                             &checkpoint.optimiser.second})
    if (!all_finite(*values)) return false;
  for (std::size_t i = 0; i < checkpoint.epochs.size(); ++i)
    if (checkpoint.epochs[i].epoch != static_cast<int>(i) + 1) return false;
  return 1 <= checkpoint.epoch && checkpoint.epoch <= config.epochs && 0 <= checkpoint.epoch_kept &&
         checkpoint.epoch_kept <= checkpoint.epoch;
}

std::size_t fixed_bytes(const TrainingConfig& config) {
  return header_bytes + 4 * network::weight_count(config.shape) * sizeof(float) + crc_bytes;
}

}  // namespace

std::string checkpoint_bytes(const Checkpoint& checkpoint) {
  Writer writer;
  writer.put_text(magic);
  writer.put(static_cast<std::int32_t>(checkpoint.epoch));
  writer.put(static_cast<std::int32_t>(checkpoint.epoch_kept));
  writer.put(static_cast<std::int32_t>(checkpoint.epochs.size()));
  writer.put(checkpoint.optimiser.steps);
  for (const auto* values : {&checkpoint.weights.values, &checkpoint.kept.values, &checkpoint.optimiser.first,
                             &checkpoint.optimiser.second})
    writer.put_all(*values);
  for (const EpochReport& report : checkpoint.epochs) put_epoch(writer, report);
  writer.put(crc_of(writer.text()));
  return std::move(writer.text());
}

std::size_t checkpoint_bytes_max(const TrainingConfig& config) {
  return fixed_bytes(config) + static_cast<std::size_t>(config.epochs) * epoch_bytes;
}

std::optional<Checkpoint> checkpoint_from(std::string_view bytes, const TrainingConfig& config) {
  if (bytes.size() < fixed_bytes(config) || !bytes.starts_with(magic)) return std::nullopt;
  const std::string_view body = bytes.substr(0, bytes.size() - crc_bytes);
  if (Reader(bytes.substr(body.size())).take<std::uint32_t>() != crc_of(body)) return std::nullopt;
  Reader reader(body.substr(magic.size()));
  Checkpoint checkpoint;
  checkpoint.epoch = reader.take<std::int32_t>();
  checkpoint.epoch_kept = reader.take<std::int32_t>();
  const auto epochs = reader.take<std::int32_t>();
  checkpoint.optimiser.steps = reader.take<std::uint64_t>();
  checkpoint.weights.shape = checkpoint.kept.shape = config.shape;
  for (auto* values : {&checkpoint.weights.values, &checkpoint.kept.values, &checkpoint.optimiser.first,
                       &checkpoint.optimiser.second})
    *values = reader.take_all(network::weight_count(config.shape));
  if (epochs != checkpoint.epoch || epochs < 0 ||
      reader.left() != static_cast<std::size_t>(epochs) * epoch_bytes)
    return std::nullopt;
  for (std::int32_t i = 0; i < epochs; ++i) checkpoint.epochs.push_back(take_epoch(reader));
  return is_sound(checkpoint, config) ? std::optional(checkpoint) : std::nullopt;
}

}  // namespace thermorig::training

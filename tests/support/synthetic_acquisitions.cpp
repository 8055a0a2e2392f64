// SPDX-License-Identifier: MIT
#include "synthetic_acquisitions.h"

#include <fmt/format.h>

#include <cmath>
#include <vector>

#include "thermorig/core/frame.h"

namespace thermorig::synthetic {

namespace {

using network::Acquisition;

constexpr double field_of_view_deg = 55.0;

/// splitmix64 (Vigna): the same numbers with every standard library.
class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t bits() {
    state_ += 0x9E3779B97F4A7C15ULL;
    std::uint64_t mixed = state_;
    mixed = (mixed ^ (mixed >> 30U)) * 0xBF58476D1CE4E5B9ULL;
    mixed = (mixed ^ (mixed >> 27U)) * 0x94D049BB133111EBULL;
    return mixed ^ (mixed >> 31U);
  }

  double uniform(double low, double high) {
    return low + (high - low) * (static_cast<double>(bits() >> 11U) * 0x1.0p-53);
  }

  /// About normal, deviation 1: the sum of twelve uniform ones, which needs no logarithm.
  double normal() {
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform(0.0, 1.0);
    return sum;
  }

 private:
  std::uint64_t state_;
};

/// Warm and cold bumps all around the rig, as a picture of 24 rows and 4 columns a degree.
class Scene {
 public:
  explicit Scene(Random& random) : temp_c_(frame_rows * columns, 22.0F) {
    for (int bump = 0; bump < 150; ++bump) add_bump(random);
  }

  double temp_c(double azimuth_deg, std::size_t row) const {
    const double place = (azimuth_deg - 360.0 * std::floor(azimuth_deg / 360.0)) * columns_per_deg;
    const auto left = static_cast<std::size_t>(place);
    const double share = place - static_cast<double>(left);
    return (1.0 - share) * at(row, left) + share * at(row, left + 1);
  }

 private:
  static constexpr int columns_per_deg = 4;
  static constexpr std::size_t columns = 360 * columns_per_deg;

  void add_bump(Random& random) {
    const double azimuth_deg = random.uniform(0.0, 360.0), middle_row = random.uniform(0.0, frame_rows);
    const double width = random.uniform(4.0, 9.0), height_c = random.uniform(-8.0, 8.0);
    const auto first = static_cast<std::size_t>((azimuth_deg + 360.0 - width) * columns_per_deg);
    for (std::size_t row = 0; row < frame_rows; ++row)
      for (std::size_t column = first; column < first + 2 * columns_per_deg * 9; ++column) {
        const double across = (static_cast<double>(column) / columns_per_deg - azimuth_deg - 360.0) / width;
        const double down = (static_cast<double>(row) - middle_row) / width;
        const double inside = 1.0 - across * across - down * down;
        if (inside > 0.0) at(row, column) += static_cast<float>(height_c * inside * inside);
      }
  }

  float& at(std::size_t row, std::size_t column) { return temp_c_[row * columns + column % columns]; }
  float at(std::size_t row, std::size_t column) const { return temp_c_[row * columns + column % columns]; }

  std::vector<float> temp_c_;
};

/// Writes an acquisition frame by frame while the rig turns.
class Turning {
 public:
  Turning(Acquisition& acquisition, const AcquisitionConfig& config, std::uint64_t seed)
      : acquisition_(acquisition), config_(config), random_(seed), scene_(random_) {
    bias_dps_ = static_cast<float>(config.gyro_bias_dps * random_.normal());
    acquisition.rates = {{"gyro", {}}, {"gyro-rest", {}}};
  }

  void leg(float rate_dps, std::uint32_t run) {
    for (int frame = -2; frame < config_.frames_per_leg; ++frame) add_frame(rate_dps, frame < 0 ? 0 : run);
  }

 private:
  void add_frame(float rate_dps, std::uint32_t run) {
    add_pixels();
    const auto noise_dps = static_cast<float>(config_.gyro_noise_dps * random_.normal());
    acquisition_.label_dps.push_back(rate_dps);
    acquisition_.gyro_dps.push_back(rate_dps + bias_dps_ + noise_dps);
    acquisition_.rates[0].rate_dps.push_back(acquisition_.gyro_dps.back());
    acquisition_.rates[1].rate_dps.push_back(rate_dps + noise_dps);
    acquisition_.time.push_back(HostTime(from_s(time_s_)));
    acquisition_.run.push_back(run);
    acquisition_.leg_rate_dps.push_back(rate_dps);
    azimuth_deg_ += rate_dps * config_.frame_period_s;
    time_s_ += config_.frame_period_s;
  }

  void add_pixels() {
    for (std::size_t row = 0; row < frame_rows; ++row)
      for (std::size_t column = 0; column < frame_columns; ++column) {
        const double offset_deg = field_of_view_deg * (static_cast<double>(column) / frame_columns - 0.5);
        const double noise_c = config_.temp_noise_c * random_.normal();
        acquisition_.temp_c.push_back(
            static_cast<float>(scene_.temp_c(azimuth_deg_ + offset_deg, row) + noise_c));
      }
  }

  Acquisition& acquisition_;
  const AcquisitionConfig& config_;
  Random random_;
  Scene scene_;
  float bias_dps_ = 0.0F;
  double azimuth_deg_ = 0.0, time_s_ = 100.0;
};

}  // namespace

Acquisition make_acquisition(const std::string& environment, int number, std::uint64_t seed,
                             const AcquisitionConfig& config) {
  Acquisition acquisition{.name = fmt::format("{}_acq-{:02}", environment, number),
                          .environment = environment,
                          .number = number,
                          .simulated = true,
                          .licence = "not stated",
                          .hash = fmt::format("{:064x}", seed)};
  Turning turning(acquisition, config, seed);
  std::uint32_t run = 0;
  for (const float rate_dps : config.rates_dps) turning.leg(rate_dps, ++run);
  return acquisition;
}

std::vector<Acquisition> make_acquisitions(const std::vector<std::string>& environments, int count,
                                           std::uint64_t seed, const AcquisitionConfig& config) {
  std::vector<Acquisition> acquisitions;
  for (const std::string& environment : environments)
    for (int number = 1; number <= count; ++number)
      acquisitions.push_back(
          make_acquisition(environment, number, 1000 * seed + acquisitions.size(), config));
  return acquisitions;
}

}  // namespace thermorig::synthetic

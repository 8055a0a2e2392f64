// SPDX-License-Identifier: MIT
#include "room.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

#include "support/at_s.h"

namespace thermorig::odometer {

namespace {

constexpr double frame_period_s = 0.125, gyro_period_s = 0.005;
constexpr double pitch_deg = 55.0 / 32.0;
constexpr int steps_a_degree = 10, exposed_steps = 10, waves = 40;

/// Temperatures of the 24 rows by azimuth.
class Walls {
 public:
  explicit Walls(const Room& room) {
    std::mt19937 random(room.walls);
    std::uniform_real_distribution<double> phase(0.0, 2.0 * std::numbers::pi);
    std::array<double, waves> phases{};
    for (std::size_t row = 0; row < frame_rows; ++row) {
      if (row % 4 == 0)  // rows that lie side by side show the same things
        for (double& one : phases) one = phase(random);
      for (int step = 0; step < 360 * steps_a_degree; ++step) {
        double sum = 0.0;
        for (int wave = 1; wave <= waves; ++wave)
          sum += std::sin(wave * 2.0 * std::numbers::pi * step / (360.0 * steps_a_degree) +
                          phases[static_cast<std::size_t>(wave - 1)]) /
                 std::sqrt(wave);
        temp_c_.push_back(static_cast<float>(22.0 + room.contrast_k * sum));
      }
    }
  }

  float at(std::size_t row, double azimuth_deg) const {
    const double turns = azimuth_deg / 360.0;
    const auto step = static_cast<std::size_t>((turns - std::floor(turns)) * 360.0 * steps_a_degree);
    return temp_c_[row * 360 * steps_a_degree + step];
  }

 private:
  std::vector<float> temp_c_;
};

/// Of a mirrored camera: columns grow to the left.
float shown_c(const Walls& walls, const Room& room, std::size_t row, std::size_t column, double end_s) {
  const double done = static_cast<double>(row) / (frame_rows - 1);  // of the frame, when the row's turn ends
  end_s -= frame_period_s * (room.rolling > 0.0 ? room.rolling * (1.0 - done) : -room.rolling * done);
  const double beside = static_cast<double>(column) - 15.5, below = static_cast<double>(row) - 11.5;
  const double rolled = std::tan(room.roll_deg * std::numbers::pi / 180.0) * below;  // pixels
  const double looks_deg = -pitch_deg * (1.0 + room.wider) * (beside + rolled);
  float sum = 0.0F;
  for (int i = 0; i < exposed_steps; ++i) {
    const double time_s = end_s - room.latency_s - frame_period_s * (i + 0.5) / exposed_steps;
    sum += walls.at(row, room.angle_deg(time_s) + looks_deg);
  }
  return sum / static_cast<float>(exposed_steps);
}

}  // namespace

std::vector<Seen> seen_in(const Room& room) {
  const Walls walls(room);
  std::mt19937 random(room.noise);
  std::normal_distribution<double> normal;
  std::vector<Seen> all;
  ThermalFrame shown;
  double gyro_s = 0.0;
  for (unsigned index = 0; (index + 2) * frame_period_s <= room.duration_s; ++index) {
    const double end_s = (index + 2) * frame_period_s;
    const unsigned parity = index & 1U;
    for (std::size_t row = 0; row < frame_rows; ++row)
      for (std::size_t column = 0; column < frame_columns; ++column)
        if (subpage_of(row, column) == parity)
          shown.temp_c[row * frame_columns + column] =
              shown_c(walls, room, row, column, end_s) + static_cast<float>(room.noise_k * normal(random));
    Seen seen;
    seen.frame.frame = shown;
    seen.frame.exposure_begin = at_s(end_s - 2.0 * frame_period_s);
    seen.frame.exposure_end = seen.frame.stamp.time = at_s(end_s);
    seen.frame.half[parity] = {at_s(end_s - frame_period_s), at_s(end_s)};
    seen.frame.half[parity ^ 1U] = {at_s(end_s - 2.0 * frame_period_s), at_s(end_s - frame_period_s)};
    (parity == 0 ? seen.frame.fresh_even : seen.frame.fresh_odd) = 384;
    for (; gyro_s + 0.5 * gyro_period_s <= end_s; gyro_s += gyro_period_s) {
      const double turned_deg = room.angle_deg(gyro_s + gyro_period_s) - room.angle_deg(gyro_s);
      TimedGyro sample;
      sample.stamp.time = at_s(gyro_s + 0.5 * gyro_period_s);
      sample.rate_dps = static_cast<float>(room.scale * turned_deg / gyro_period_s + room.bias_dps +
                                           room.gyro_noise_dps * normal(random));
      sample.reading.rate_dps = {0.0F, 0.0F, sample.rate_dps};
      seen.gyro.push_back(sample);
    }
    all.push_back(std::move(seen));
  }
  return all;
}

RowOrder rows_of(const Room& room) {
  if (room.rolling == 0.0) return RowOrder::at_once;
  return room.rolling > 0.0 ? RowOrder::first_to_last : RowOrder::last_to_first;
}

std::function<double(double)> to_and_fro(double reach_deg, double rate_dps) {
  return [=](double time_s) {
    return reach_deg * std::sin(0.6 * rate_dps / reach_deg * time_s) +
           0.25 * rate_dps * std::sin(2.0 * time_s);
  };
}

Room turning_room(double duration_s) {
  Room room;
  room.duration_s = duration_s;
  room.angle_deg = to_and_fro(200.0, 60.0);
  return room;
}

Room with_steady_speed(Room room, double from_s, double rate_dps) {
  room.angle_deg = [from_s, rate_dps, turning = room.angle_deg](double time_s) {
    return turning(std::min(time_s, from_s)) + rate_dps * std::max(0.0, time_s - from_s);
  };
  return room;
}

void change_walls(Room room, double from_s, float share, std::vector<Seen>& all) {
  ++room.walls;
  const std::vector<Seen> other = seen_in(room);
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].frame.exposure_end < at_s(from_s)) continue;
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel) {
      float& temp_c = all[i].frame.frame.temp_c[pixel];
      temp_c += share * (other[i].frame.frame.temp_c[pixel] - temp_c);
    }
  }
}

void make_early(std::vector<Seen>& all, double from_s, double until_s) {
  for (Seen& seen : all) {
    if (seen.frame.exposure_end < at_s(from_s) || seen.frame.exposure_end > at_s(until_s)) continue;
    for (HalfExposure& half : seen.frame.half) {
      half.begin -= std::chrono::milliseconds(125);
      half.end -= std::chrono::milliseconds(125);
    }
  }
}

Room with_rest(Room room, double from_s, double rest_s) {
  room.duration_s += rest_s;
  room.angle_deg = [from_s, rest_s, turning = room.angle_deg](double time_s) {
    return turning(time_s < from_s ? time_s : std::max(from_s, time_s - rest_s));
  };
  return room;
}

void let_walk(const Room& room, double rate_dps, std::vector<Seen>& all, double from_s) {
  for (std::size_t i = static_cast<std::size_t>(from_s / frame_period_s) - 1; i < all.size(); ++i) {
    ThermalFrame& frame = all[i].frame.frame;
    for (std::size_t row = 4; row < frame_rows; ++row)
      for (std::size_t column = 0; column < frame_columns; ++column) {
        const bool is_new = subpage_of(row, column) == (all[i].frame.fresh_even > 0 ? 0U : 1U);
        const double middle_s = frame_period_s * (static_cast<double>(i + (is_new ? 2 : 1)) - 0.5);
        const double looks_deg = room.angle_deg(middle_s) + pitch_deg * (15.5 - static_cast<double>(column));
        const double off_deg = std::remainder(looks_deg - rate_dps * middle_s, 360.0);
        if (std::abs(off_deg) < 7.0) frame.temp_c[row * frame_columns + column] += 6.0F;
      }
  }
}

Room faint_room(double duration_s, double contrast_k) {
  Room room = turning_room(duration_s);
  room.angle_deg = to_and_fro(250.0, 120.0);
  room.contrast_k = contrast_k;
  room.walls = 9;
  return room;
}

}  // namespace thermorig::odometer

// SPDX-License-Identifier: MIT
// Rooms as they might be; every figure is a guess at what rooms and cameras have in common, none is measured
// and none is the simulated rig's, which judges what is learnt here.
#include "made_panorama.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace thermorig::training {

namespace {

using Values = MadePanorama::Values;
constexpr int columns = MadePanorama::columns, rows = MadePanorama::rows;
constexpr double column_deg = MadePanorama::column_deg;

float* row_of(Values& values, int row) {
  return values.data() + static_cast<std::size_t>(row) * columns;
}

const float* row_of(const Values& values, int row) {
  return values.data() + static_cast<std::size_t>(row) * columns;
}

int wrapped(int column) {
  return (column % columns + columns) % columns;
}

double either_sign(Draw& draw, double size) {
  return draw.happens(0.5) ? size : -size;
}

/// Adds noise on a grid of `across` by `down` random values, interpolated smoothly.
void add_octave(Draw& draw, int across, double cell_rows, double size, Values& values) {
  const int down = static_cast<int>(rows / cell_rows) + 3;
  std::vector<float> grid(static_cast<std::size_t>(across) * static_cast<std::size_t>(down));
  for (float& value : grid) value = static_cast<float>(size * draw.uniform(-1.0, 1.0));
  const double offset = draw.share();
  std::vector<float> line(static_cast<std::size_t>(across) + 1);
  const auto smooth = [](double part) { return static_cast<float>(part * part * (3.0 - 2.0 * part)); };
  for (int row = 0; row < rows; ++row) {
    const double place = row / cell_rows + offset;
    const auto above = static_cast<std::size_t>(place);
    const float part = smooth(place - static_cast<double>(above));
    const float* const low = grid.data() + above * static_cast<std::size_t>(across);
    for (std::size_t i = 0; i < static_cast<std::size_t>(across); ++i)
      line[i] = low[i] + part * (low[i + static_cast<std::size_t>(across)] - low[i]);
    line.back() = line.front();
    float* const out = row_of(values, row);
    const double step = static_cast<double>(across) / columns;
    for (int column = 0; column < columns; ++column) {
      const double at = column * step;
      const auto left = static_cast<std::size_t>(at);
      out[column] += line[left] + smooth(at - static_cast<double>(left)) * (line[left + 1] - line[left]);
    }
  }
}

void make_unit(Values& values) {
  double sum = 0.0, squares = 0.0;
  for (const float value : values) {
    sum += value;
    squares += static_cast<double>(value) * value;
  }
  const auto count = static_cast<double>(values.size());
  const double mean = sum / count;
  const double deviation = std::sqrt(std::max(squares / count - mean * mean, 1e-12));
  for (float& value : values) value = static_cast<float>((value - mean) / deviation);
}

/// Amplitudes fall with the frequency to a power of 0.5 to 2, above some hundredths of a cycle a degree.
Values texture(Draw draw) {
  Values values(static_cast<std::size_t>(rows) * columns);
  const double power = draw.uniform(0.5, 2.0), stretch = std::exp(draw.uniform(-1.1, 1.1));
  for (double cell_deg = 0.5 / draw.uniform(0.01, 0.05); cell_deg > 0.7; cell_deg /= 2.0) {
    const int across = std::clamp(static_cast<int>(360.0 / (cell_deg * stretch)), 2, columns);
    add_octave(draw, across, std::max(cell_deg / stretch / 0.75, 1.0), std::pow(cell_deg, power - 1.0),
               values);
  }
  make_unit(values);
  return values;
}

class Room {
 public:
  Room(Draw& draw, const std::vector<Values>& textures, double row_deg)
      : draw_(draw),
        textures_(textures),
        row_deg_(row_deg),
        values_(static_cast<std::size_t>(rows) * columns) {}

  Values make(double pixel_deg) {
    add_texture();
    add_gradients();
    if (draw_.happens(0.6)) add_horizon();
    if (draw_.happens(0.2)) add_horizon();
    for (std::uint64_t mask = draw_.below(3); mask > 0; --mask) add_mask();
    if (draw_.happens(0.92))
      for (int shape = static_cast<int>(draw_.magnitude(1.0, 61.0)); shape > 0; --shape) add_shape();
    if (draw_.happens(0.4))
      for (std::uint64_t body = 1 + draw_.below(4); body > 0; --body) add_body();
    blur(draw_.uniform(0.45, 0.75) * pixel_deg);
    return std::move(values_);
  }

 private:
  double elevation_deg(int row) const { return (row - 0.5 * (rows - 1)) * row_deg_; }

  /// One of the textures, shifted and perhaps flipped: its value at a column of a row.
  struct Shifted {
    const Values* values;
    int shift, direction;
    float at(int row, int column) const { return row_of(*values, row)[wrapped(shift + direction * column)]; }
  };
  Shifted drawn_texture() {
    return {&textures_[draw_.below(textures_.size())], static_cast<int>(draw_.below(columns)),
            draw_.happens(0.5) ? 1 : -1};
  }

  template <class Change>
  void for_all(Change change) {
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) change(row_of(values_, row)[column], row, column);
  }

  void add_texture() {
    const Shifted texture = drawn_texture();
    const auto size = static_cast<float>(either_sign(draw_, draw_.magnitude(0.05, 3.0)));
    for_all([&](float& value, int row, int column) { value += size * texture.at(row, column); });
  }

  /// Sums of waves all around, by column.
  std::vector<float> waves(int harmonics, double size, double power) {
    std::vector<float> sum(columns);
    for (int n = 1; n <= harmonics; ++n) {
      const double amplitude = size * draw_.normal() / std::pow(n, power), phase = draw_.uniform(0.0, 6.283);
      for (int column = 0; column < columns; ++column)
        sum[static_cast<std::size_t>(column)] +=
            static_cast<float>(amplitude * std::cos(2.0 * std::numbers::pi * n * column / columns + phase));
    }
    return sum;
  }

  void add_gradients() {
    const double slope = 0.06 * draw_.normal();
    const std::vector<float> around = waves(6, draw_.magnitude(0.05, 1.5), 1.0);
    for_all([&](float& value, int row, int column) {
      value += static_cast<float>(slope * elevation_deg(row)) + around[static_cast<std::size_t>(column)];
    });
  }

  /// Sky, a ceiling, hills: warmer or colder above a line that goes up and down.
  void add_horizon() {
    const double height_deg = 10.0 * draw_.normal(), size = either_sign(draw_, draw_.magnitude(0.3, 12.0));
    const std::vector<float> line = waves(24, draw_.magnitude(0.1, 5.0), 0.5);
    const double more = draw_.uniform(-1.0, 1.0);
    for_all([&](float& value, int row, int column) {
      const double above = elevation_deg(row) - height_deg - line[static_cast<std::size_t>(column)];
      if (above > 0.0) value += static_cast<float>(size * (1.0 + more * (1.0 - std::exp(-above / 20.0))));
    });
  }

  void add_mask() {
    const Shifted texture = drawn_texture();
    const double least = 1.2 * draw_.normal(), from_deg = draw_.uniform(-40.0, 20.0);
    const double to_deg = from_deg + draw_.uniform(10.0, 60.0);
    const auto size = static_cast<float>(either_sign(draw_, draw_.magnitude(0.3, 10.0)));
    for (int row = 0; row < rows; ++row) {
      if (elevation_deg(row) < from_deg || elevation_deg(row) > to_deg) continue;
      for (int column = 0; column < columns; ++column)
        if (texture.at(row, column) > least) row_of(values_, row)[column] += size;
    }
  }

  /// `inside`: from -1 to 1 across and up, to a weight. Replaces what is there by `size`, or adds.
  template <class Inside>
  void paint(double azimuth_deg, double height_deg, double width_deg, double tall_deg, double size,
             bool replaces, Inside inside) {
    const double reach_columns = 0.5 * width_deg / column_deg, middle = azimuth_deg / column_deg;
    const double reach_rows = 0.5 * tall_deg / row_deg_,
                 middle_row = height_deg / row_deg_ + 0.5 * (rows - 1);
    const int first_row = std::max(0, static_cast<int>(std::ceil(middle_row - reach_rows)));
    const int last_row = std::min(rows - 1, static_cast<int>(std::floor(middle_row + reach_rows)));
    for (int row = first_row; row <= last_row; ++row)
      for (int column = static_cast<int>(std::ceil(middle - reach_columns));
           column <= static_cast<int>(std::floor(middle + reach_columns)); ++column) {
        const double weight = inside((column - middle) / reach_columns, (row - middle_row) / reach_rows);
        if (weight <= 0.0) continue;
        float& value = row_of(values_, row)[wrapped(column)];
        value = static_cast<float>(replaces ? size : value + weight * size);
      }
  }

  void add_shape() {
    const double kind = draw_.share();
    const double size = draw_.magnitude(0.2, 6.0) * draw_.normal() * std::exp(0.6 * draw_.normal());
    const double width = kind > 0.85 ? draw_.magnitude(0.5, 4.0) : draw_.magnitude(0.8, 40.0);
    const double tall = draw_.magnitude(1.5, 50.0), azimuth = draw_.uniform(0.0, 360.0);
    const double height = draw_.uniform(-0.5, 0.5) * rows * row_deg_;
    const bool is_spot = kind > 0.65 && kind <= 0.85, is_ellipse = kind > 0.45 && kind <= 0.65;
    const bool replaces = !is_spot && draw_.happens(0.3);
    if (is_spot)
      return paint(azimuth, height, 2.0 * width, 2.0 * tall, size, false,
                   [](double x, double y) { return std::exp(-4.5 * (x * x + y * y)); });
    if (is_ellipse)
      return paint(azimuth, height, width, tall, size, replaces,
                   [](double x, double y) { return 1.0 - x * x - y * y > 0.0 ? 1.0 : 0.0; });
    paint(azimuth, height, width, tall, size, replaces, [](double, double) { return 1.0; });
  }

  void add_body() {
    const double size = draw_.uniform(3.0, 12.0), width = draw_.uniform(4.0, 22.0);
    const double azimuth = draw_.uniform(0.0, 360.0), tall = 3.0 * width, height = draw_.uniform(-25.0, 5.0);
    const auto round = [](double x, double y) { return 1.0 - x * x - y * y > 0.0 ? 1.0 : 0.0; };
    paint(azimuth, height - 0.5 * tall, width, tall, size, false, round);
    paint(azimuth, height + 0.2 * width, 0.4 * width, 0.5 * width, size, false, round);
  }

  static std::vector<float> bell(double deviation) {
    const int reach = static_cast<int>(std::ceil(2.5 * deviation));
    std::vector<float> weights(2 * static_cast<std::size_t>(reach) + 1);
    double sum = 0.0;
    for (int i = -reach; i <= reach; ++i) sum += std::exp(-0.5 * i * i / (deviation * deviation));
    for (int i = -reach; i <= reach; ++i)
      weights[static_cast<std::size_t>(i + reach)] =
          static_cast<float>(std::exp(-0.5 * i * i / (deviation * deviation)) / sum);
    return weights;
  }

  /// Optics: by a bell both ways.
  void blur(double deviation_deg) {
    const std::vector<float> across = bell(deviation_deg / column_deg), up = bell(deviation_deg / row_deg_);
    const int reach = static_cast<int>(across.size() / 2), reach_up = static_cast<int>(up.size() / 2);
    Values once(values_.size());
    std::vector<float> line(static_cast<std::size_t>(columns + 2 * reach));
    for (int row = 0; row < rows; ++row) {
      const float* const in = row_of(values_, row);
      for (int i = 0; i < columns + 2 * reach; ++i)
        line[static_cast<std::size_t>(i)] = in[wrapped(i - reach)];
      float* const out = row_of(once, row);
      for (std::size_t tap = 0; tap < across.size(); ++tap)
        for (int column = 0; column < columns; ++column)
          out[column] += across[tap] * line[static_cast<std::size_t>(column) + tap];
    }
    std::fill(values_.begin(), values_.end(), 0.0F);
    for (int row = 0; row < rows; ++row)
      for (int tap = -reach_up; tap <= reach_up; ++tap) {
        const float* const in = row_of(once, std::clamp(row + tap, 0, rows - 1));
        const float weight = up[static_cast<std::size_t>(tap + reach_up)];
        float* const out = row_of(values_, row);
        for (int column = 0; column < columns; ++column) out[column] += weight * in[column];
      }
  }

  Draw& draw_;
  const std::vector<Values>& textures_;
  double row_deg_;
  Values values_;
};

}  // namespace

std::vector<Values> MadePanorama::textures(std::uint64_t seed, std::uint64_t block) {
  std::vector<Values> made;
  for (std::uint64_t i = 0; i < textures_a_block; ++i)
    made.push_back(texture(Draw(seed, "texture", block * textures_a_block + i)));
  return made;
}

MadePanorama::MadePanorama(Draw& draw, const std::vector<Values>& textures, double view_width_deg)
    : sums_(static_cast<std::size_t>(rows) * (columns + 1)) {
  const Values values =
      Room(draw, textures, row_deg(view_width_deg)).make(view_width_deg / static_cast<double>(frame_columns));
  for (int row = 0; row < rows; ++row) {
    double sum = 0.0;
    float* const sums = sums_.data() + static_cast<std::size_t>(row) * (columns + 1);
    for (int column = 0; column < columns; ++column) {
      sum += row_of(values, row)[column];
      sums[column + 1] = static_cast<float>(sum);
    }
  }
}

MadeCamera::MadeCamera(Draw& draw, const network::CameraView& view) {
  const double roll = 2.0 * draw.normal() * std::numbers::pi / 180.0, tilt_deg = 3.0 * draw.normal();
  const double zoom = 1.0 + 0.01 * draw.normal();
  const double distortion = draw.happens(0.5) ? draw.uniform(-0.06, 0.06) : 0.0;
  const double noise = draw.magnitude(0.15, 0.9), corner = draw.uniform(1.0, 1.6);
  const double fixed = draw.uniform(0.0, 0.25), of_columns = draw.uniform(0.0, 0.08);
  const double chess = draw.uniform(-0.2, 0.2);
  half_offset_c = draw.uniform(0.0, 0.15);
  lag_s = draw.uniform(0.004, 0.025);
  const double side = view.mirrored ? -1.0 : 1.0;
  std::array<double, frame_columns> column_c{};
  for (double& of_column : column_c) of_column = of_columns * draw.normal();
  for (std::size_t y = 0; y < frame_rows; ++y)
    for (std::size_t x = 0; x < frame_columns; ++x) {
      const double u = (static_cast<double>(x) + 0.5) / (0.5 * frame_columns) - 1.0;
      const double v = 1.0 - (static_cast<double>(y) + 0.5) / (0.5 * frame_rows);
      const double square = 0.5 * (u * u + v * v);
      const double wider = zoom * (1.0 + distortion * square);
      const double across_deg = side * u * wider * 0.5 * view.width_deg;
      const double up_deg = v * wider * 0.5 * view_height_of_width * view.width_deg;
      const double azimuth_deg = across_deg * std::cos(roll) - up_deg * std::sin(roll);
      const double elevation_deg = across_deg * std::sin(roll) + up_deg * std::cos(roll) + tilt_deg;
      const std::size_t pixel = y * frame_columns + x;
      column[pixel] = static_cast<float>(azimuth_deg / MadePanorama::column_deg);
      row[pixel] = static_cast<std::uint8_t>(
          std::clamp(elevation_deg / MadePanorama::row_deg(view.width_deg) + 0.5 * MadePanorama::rows, 0.0,
                     MadePanorama::rows - 1.0));
      noise_c[pixel] = static_cast<float>(noise * (1.0 + (corner - 1.0) * square));
      pattern_c[pixel] =
          static_cast<float>(fixed * draw.normal() + column_c[x] + ((x + y) % 2 == 0 ? chess : -chess));
    }
  if (draw.happens(0.7))
    for (std::uint64_t dead = 1 + draw.below(4); dead > 0; --dead)
      pattern_c[draw.below(frame_pixels)] += static_cast<float>(draw.uniform(-35.0, 35.0));
}

}  // namespace thermorig::training

// SPDX-License-Identifier: MIT
#include "thermorig/network/turn.h"

#include <algorithm>
#include <cassert>
#include <cmath>

namespace thermorig::network {

void turn_window(std::span<const float> from, const Shape& shape, Turn turn, std::span<float> turned) {
  assert(from.size() == shape.inputs() && turned.size() == from.size());
  const int frames = shape.frames, rows = shape.rows(), columns = shape.columns();
  float* to = turned.data();
  for (int frame = 0; frame < frames; ++frame)
    for (int row = 0; row < rows; ++row, to += columns) {
      const int from_frame = turn.backwards() ? frames - 1 - frame : frame;
      const int from_row = turn.upside_down() ? rows - 1 - row : row;
      const float* const line = from.data() + (from_frame * rows + from_row) * columns;
      if (turn.mirrored())
        std::reverse_copy(line, line + columns, to);
      else
        std::copy_n(line, columns, to);
    }
}

namespace {

constexpr double surer_together = 1.5;

}  // namespace

void TurnedOutputs::add(const Output& output, Turn turn, bool fusion) {
  constexpr double least = 1e-6;  // of a gain, from either end
  const double gain = std::clamp(double{output.gain}, least, 1.0 - least);
  const double odds = fusion ? gain / (1.0 - gain) : 1.0;
  count_ += 1.0;
  odds_ += odds;
  speed_ += odds * turn.sign() * output.thermal;
  logit_ += std::log(odds);
}

Output TurnedOutputs::mean(float gyro, bool fusion) const {
  Output output;
  output.thermal = static_cast<float>(speed_ / odds_);
  output.fusion = output.thermal;
  if (!fusion) return output;
  const double odds = surer_together * std::exp(logit_ / count_);
  output.gain = static_cast<float>(odds / (1.0 + odds));
  output.fusion = fusion_of(output, gyro);
  return output;
}

}  // namespace thermorig::network

// SPDX-License-Identifier: MIT
// Windows, one after the other in memory, to cells with a sample a lane.
#include "training_functions.h"
#include "training_transpose.h"

namespace thermorig::network::THERMORIG_KERNELS {

namespace {

void copy_row(const float* in, int columns, bool mirrored, float* out) {
  if (mirrored)
    for (int x = 0; x < columns; ++x) out[x] = in[columns - 1 - x];
  else
    for (int x = 0; x < columns; ++x) out[x] = in[x];
}

}  // namespace

/// (B) times (channels, rows, columns) to (channels, rows, columns) of cells
void load_windows(const LoadJob& job, int first_row, int last_row) {
  alignas(64) float samples[cell * cell] = {};  // a row of each; a row has up to 32 columns
  for (int row = first_row; row < last_row; ++row) {
    for (int s = 0; s < job.samples; ++s)
      copy_row(job.frames[s] + static_cast<long>(row) * job.columns, job.columns,
               job.mirrored && job.mirrored[s], samples + s * cell);
    transpose(samples, job.output.first + row / job.rows * job.output.plane + row % job.rows * job.output.row,
              job.columns);
  }
}

}  // namespace thermorig::network::THERMORIG_KERNELS

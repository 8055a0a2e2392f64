// SPDX-License-Identifier: MIT
// Windows, one after the other in memory, to cells with a sample a lane.
#include "training_functions.h"

namespace thermorig::network::THERMORIG_KERNELS {

/// (B) times (channels, rows, columns) to (channels, rows, columns) of cells
void load_windows(const LoadJob& job, int first_row, int last_row) {
  for (int row = first_row; row < last_row; ++row) {
    float* const out = job.output.first + row / job.rows * job.output.plane + row % job.rows * job.output.row;
    for (int s = 0; s < cell; ++s) {
      const bool mirrored = s < job.samples && job.mirrored && job.mirrored[s];
      const float* const in =
          s < job.samples ? job.frames[s] + static_cast<long>(row) * job.columns : nullptr;
      for (int x = 0; x < job.columns; ++x)
        out[static_cast<long>(x) * cell + s] = in ? in[mirrored ? job.columns - 1 - x : x] : 0.0F;
    }
  }
}

}  // namespace thermorig::network::THERMORIG_KERNELS

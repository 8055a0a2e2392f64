// SPDX-License-Identifier: MIT
#include "training_functions.h"

namespace thermorig::network::THERMORIG_KERNELS {

const TrainingKernels training_kernels = {
    load_windows, convolve_and_pool, convolve_relu, convolve, conv1_gradient,   conv2_gradient,
    dense,        dense_gradient,    sum_cells,     readout,  readout_gradient, adam};

}  // namespace thermorig::network::THERMORIG_KERNELS

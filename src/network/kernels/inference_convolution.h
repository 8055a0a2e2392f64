// SPDX-License-Identifier: MIT
#pragma once

#include "inference_kernels.h"
#include "vector.h"

namespace thermorig::network::THERMORIG_KERNELS {

// See InferenceKernels.
void convolve_and_pool(const PoolingConvolution& layer, const float* input, float* output);
void convolve(const FeatureConvolution& layer, const float* input, float* output);

}  // namespace thermorig::network::THERMORIG_KERNELS

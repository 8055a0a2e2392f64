// SPDX-License-Identifier: MIT
#pragma once

#include "training_vector.h"

// What stands in the table of training_kernels.h, which see.

namespace thermorig::network::THERMORIG_KERNELS {

void load_windows(const LoadJob&, int first_row, int last_row);

void convolve_and_pool(const ConvolutionJob&, const Choices&, int first_row, int last_row);
void convolve_relu(const ConvolutionJob&, int first_row, int last_row);
void convolve(const ConvolutionJob&, int first_row, int last_row);
void conv1_gradient(const ConvolutionGradientJob&, int first_unit, int last_unit);
void conv2_gradient(const ConvolutionGradientJob&, int first_unit, int last_unit);

void dense(const DenseJob&, int first_tile, int last_tile);
void dense_gradient(const DenseGradientJob&, int first_block, int last_block);

void sum_cells(const float* cells, int count, float* sums);
void readout(const ReadoutJob&);
void readout_gradient(const ReadoutGradientJob&);
void adam(const AdamStep&, int count, const float* gradient, float* weights, float* first_moment,
          float* second_moment);

}  // namespace thermorig::network::THERMORIG_KERNELS

// SPDX-License-Identifier: MIT
#include "inference_kernels.h"

#include "inference_convolution.h"
#include "inference_vector.h"

namespace thermorig::network::THERMORIG_KERNELS {

namespace {

int list_nonzero(const float* values, int count, uint16_t* places) {
  int found = 0;
#if defined(__AVX512F__)
  __m512i place = _mm512_set_epi32(15, 14, 13, 12, 11, 10, 9, 8, 7, 6, 5, 4, 3, 2, 1, 0);
  for (int i = 0; i < count; i += lanes) {
    const __mmask16 inside = static_cast<__mmask16>(count - i < lanes ? (1 << (count - i)) - 1 : 0xFFFF);
    const __mmask16 kept = _mm512_mask_cmp_ps_mask(inside, load(values + i), Vector{}, _CMP_NEQ_UQ);
    const __m256i narrow = _mm512_cvtepi32_epi16(_mm512_maskz_compress_epi32(kept, place));
    _mm256_storeu_si256(reinterpret_cast<__m256i*>(places + found), narrow);
    found += __builtin_popcount(kept);
    place = _mm512_add_epi32(place, _mm512_set1_epi32(lanes));
  }
#else
  for (int i = 0; i < count; ++i) {
    places[found] = static_cast<uint16_t>(i);
    found += static_cast<int>(values[i] != 0.0F);
  }
#endif
  return found;
}

/// One block: its sums stay in registers while the listed inputs pass.
template <int vectors, typename Weight>
void dense_block(const Weight* weights, const float* bias, const float* input, const uint16_t* places,
                 int count, float* output) {
  Vector sum[vectors];
  THERMORIG_UNROLL
  for (int v = 0; v < vectors; ++v) sum[v] = load(bias + v * lanes);
  for (int n = 0; n < count; ++n) {
    const float value = input[places[n]];
    const Weight* row = weights + places[n] * (vectors * lanes);
    THERMORIG_UNROLL
    for (int v = 0; v < vectors; ++v) sum[v] += value * load(row + v * lanes);
  }
  THERMORIG_UNROLL
  for (int v = 0; v < vectors; ++v) {
    const Vector y = sum[v] > 0.0F ? sum[v] : Vector{};
    store(output + v * lanes, y);
  }
}

template <int vectors, typename Weight>
void dense_blocks(const DenseLayer& layer, const float* input, const uint16_t* places, int count,
                  float* output) {
  constexpr int width = vectors * lanes;
  const auto* weights = static_cast<const Weight*>(layer.weights);
  for (int b = 0; b < layer.blocks; ++b)
    dense_block<vectors>(weights + b * layer.inputs * width, layer.bias + b * width, input, places, count,
                         output + b * width);
}

template <int vectors>
void dense_of(const DenseLayer& layer, const float* input, const uint16_t* places, int count, float* output) {
  if (layer.half)
    dense_blocks<vectors, uint16_t>(layer, input, places, count, output);
  else
    dense_blocks<vectors, float>(layer, input, places, count, output);
}

// Vectors of a block: as many as the registers hold beside the operands, and such that 240, 120 and 80
// outputs are whole blocks (AVX-512 fills 120 up to 128).
#if defined(__AVX512F__)
constexpr int both_heads = 15, one_head = 8, second = 5;
#elif defined(__AVX2__)
constexpr int both_heads = 10, one_head = 5, second = 10;
#else
constexpr int both_heads = 10, one_head = 10, second = 10;
#endif

int dense_width(int outputs) {
  if (outputs == 240) return both_heads * lanes;
  if (outputs == 120) return one_head * lanes;
  return second * lanes;
}

void dense(const DenseLayer& layer, const float* input, const uint16_t* places, int count, float* output) {
  if (layer.width == both_heads * lanes) return dense_of<both_heads>(layer, input, places, count, output);
  if (layer.width == one_head * lanes) return dense_of<one_head>(layer, input, places, count, output);
  dense_of<second>(layer, input, places, count, output);
}

float dot(const float* a, const float* b, int count) {
  Vector sum{};
  for (int i = 0; i < count; i += lanes) sum += load(a + i) * load(b + i);
  float total = 0.0F;
  for (int lane = 0; lane < lanes; ++lane) total += sum[lane];
  return total;
}

void to_half(const float* values, int count, uint16_t* halves) {
  for (int i = 0; i < count; i += lanes) {
    Vector v = load(values + i);
    v = v > largest_half ? broadcast(largest_half) : v;
    v = v < -largest_half ? broadcast(-largest_half) : v;
    store(halves + i, v);
  }
}

}  // namespace

const InferenceKernels inference_kernels = {
    convolve_and_pool, convolve, list_nonzero, dense_width, dense, dot, to_half};

}  // namespace thermorig::network::THERMORIG_KERNELS

/* SPDX-License-Identifier: MIT */
#pragma once

#include "half_reading.h"

/* What is peculiar to each pixel: its constant error and its noise, by chess half. */
typedef thermorig_odometer_pixel_model pixel_model;

#define LARGEST_K 120.0f      /* from the reference: what the map holds */
#define OFFSET_PRIOR 15.0f    /* readings: noise of 0.6 K against constant errors of 0.16 K */
#define VARIANCE_PRIOR 16.0f  /* readings for which a pixel counts as noisy as the data sheet says */
#define MOST_READINGS 4000.0f /* then what is older fades */
#define MOST_VARIANCES 500.0f
#define FIRST_PIXEL_VARIANCE 0.36f
#define LEAST_PIXEL_VARIANCE 0.01f

static void forget_pixels(pixel_model* pixels) {
  memset(pixels->offset, 0, sizeof pixels->offset);
  memset(pixels->variance, code_of(FIRST_PIXEL_VARIANCE, 0u), sizeof pixels->variance);
  pixels->learnt[0] = pixels->learnt[1] = 0.0f;
}

static float pixel_variance(const pixel_model* pixels, uint32_t parity, int row, int j) {
  return (float)variance_of(pixels->variance[parity][row][j]) / VARIANCE_STEPS;
}

/* From degrees Celsius to what differs from a reference, without the pixels' errors. */
static void correct_half(const pixel_model* pixels, float reference_c, half_reading* half) {
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const float off_k = half->temp_k[row][j] - reference_c;
      if (half->temp_k[row][j] >= UNKNOWN_K) continue;
      half->temp_k[row][j] = size_of(off_k) < LARGEST_K
                                 ? off_k - (float)pixels->offset[half->parity][row][j] / PIXEL_STEPS
                                 : UNKNOWN_K;
    }
}

/* Another half is learnt from. */
static void count_half(pixel_model* pixels, uint32_t parity) {
  pixels->learnt[parity] = least(pixels->learnt[parity] + 1.0f, MOST_READINGS);
}

/* What was left of a pixel is its own error, and its noise; of the latter the map had `map_variance`. */
static void learn_pixel(pixel_model* pixels, uint32_t parity, int row, int j, float residual,
                        float map_variance, uint32_t* noise) {
  const float n = pixels->learnt[parity], m = least(n, MOST_VARIANCES);
  int16_t* offset = &pixels->offset[parity][row][j];
  float own = pixel_variance(pixels, parity, row, j);
  *offset = (int16_t)rounded((float)*offset + PIXEL_STEPS * residual / (n + OFFSET_PRIOR), next_noise(noise),
                             32767);
  own +=
      (least(16.0f * (own + map_variance), residual * residual) - map_variance - own) / (m + VARIANCE_PRIOR);
  pixels->variance[parity][row][j] = code_of(most(LEAST_PIXEL_VARIANCE, own), next_noise(noise));
}

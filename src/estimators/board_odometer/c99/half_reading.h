/* SPDX-License-Identifier: MIT */
#pragma once

#include "numbers.h"

/* A chess half that was read anew, and where its pixels are. */
typedef thermorig_odometer_half_reading half_reading;
typedef thermorig_odometer_frame camera_frame;
typedef thermorig_odometer_profile rig_profile;

#define ROWS THERMORIG_ODOMETER_ROWS
#define COLUMNS THERMORIG_ODOMETER_COLUMNS
#define HALF_COLUMNS THERMORIG_ODOMETER_HALF_COLUMNS

#define UNKNOWN_K 1e6f     /* a pixel without a reading */
#define COLDEST_C (-60.0f) /* beyond: not a temperature of the sensor's range */
#define HOTTEST_C 400.0f

/* Of the two classes of rows, even and odd, the one that a column of a half has. */
static int row_class(int column, uint32_t parity) {
  return (int)(((uint32_t)column ^ parity) & 1u);
}

/* The column of a row's j-th pixel. */
static int column_of(int row, int j, uint32_t parity) {
  return 2 * j + (int)(((uint32_t)row ^ parity) & 1u);
}

static float bearing_deg(const rig_profile* rig, int column) {
  return rig->direction * rig->pitch_deg * ((float)column - 0.5f * (float)(COLUMNS - 1));
}

static int is_temperature(float temp_c) {
  return temp_c > COLDEST_C && temp_c < HOTTEST_C; /* not so for NaN */
}

/* As the frame has it, in degrees Celsius. Returns whether any pixel has a reading, and the mean of those. */
static int read_half(const camera_frame* frame, uint32_t parity, half_reading* half, float* mean_c) {
  float sum = 0.0f, count = 0.0f;
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const float pixel_c = frame->temp_c[row * COLUMNS + column_of(row, j, parity)];
      const int is_read = is_temperature(pixel_c);
      half->temp_k[row][j] = is_read ? pixel_c : UNKNOWN_K;
      sum += is_read ? pixel_c : 0.0f;
      count += is_read ? 1.0f : 0.0f;
    }
  half->parity = parity;
  half->begin_us = frame->begin_us[parity];
  half->end_us = frame->end_us[parity];
  half->time_sigma_s = frame->time_sigma_s;
  if (count == 0.0f) return 0;
  *mean_c = sum / count;
  return 1;
}

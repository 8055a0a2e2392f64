/* SPDX-License-Identifier: MIT */
#pragma once

#include "half_reading.h"

/* The surroundings all around the shaft, as the camera's 24 rows see them: a temperature and its variance in
 * each bin of azimuth. */
typedef thermorig_odometer_panorama panorama;
typedef thermorig_odometer_row_sums row_sums;

#define BINS THERMORIG_ODOMETER_BINS
#define WINDOW THERMORIG_ODOMETER_WINDOW
#define BIN_DEG (360.0f / (float)BINS)
#define WIDEST 45.0f /* bins to either side that a ray sweeps at most */

/* Where the columns of a half look while it is exposed, in bins of a window of the map. */
typedef struct {
  int32_t begin, length;
  float width;
  int16_t low[COLUMNS], high[COLUMNS];
  float low_part[COLUMNS], high_part[COLUMNS];
  uint8_t known[COLUMNS]; /* all of it was seen before, and `reach` bins to either side */
} sweep;

static int32_t bin_of(int32_t bin) {
  const int32_t rest = bin % BINS;
  return rest < 0 ? rest + BINS : rest;
}

static float half_bins(float half_deg) {
  return least(WIDEST, most(0.5f, half_deg / BIN_DEG));
}

/* Rows of one class were seen together: of even rows the first tells, of odd ones the second. */
static void find_known(const panorama* map, uint32_t parity, int32_t reach, sweep* at) {
  uint8_t unseen[2][WINDOW + 1];
  for (int odd = 0; odd < 2; ++odd) {
    int32_t bin = bin_of(at->begin);
    unseen[odd][0] = 0;
    for (int i = 0; i < at->length; ++i) {
      unseen[odd][i + 1] = (uint8_t)(unseen[odd][i] + (map->variance[odd][bin] == 0 ? 1 : 0));
      if (++bin == BINS) bin = 0;
    }
  }
  for (int column = 0; column < COLUMNS; ++column) {
    const uint8_t* of = unseen[row_class(column, parity)];
    if (at->known[column])
      at->known[column] = of[at->low[column] - reach] == of[at->high[column] + reach + 1];
  }
}

/* `position`: the middles of the columns in bins from the map's origin, without its end; `half`: bins to
 * either side that they sweep. */
static void place_columns(const panorama* map, uint32_t parity, const float position[COLUMNS], float half,
                          int32_t reach, sweep* at) {
  float lowest = 1e9f, highest = -1e9f;
  for (int column = 0; column < COLUMNS; ++column) {
    lowest = least(lowest, position[column]);
    highest = most(highest, position[column]);
  }
  at->width = 2.0f * half;
  at->begin = floor_of(lowest - half) - reach;
  at->length = floor_of(highest + half) + reach + 2 - at->begin;
  if (at->length > WINDOW) at->length = WINDOW;
  for (int column = 0; column < COLUMNS; ++column) {
    const float low = position[column] - half - (float)at->begin, high = low + at->width;
    const int32_t low_bin = floor_of(low), high_bin = floor_of(high);
    at->known[column] = low_bin >= reach && high_bin + reach + 1 <= at->length;
    at->low[column] = (int16_t)low_bin;
    at->high[column] = (int16_t)high_bin;
    at->low_part[column] = low - (float)low_bin;
    at->high_part[column] = high - (float)high_bin;
  }
  find_known(map, parity, reach, at);
}

/* Sums over all bins of the window before. */
static void add_up(const panorama* map, int row, const sweep* at, row_sums* sums) {
  const int16_t* of = map->temp[row];
  const uint8_t* code = map->variance[row];
  int32_t bin = bin_of(at->begin), sum = 0;
  uint32_t variances = 0;
  sums->temp[0] = 0;
  sums->variance[0] = 0;
  for (int i = 0; i < at->length; ++i) {
    sum += of[bin];
    variances += variance_of(code[bin]);
    sums->temp[i + 1] = sum;
    sums->variance[i + 1] = variances;
    if (++bin == BINS) bin = 0;
  }
}

static float between(const int32_t* sums, int from, float from_part, int to, float to_part) {
  return (float)(sums[to] - sums[from]) + to_part * (float)(sums[to + 1] - sums[to]) -
         from_part * (float)(sums[from + 1] - sums[from]);
}

/* What a column of one row should show: the mean over what it sweeps, in K. */
static float expected_k(const row_sums* sums, const sweep* at, int column) {
  return between(sums->temp, at->low[column], at->low_part[column], at->high[column], at->high_part[column]) /
         (MAP_STEPS * at->width);
}

static float expected_variance(const row_sums* sums, const sweep* at, int column) {
  return (float)(sums->variance[at->high[column] + 1] - sums->variance[at->low[column]]) /
         (VARIANCE_STEPS * at->width * (at->width + 1.0f));
}

/* What one row of the map lets expect. */
typedef struct {
  float temp_k[HALF_COLUMNS], variance[HALF_COLUMNS]; /* of the half's own columns */
  float slope[COLUMNS], slope_variance[COLUMNS];      /* K a deg */
} row_look;

/* `reach`: bins to either side over which a slope is taken. */
static void look_at_row(const row_sums* sums, int row, uint32_t parity, const sweep* at, int32_t reach,
                        int all_columns, row_look* look) {
  const float scale = 1.0f / (at->width * 2.0f * (float)reach * BIN_DEG);
  const int own = column_of(row, 0, parity);
  const int32_t* temp = sums->temp;
  const uint32_t* variance = sums->variance;
  for (int column = all_columns ? 0 : own; column < COLUMNS; column += all_columns ? 1 : 2) {
    const int low = at->low[column], high = at->high[column];
    float in, out, variances;
    look->slope[column] = look->slope_variance[column] = 0.0f;
    if (low < reach || high + reach + 1 > at->length) continue;
    in = between(temp, high - reach, at->high_part[column], high + reach, at->high_part[column]);
    out = between(temp, low - reach, at->low_part[column], low + reach, at->low_part[column]);
    variances = (float)(variance[high + reach] - variance[high - reach] + variance[low + reach] -
                        variance[low - reach]);
    look->slope[column] = scale * (in - out) / MAP_STEPS;
    look->slope_variance[column] = scale * scale * variances / VARIANCE_STEPS;
  }
  for (int j = 0; j < HALF_COLUMNS; ++j) {
    const int column = 2 * j + own;
    if (!at->known[column]) continue;
    look->temp_k[j] = expected_k(sums, at, column);
    look->variance[j] = expected_variance(sums, at, column);
  }
}

/* What a half shows at a column, at the rows of one class: its middle and half its width, in bins; the
 * temperatures without what is common, their slopes along the rows, their variances. */
typedef struct {
  int row_class;
  float position, half;
  float temp_k[ROWS / 2], slope[ROWS / 2], variance[ROWS / 2];
  uint8_t is_read[ROWS / 2];
} shown_column;

static int16_t map_temp(float temp_k, uint32_t* noise) {
  return (int16_t)rounded(temp_k * MAP_STEPS, next_noise(noise), 32767);
}

/* Bins that nothing has seen yet, `about` to either side, begin with what the column lets expect. */
static void seed_column(panorama* map, const shown_column* shown, float about, float swept_deg2,
                        uint32_t* noise) {
  const int32_t to = floor_of(shown->position + about);
  for (int32_t bin = floor_of(shown->position - about); bin <= to; ++bin) {
    const int32_t place = bin_of(bin);
    const float off_deg = ((float)bin + 0.5f - shown->position) * BIN_DEG;
    if (map->variance[shown->row_class][place] != 0) continue;
    for (int k = 0; k < ROWS / 2; ++k) {
      const int row = 2 * k + shown->row_class;
      const float variance = 2.0f * shown->variance[k] + 0.3f * swept_deg2 * square(shown->slope[k]);
      map->temp[row][place] =
          shown->is_read[k] ? map_temp(shown->temp_k[k] + shown->slope[k] * off_deg, noise) : 0;
      map->variance[row][place] = shown->is_read[k] ? code_of(variance, next_noise(noise)) : 255;
    }
  }
}

/* A Kalman filter a bin, of all bins that the k-th pixel of the column sweeps. */
static void write_pixel(panorama* map, const shown_column* shown, int k, uint32_t* noise) {
  int16_t* temp = map->temp[2 * k + shown->row_class];
  uint8_t* code = map->variance[2 * k + shown->row_class];
  const float low = shown->position - shown->half, width = 2.0f * shown->half, high = low + width;
  const int32_t from = floor_of(low), to = floor_of(high);
  const int32_t first = bin_of(from);
  const float inside = 1.0f / width, at_low = least((float)(from + 1) - low, width) * inside;
  const float at_high = (high - (float)to) * inside;
  float mean = 0.0f, spread = 0.0f, innovation, scale;
  int32_t bin = first;
  for (int32_t i = from; i <= to; ++i) {
    const float share = i == from ? at_low : i == to ? at_high : inside;
    mean += share * (float)temp[bin];
    spread += share * share * (float)variance_of(code[bin]);
    if (++bin == BINS) bin = 0;
  }
  innovation = shown->temp_k[k] * MAP_STEPS - mean;
  scale = 1.0f / (spread + shown->variance[k] * VARIANCE_STEPS);
  bin = first;
  for (int32_t i = from; i <= to; ++i) {
    const float share = i == from ? at_low : i == to ? at_high : inside;
    const float variance = (float)variance_of(code[bin]), gain = share * variance * scale;
    if (code[bin] != 0) {
      temp[bin] = (int16_t)rounded((float)temp[bin] + gain * innovation, next_noise(noise), 32767);
      code[bin] = code_of(variance * (1.0f - gain * share) / VARIANCE_STEPS, next_noise(noise));
    }
    if (++bin == BINS) bin = 0;
  }
}

static void write_column(panorama* map, const shown_column* shown, uint32_t* noise) {
  for (int k = 0; k < ROWS / 2; ++k)
    if (shown->is_read[k]) write_pixel(map, shown, k, noise);
}

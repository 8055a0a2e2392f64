/* SPDX-License-Identifier: MIT */
#pragma once

#include "alignment.h"

/* Where the camera looks in a map that there is: a probability each degree of the circle, half after half. */
typedef thermorig_odometer_circle_search circle_search;

#define TRUSTED_OF_HALF 0.2f /* of its likelihood: the next one sees the same surroundings */
#define FORGOTTEN 0.97f      /* a half: what came before counts a little less */
#define FEWEST_HALVES 6
#define CIRCLE_REACH 4 /* degrees to either side that belong to one place */
#define SURE 0.999f
#define BLOCK 120 /* places at a time */

/* Whole bins to either side of what a ray sweeps. */
static int swept_beside(const view* v) {
  return (int)(v->half + 0.001f);
}

/* Means of a row of the map over what a ray sweeps, around each bin. */
static void box_of(const panorama* map, int row, int beside, int16_t box[BINS]) {
  const int16_t* temp = map->temp[row];
  const int32_t count = 2 * beside + 1;
  int32_t sum = 0;
  for (int i = -beside; i <= beside; ++i) sum += temp[bin_of(i)];
  for (int bin = 0; bin < BINS; ++bin) {
    box[bin] = (int16_t)(sum / count);
    sum += temp[bin_of(bin + beside + 1)] - temp[bin_of(bin - beside)];
  }
}

static void known_of(const panorama* map, int odd, int beside, uint8_t known[BINS]) {
  const uint8_t* code = map->variance[odd];
  int32_t unseen = 0;
  for (int i = -beside; i <= beside; ++i) unseen += code[bin_of(i)] == 0;
  for (int bin = 0; bin < BINS; ++bin) {
    known[bin] = unseen == 0;
    unseen += (code[bin_of(bin + beside + 1)] == 0) - (code[bin_of(bin - beside)] == 0);
  }
}

/* A half, column by column: its pixels, the sums and squares of what they show beside their mean, and the bin
 * at which the circle's first place has it. */
typedef struct {
  int16_t base[COLUMNS];
  float count[COLUMNS], sum[COLUMNS], squares[COLUMNS];
  float noise, mean_k; /* of a pixel */
} column_sums;

static int sum_columns(const alignment* with, const view* v, float turned_deg, column_sums* of) {
  float pixels = 0.0f;
  of->noise = of->mean_k = 0.0f;
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      if (v->shown->temp_k[row][j] >= UNKNOWN_K) continue;
      pixels += 1.0f;
      of->noise += noise_of(v, row, j);
      of->mean_k += v->shown->temp_k[row][j];
    }
  if (pixels < FEWEST_PIXELS) return 0;
  of->noise /= pixels;
  of->mean_k /= pixels;
  for (int column = 0; column < COLUMNS; ++column) {
    of->base[column] = (int16_t)bin_of(floor_of((turned_deg + bearing_deg(with->rig, column)) / BIN_DEG));
    of->count[column] = of->sum[column] = of->squares[column] = 0.0f;
    for (int row = row_class(column, v->shown->parity); row < ROWS; row += 2) {
      const float shown_k = v->shown->temp_k[row][column / 2], off_k = shown_k - of->mean_k;
      if (shown_k >= UNKNOWN_K) continue;
      of->count[column] += 1.0f;
      of->sum[column] += off_k;
      of->squares[column] += least(LARGEST_SQUARES * of->noise, square(off_k));
    }
  }
  return 1;
}

/* How well the half fits at a block of places, by what the map knows. */
typedef struct {
  int32_t sum[BLOCK], squares[BLOCK];
} block_sums;

static void sum_block(const panorama* map, const view* v, const column_sums* of, uint8_t known[2][BINS],
                      int first, block_sums* sums) {
  const int32_t limit = (int32_t)(least(8.0f, sqrtf(LARGEST_SQUARES * of->noise)) * MAP_STEPS);
  int16_t box[BINS];
  memset(sums, 0, sizeof *sums);
  for (int row = 0; row < ROWS; ++row) {
    const uint8_t* is_known = known[row & 1];
    box_of(map, row, swept_beside(v), box);
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const float shown_k = v->shown->temp_k[row][j];
      const int32_t shown = (int32_t)((shown_k < UNKNOWN_K ? shown_k - v->common_k : 0.0f) * MAP_STEPS);
      int bin = (int)bin_of(of->base[column_of(row, j, v->shown->parity)] + first);
      if (shown_k >= UNKNOWN_K) continue;
      for (int i = 0; i < BLOCK; ++i) {
        int32_t off = shown - box[bin];
        off = off > limit ? limit : off < -limit ? -limit : off;
        if (is_known[bin]) {
          sums->sum[i] += off;
          sums->squares[i] += off * off;
        }
        if (++bin == BINS) bin = 0;
      }
    }
  }
}

/* Squares of the half at a place. Where nothing is known of the surroundings, they should be all alike. */
static float cost_at(const view* v, const column_sums* of, uint8_t known[2][BINS], int place, int32_t sum,
                     int32_t squares) {
  float count = 1e-6f, others = 1e-6f, flat = 0.0f, flat_squares = 0.0f;
  for (int column = 0; column < COLUMNS; ++column) {
    if (known[row_class(column, v->shown->parity)][bin_of(of->base[column] + place)]) {
      count += of->count[column];
    } else {
      others += of->count[column];
      flat += of->sum[column];
      flat_squares += of->squares[column];
    }
  }
  return ((float)squares - (float)sum * (float)sum / count) / (MAP_STEPS * MAP_STEPS) + flat_squares -
         flat * flat / others;
}

static void begin_circle(circle_search* circle) {
  memset(circle, 0, sizeof *circle);
}

/* A half, and its azimuth as the gyro has it. */
static void add_to_circle(circle_search* circle, const alignment* with, const view* v, float azimuth_deg) {
  uint8_t known[2][BINS];
  column_sums of;
  float best = -1e30f;
  if (circle->halves > 0)
    circle->turned_deg = around(circle->turned_deg + apart(azimuth_deg - circle->azimuth_deg));
  circle->azimuth_deg = azimuth_deg;
  if (!sum_columns(with, v, circle->turned_deg, &of)) return;
  for (int odd = 0; odd < 2; ++odd) known_of(with->map, odd, swept_beside(v), known[odd]);
  for (int first = 0; first < 360; first += BLOCK) {
    block_sums sums;
    sum_block(with->map, v, &of, known, first, &sums);
    for (int i = 0; i < BLOCK; ++i) {
      const float cost = cost_at(v, &of, known, first + i, sums.sum[i], sums.squares[i]);
      circle->log[first + i] = FORGOTTEN * circle->log[first + i] - 0.5f * TRUSTED_OF_HALF * cost / of.noise;
    }
  }
  for (int i = 0; i < 360; ++i) best = most(best, circle->log[i]);
  for (int i = 0; i < 360; ++i) circle->log[i] -= best;
  ++circle->halves;
}

/* Where it is, unless more than one place may be it. */
static int circle_found(const circle_search* circle, float* azimuth_deg, float* sigma_deg) {
  int best = 0;
  float all = 0.0f, near = 0.0f, mean = 0.0f, squares = 0.0f;
  if (circle->halves < FEWEST_HALVES) return 0;
  for (int i = 0; i < 360; ++i)
    if (circle->log[i] > circle->log[best]) best = i;
  for (int i = 0; i < 360; ++i) {
    const float weight = power_of_e(circle->log[i]), off = apart((float)(i - best));
    all += weight;
    if (size_of(off) > (float)CIRCLE_REACH) continue;
    near += weight;
    mean += weight * off;
    squares += weight * off * off;
  }
  if (near < SURE * all) return 0;
  mean /= near;
  *azimuth_deg = around((float)best + mean + circle->turned_deg);
  *sigma_deg = root(squares / near - mean * mean) + 0.7f;
  return 1;
}

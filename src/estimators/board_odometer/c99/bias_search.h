/* SPDX-License-Identifier: MIT */
#pragma once

#include "gyro_path.h"
#include "half_reading.h"

/* The gyro's bias from the first seconds, moving or not: of all biases that the gyro may have, the one with
 * which its halves make the sharpest mosaic. Some biases are tried a frame. */
typedef thermorig_odometer_bias_search bias_search;
typedef thermorig_odometer_cell mosaic_cell;

#define HALVES THERMORIG_ODOMETER_SEARCHED_HALVES
#define BIASES THERMORIG_ODOMETER_BIASES
#define BIAS_STEP_DPS 0.5f
#define BIASES_A_FRAME 16
#define SEARCH_EVERY 4         /* halves */
#define TRUSTED_OF_MOSAIC 0.3f /* of its likelihood: halves are blurred, pixels have offsets */
#define KNOWN_WELL_DPS 1.0f
#define DISTINCT_SHARE 0.94f /* of the typical variance: noise alone makes it differ by 2 % */
#define LARGEST_ERROR_K 3.0f /* of a pixel that is not broken */
#define BROKEN ((int16_t)-32768)
#define SEARCH_STEPS_A_K 256.0f

/* A half without what it has in common, into the ring. */
static void keep_half(bias_search* search, const half_reading* half, const exposed_turn* turn) {
  const int place = search->kept % HALVES;
  float sum = 0.0f, count = 1e-6f;
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j)
      if (half->temp_k[row][j] < UNKNOWN_K) {
        sum += half->temp_k[row][j];
        count += 1.0f;
      }
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j)
      search->temp[place][row][j] =
          half->temp_k[row][j] < UNKNOWN_K
              ? (int16_t)rounded((half->temp_k[row][j] - sum / count) * SEARCH_STEPS_A_K, 0x80000000u, 32767)
              : BROKEN;
  search->turned[place] = turn->mean_turned;
  search->time_us[place] = turn->mean_us;
  search->parity[place] = (uint8_t)half->parity;
  ++search->kept;
}

/* What a pixel shows on average beyond its neighbours is its own error; one that is far beyond is broken.
 * Otherwise the mosaic is sharpest where nothing seems to move. */
static void find_pixel_errors(bias_search* search, uint32_t parity) {
  float mean_k[ROWS][HALF_COLUMNS], halves = 0.0f;
  for (int i = 0; i < HALVES; ++i) halves += search->parity[i] == parity ? 1.0f : 0.0f;
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      float sum = 0.0f;
      for (int i = 0; i < HALVES; ++i)
        if (search->parity[i] == parity)
          sum = search->temp[i][row][j] == BROKEN ? UNKNOWN_K : sum + (float)search->temp[i][row][j];
      mean_k[row][j] = sum < UNKNOWN_K && halves > 0.0f ? sum / (halves * SEARCH_STEPS_A_K) : UNKNOWN_K;
    }
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      float about = 0.0f, count = 0.0f, error_k;
      for (int r = row - 2; r <= row + 2; ++r)
        for (int c = j - 1; c <= j + 1; ++c) {
          if (r < 0 || r >= ROWS || c < 0 || c >= HALF_COLUMNS || (r == row && c == j)) continue;
          if (mean_k[r][c] >= UNKNOWN_K) continue;
          about += mean_k[r][c];
          count += 1.0f;
        }
      error_k = mean_k[row][j] < UNKNOWN_K && count > 0.0f ? mean_k[row][j] - about / count : UNKNOWN_K;
      search->error[parity][row][j] =
          size_of(error_k) > LARGEST_ERROR_K ? BROKEN : (int16_t)(int32_t)(error_k * SEARCH_STEPS_A_K);
    }
}

static int cells_a_row(const rig_profile* rig) {
  const int cells = (int)(360.0f / rig->pitch_deg) + 1;
  return cells < THERMORIG_ODOMETER_CELLS ? cells : THERMORIG_ODOMETER_CELLS;
}

/* Where the columns of each half lie in the mosaic that a bias makes. */
static void place_halves(bias_search* search, const rig_profile* rig, float bias_dps, int cells) {
  for (int i = 0; i < HALVES; ++i) {
    const float turned_deg = (degrees_between(search->turned[0], search->turned[i]) -
                              bias_dps * seconds_between(search->time_us[0], search->time_us[i])) /
                             rig->scale;
    for (int column = 0; column < COLUMNS; ++column) {
      const int cell = (int)(around(turned_deg + bearing_deg(rig, column)) * (float)cells / 360.0f);
      search->cell_of[i][column] = (uint16_t)(cell < cells ? cell : cells - 1);
    }
  }
}

/* The readings of one half's row; `cell_of`: of every second column. */
static void add_readings(const int16_t* temp, const int16_t* error, const uint16_t* cell_of,
                         mosaic_cell* cells) {
  for (int j = 0; j < HALF_COLUMNS; ++j) {
    mosaic_cell* cell = &cells[cell_of[2 * j]];
    const float off_k = (float)(temp[j] - error[j]) / SEARCH_STEPS_A_K;
    if (temp[j] == BROKEN || error[j] == BROKEN) continue;
    cell->sum += off_k;
    cell->squares += off_k * off_k;
    cell->count += 1.0f;
  }
}

/* Of the readings within the cells. */
static float mosaic_variance(bias_search* search, const rig_profile* rig, float bias_dps) {
  const int cells = cells_a_row(rig);
  float squares = 0.0f, freedom = 1.0f;
  place_halves(search, rig, bias_dps, cells);
  for (int row = 0; row < ROWS; ++row) {
    memset(search->cell, 0, sizeof search->cell);
    for (int i = 0; i < HALVES; ++i) {
      const uint8_t parity = search->parity[i];
      add_readings(search->temp[i][row], search->error[parity][row],
                   &search->cell_of[i][column_of(row, 0, parity)], search->cell);
    }
    for (int i = 0; i < cells; ++i) {
      const mosaic_cell* cell = &search->cell[i];
      if (cell->count < 2.0f) continue;
      squares += cell->squares - cell->sum * cell->sum / cell->count;
      freedom += cell->count - 1.0f;
    }
  }
  return squares / freedom;
}

/* The value that half of them are below. */
static float median_of(const float* values, int count) {
  for (int i = 0; i < count; ++i) {
    int below = 0, equal = 0;
    for (int j = 0; j < count; ++j) {
      below += values[j] < values[i];
      equal += values[j] == values[i];
    }
    if (below <= count / 2 && below + equal > count / 2) return values[i];
  }
  return values[0];
}

/* What the mosaics told. */
typedef struct {
  float bias_dps, sigma_dps;
  float rate_dps; /* of the shaft, on average, while the halves were seen */
} found_bias;

static float searched_rate_dps(const bias_search* search, const rig_profile* rig, float bias_dps) {
  const int first = search->kept % HALVES, last = (first + HALVES - 1) % HALVES;
  const float step_s = seconds_between(search->time_us[first], search->time_us[last]);
  return (degrees_between(search->turned[first], search->turned[last]) / step_s - bias_dps) / rig->scale;
}

/* Whether they tell the bias; else they do not yet. */
static int bias_found(const bias_search* search, const rig_profile* rig, found_bias* found) {
  const float* variance = search->variance;
  const int steps = BIASES / 2;
  const float readings = TRUSTED_OF_MOSAIC * 0.5f * (float)(HALVES * ROWS * HALF_COLUMNS);
  float smallest = 1e30f, sum = 0.0f, mean = 0.0f, squares = 0.0f;
  for (int i = 0; i < BIASES; ++i) smallest = least(smallest, variance[i]);
  if (!(smallest > 0.0f) || smallest > DISTINCT_SHARE * median_of(variance, BIASES)) return 0;
  for (int i = -steps; i <= steps; ++i) {
    const float off_dps = (float)i * BIAS_STEP_DPS;
    /* Cauchy's density before: a profile may be of another day or gyro, and no bias is ruled out. */
    const float weight = power_of_e(-readings * (variance[i + steps] / smallest - 1.0f)) /
                         (1.0f + square(off_dps / rig->bias_sigma_dps));
    sum += weight;
    mean += weight * off_dps;
    squares += weight * off_dps * off_dps;
  }
  mean /= sum;
  found->bias_dps = rig->bias_dps + mean;
  found->sigma_dps = root(squares / sum - mean * mean + BIAS_STEP_DPS * BIAS_STEP_DPS / 12.0f);
  found->rate_dps = searched_rate_dps(search, rig, found->bias_dps);
  return found->sigma_dps <= KNOWN_WELL_DPS;
}

static void begin_bias_search(bias_search* search) {
  search->kept = 0;
  search->tried = -1;
}

static int is_trying(const bias_search* search) {
  return search->tried >= 0;
}

/* Another half. Every few halves biases begin to be tried; until that is over, no half may come. */
static void add_to_search(bias_search* search, const half_reading* half, const exposed_turn* turn) {
  keep_half(search, half, turn);
  if (search->kept < HALVES || search->kept % SEARCH_EVERY != 0) return;
  for (uint32_t parity = 0; parity < 2u; ++parity) find_pixel_errors(search, parity);
  search->tried = 0;
}

/* The next biases. Returns whether they were the last ones and the mosaics tell which it is. */
static int try_biases(bias_search* search, const rig_profile* rig, found_bias* found) {
  for (int i = 0; i < BIASES_A_FRAME && search->tried < BIASES; ++i, ++search->tried) {
    const int32_t from_middle = search->tried - BIASES / 2;
    search->variance[search->tried] =
        mosaic_variance(search, rig, rig->bias_dps + (float)from_middle * BIAS_STEP_DPS);
  }
  if (search->tried < BIASES) return 0;
  search->tried = -1;
  return bias_found(search, rig, found);
}

/* SPDX-License-Identifier: MIT */
#pragma once

#include "heading_filter.h"
#include "panorama.h"
#include "pixel_model.h"

/* Lays halves against the panorama: what belongs to that. */
typedef struct {
  const panorama* map;
  const heading_filter* filter;
  const rig_profile* rig;
  row_sums* sums; /* of the row that is looked at */
} alignment;

#define FEWEST_PIXELS 40.0f
#define HUBER 3.0f
#define STRICT_SQUARES 9.0f
#define LARGEST_SQUARES (HUBER * HUBER * HUBER) /* what one pixel counts at most */
#define LEAST_KNOWN_SHARE 0.25f

/* A half to be laid against it. */
typedef struct {
  const half_reading* shown;
  const pixel_model* pixels;
  float half;       /* bins to either side of what a ray sweeps */
  float trust_deg2; /* of the heading beforehand: what it explains is no outlier */
  int is_strict;    /* what fits badly counts for nothing */
  float common_k, flat_k;
} view;

/* Variance of a pixel's reading. */
static float noise_of(const view* v, int row, int j) {
  return pixel_variance(v->pixels, v->shown->parity, row, j);
}

/* In bins from the map's origin, without its end: neighbouring columns lie side by side. */
static float column_position(const alignment* with, float azimuth_deg, int column) {
  const float at_deg = azimuth_deg + bearing_deg(with->rig, column);
  return (at_deg - map_offset_deg(with->filter, at_deg)) / BIN_DEG;
}

static void place_view(const alignment* with, const view* v, float azimuth_deg, int32_t reach, sweep* at) {
  float position[COLUMNS];
  for (int column = 0; column < COLUMNS; ++column)
    position[column] = column_position(with, azimuth_deg, column);
  place_columns(with->map, v->shown->parity, position, v->half, reach, at);
}

typedef struct {
  float pixels, cost,
      flat_cost; /* mean squares of a pixel, robust; the same had the surroundings no structure */
  float common_k;
  float lean, steepness, known; /* weighted sums of slope times residual, of squares, of those less noise */
  float about[NODES];           /* whose offset of the map it depends on, shares of 1 */
} comparison;

/* Slopes that may be nothing but noise tell nothing. */
static float variance_deg2_of(const comparison* of) {
  return of->known > LEAST_KNOWN_SHARE * of->steepness ? of->steepness / (of->known * of->known) : 1e9f;
}

static float robust_weight(float squares, int is_strict) {
  if (is_strict) {
    const float part = STRICT_SQUARES / (STRICT_SQUARES + squares);
    return part * part;
  }
  return squares > HUBER * HUBER ? HUBER / sqrtf(squares) : 1.0f;
}

/* What all pixels have in common, and how well a half fits without it: no slopes, no weights. `limit_k`: a
 * pixel counts so much at most. Returns the mean square of a pixel by its noise, and less where it cannot be
 * told 1e9. */
static float fit_at(const alignment* with, const view* v, float azimuth_deg, float limit_k, float* common_k,
                    float* flat_k) {
  sweep at;
  float count = 0.0f, weights = 0.0f, sum = 0.0f, squares = 0.0f, flat = 0.0f;
  place_view(with, v, azimuth_deg, 1, &at);
  for (int row = 0; row < ROWS; ++row) {
    add_up(with->map, row, &at, with->sums);
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const int column = column_of(row, j, v->shown->parity);
      const float shown_k = v->shown->temp_k[row][j];
      float off, weight;
      if (!at.known[column] || shown_k >= UNKNOWN_K) continue;
      weight = 1.0f / (noise_of(v, row, j) + expected_variance(with->sums, &at, column));
      off = shown_k - expected_k(with->sums, &at, column) - *common_k;
      off = least(limit_k, most(-limit_k, off));
      count += 1.0f;
      weights += weight;
      sum += weight * off;
      squares += weight * off * off;
      flat += weight * shown_k;
    }
  }
  if (count < FEWEST_PIXELS) return 1e9f;
  *common_k += sum / weights;
  *flat_k = flat / weights;
  return (squares - sum * sum / weights) / count;
}

/* What one row of the map lets expect. */
typedef struct {
  float weights, residuals, slopes, squares, products, noise;
  float of_column[COLUMNS]; /* squares */
} slope_sums;

/* The pixels of a row; `above` and `below` lend their slopes, if they are not the row itself. */
static void compare_row(int row, const view* v, const sweep* at, const row_look* own, const row_look* above,
                        const row_look* below, slope_sums* sums, comparison* to) {
  for (int j = 0; j < HALF_COLUMNS; ++j) {
    const int column = column_of(row, j, v->shown->parity);
    const float shown_k = v->shown->temp_k[row][j];
    float slope = own->slope[column], slope_variance = own->slope_variance[column];
    float residual, weight, squares, flat;
    if (!at->known[column] || shown_k >= UNKNOWN_K) continue;
    if (above != own) {
      slope = 0.5f * slope + 0.25f * (above->slope[column] + below->slope[column]);
      slope_variance =
          0.25f * slope_variance + 0.0625f * (above->slope_variance[column] + below->slope_variance[column]);
    }
    weight = 1.0f / (noise_of(v, row, j) + own->variance[j]);
    residual = shown_k - own->temp_k[j] - v->common_k;
    squares = residual * residual * weight;
    flat = shown_k - v->flat_k;
    to->cost += least(squares, LARGEST_SQUARES);
    to->flat_cost += least(flat * flat * weight, LARGEST_SQUARES);
    to->pixels += 1.0f;
    weight *= robust_weight(squares / (1.0f + slope * slope * v->trust_deg2 * weight), v->is_strict);
    sums->weights += weight;
    sums->residuals += weight * residual;
    sums->slopes += weight * slope;
    sums->squares += weight * slope * slope;
    sums->products += weight * slope * residual;
    sums->noise += weight * slope_variance;
    sums->of_column[column] += weight * slope * slope;
  }
}

/* `reach`: bins to either side over which a slope is taken; `smooth`: over three rows. */
static void compare(const alignment* with, const view* v, float azimuth_deg, int32_t reach, int smooth,
                    comparison* to) {
  sweep at;
  row_look look[3];
  slope_sums sums;
  float steepness = 0.0f;
  memset(to, 0, sizeof *to);
  memset(&sums, 0, sizeof sums);
  place_view(with, v, azimuth_deg, reach, &at);
  for (int row = 0; row < ROWS + smooth; ++row) { /* with the row below a row is complete */
    const row_look* own = &look[smooth ? (row + 2) % 3 : 0];
    if (row < ROWS) {
      add_up(with->map, row, &at, with->sums);
      look_at_row(with->sums, row, v->shown->parity, &at, reach, smooth, &look[smooth ? row % 3 : 0]);
    }
    if (!smooth)
      compare_row(row, v, &at, own, own, own, &sums, to);
    else if (row > 0)
      compare_row(row - 1, v, &at, own, &look[(row == 1 ? 1 : row + 1) % 3],
                  &look[(row == ROWS ? row + 1 : row) % 3], &sums, to);
  }
  to->common_k = v->common_k;
  if (to->pixels < FEWEST_PIXELS || sums.weights <= 0.0f) return;
  to->cost /= to->pixels;
  to->flat_cost /= to->pixels;
  to->common_k += sums.residuals / sums.weights;
  to->lean = sums.products - sums.slopes * sums.residuals / sums.weights;
  to->steepness = sums.squares - sums.slopes * sums.slopes / sums.weights;
  to->known = to->steepness - sums.noise;
  for (int column = 0; column < COLUMNS; ++column) steepness += sums.of_column[column];
  for (int column = 0; column < COLUMNS && steepness > 0.0f; ++column)
    add_shares(azimuth_deg + bearing_deg(with->rig, column), sums.of_column[column] / steepness, to->about);
}

#define SEARCH_FROM_DEG 1.0f /* a heading that is known less well is searched for first */
#define SEARCH_STEPS 20      /* to either side */

/* The best of the headings that it may be, on a grid. Returns by how much it is off. */
static float searched_deg(const alignment* with, const view* v, float azimuth_deg, float sigma_deg) {
  const float reach_deg = least(20.0f, 3.0f * sigma_deg),
              step_deg = most(0.5f, reach_deg / (float)SEARCH_STEPS);
  const int steps = (int)(reach_deg / step_deg);
  float best = 1e9f, best_deg = 0.0f;
  for (int i = -steps; i <= steps; ++i) {
    const float off_deg = (float)i * step_deg;
    float common_k = v->common_k, flat_k, cost;
    cost = fit_at(with, v, around(azimuth_deg + off_deg), 4.0f, &common_k, &flat_k) +
           square(off_deg / sigma_deg) / (float)(ROWS * HALF_COLUMNS);
    if (cost >= best) continue;
    best = cost;
    best_deg = off_deg;
  }
  return best_deg;
}

/* The best azimuth about one that is known to `sigma_deg`. Returns whether there is one; `off_deg`: from
 * there. */
static int find_azimuth(const alignment* with, view* v, float azimuth_deg, float sigma_deg, float* off_deg,
                        comparison* found) {
  static const int32_t reaches[3] = {1, 2, 4};
  float least_deg2 = 1e9f;
  int slope = 0;
  comparison tried;
  *off_deg = 0.0f;
  if (fit_at(with, v, azimuth_deg, UNKNOWN_K, &v->common_k, &v->flat_k) >= 1e9f &&
      sigma_deg <= SEARCH_FROM_DEG)
    return 0;
  if (sigma_deg > SEARCH_FROM_DEG) {
    *off_deg = searched_deg(with, v, azimuth_deg, sigma_deg);
    fit_at(with, v, around(azimuth_deg + *off_deg), UNKNOWN_K, &v->common_k, &v->flat_k);
  }
  for (int i = 0; i < 3; ++i) {
    compare(with, v, around(azimuth_deg + *off_deg), reaches[i], i > 0, &tried);
    if (tried.pixels < FEWEST_PIXELS || variance_deg2_of(&tried) >= least_deg2) continue;
    least_deg2 = variance_deg2_of(&tried);
    slope = i;
    *found = tried;
  }
  if (!(least_deg2 < 25.0f)) return 0;
  for (int step = 0; step < 4; ++step) {
    const float step_deg = least(2.0f, most(-2.0f, found->known > 0.0f ? found->lean / found->known : 0.0f));
    *off_deg += step_deg;
    v->common_k = found->common_k;
    compare(with, v, around(azimuth_deg + *off_deg), reaches[slope], slope > 0, found);
    if (found->pixels < FEWEST_PIXELS) return 0;
    if (size_of(step_deg) < 0.002f) break;
  }
  return variance_deg2_of(found) < 25.0f;
}

/* SPDX-License-Identifier: MIT */
#pragma once

#include "alignment.h"
#include "bias_search.h"
#include "circle_search.h"
#include "gyro_path.h"
#include "half_reading.h"
#include "heading_filter.h"
#include "panorama.h"
#include "pixel_model.h"

/* Heading filter and panorama together: half after half. */
typedef thermorig_odometer_tracker tracker;

#define VARIANCE_SHARE 1.44f  /* halves see the same errors of the map again and again */
#define SHARE_OF_NEW_MAP 5.0f /* while it is made, those with which halves just before have written it */
#define LEAST_SIGMA_DEG 0.03f
#define CHANGE_S 0.01f    /* a sweep that is not even is no box */
#define SURPRISING 4.0f   /* an innovation squared: counts less */
#define IMPOSSIBLE 30.0f  /* is not believed, and the map not written */
#define FIRST_HALVES 4    /* are only written: a map of one chess half has gaps */
#define FLAT_MARGIN 0.15f /* squares of a pixel */
#define SETTLED_HALVES 30
#define SETTLED_DEG 0.4f
#define MOVING_DPS 8.0f /* from there on errors of pixels are told from surroundings */

/* What a half told the filter. */
typedef struct {
  int is_used, is_judged, is_flat;
  float squared, innovation_deg, rate_dps;
} half_result;

/* A new map; the heading goes on from where it is. */
static void begin_map(tracker* t) {
  memset(&t->of, 0, sizeof t->of);
  forget_pixels(&t->pixels);
  begin_filter(&t->filter);
  t->halves = 0;
  t->common_c = 0.0f;
  t->in_map_deg = 0.0f;
}

/* The newest half: its temperatures without the pixels' errors, about a reference. */
static void take_half(tracker* t, const camera_frame* frame, uint32_t parity) {
  float mean_c;
  if (read_half(frame, parity, &t->half, &mean_c) && t->halves == 0) t->reference_c = mean_c;
  correct_half(&t->pixels, t->reference_c, &t->half);
}

/* What the gyro turned by while the half was exposed, if the camera is as late as the filter has it. */
static exposed_turn turn_of(const tracker* t, const gyro_path* path) {
  const float latency_s = least(0.5f, most(-0.5f, t->filter.value[LATENCY]));
  const uint32_t late_us = (uint32_t)(int32_t)(1e6f * latency_s);
  exposed_turn turn;
  path_over(path, t->half.begin_us - late_us, t->half.end_us - late_us, &turn);
  return turn;
}

static view view_of(const tracker* t, const exposed_turn* turn) {
  view v;
  memset(&v, 0, sizeof v);
  v.shown = &t->half;
  v.pixels = &t->pixels;
  v.half = half_bins(half_width_deg(&t->filter, turn));
  v.common_k = t->common_c;
  return v;
}

static alignment alignment_of(tracker* t, const rig_profile* rig) {
  alignment with;
  with.map = &t->of.map.panorama;
  with.filter = &t->filter;
  with.rig = rig;
  with.sums = &t->of.map.by.sums;
  return with;
}

static float in_map_deg2(const heading_filter* filter, const exposed_turn* turn, const float about[NODES],
                         float row[STATES], float across[STATES]) {
  derivative(filter, turn, about, row);
  return variance_along(filter, row, across);
}

/* What is left of each pixel, where the half lies now, is its own. */
static void learn_pixels(tracker* t, const alignment* with, view* v, float azimuth_deg) {
  const uint32_t parity = t->half.parity;
  sweep at;
  if (fit_at(with, v, azimuth_deg, UNKNOWN_K, &v->common_k, &v->flat_k) >= 1e9f) return;
  count_half(&t->pixels, parity);
  place_view(with, v, azimuth_deg, 1, &at);
  for (int row = 0; row < ROWS; ++row) {
    add_up(with->map, row, &at, with->sums);
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const int column = column_of(row, j, parity);
      const float shown_k = t->half.temp_k[row][j];
      if (!at.known[column] || shown_k >= UNKNOWN_K) continue;
      learn_pixel(&t->pixels, parity, row, j, shown_k - expected_k(with->sums, &at, column) - v->common_k,
                  expected_variance(with->sums, &at, column), &t->noise);
    }
  }
}

/* How much of the map about each node the half writes anew: as much as the map is less sure than it. */
static void written_shares(const alignment* with, const view* v, float azimuth_deg, float shares[NODES]) {
  float sum[COLUMNS], count[COLUMNS];
  sweep at;
  memset(sum, 0, sizeof sum);
  memset(count, 0, sizeof count);
  place_view(with, v, azimuth_deg, 1, &at);
  for (int row = 0; row < ROWS; ++row) {
    add_up(with->map, row, &at, with->sums);
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const int column = column_of(row, j, v->shown->parity);
      float map_variance;
      if (!at.known[column] || v->shown->temp_k[row][j] >= UNKNOWN_K) continue;
      map_variance = expected_variance(with->sums, &at, column);
      sum[column] += map_variance / (map_variance + noise_of(v, row, j));
      count[column] += 1.0f;
    }
  }
  for (int column = 0; column < COLUMNS; ++column)
    if (count[column] > 0.0f)
      add_shares(azimuth_deg + bearing_deg(with->rig, column),
                 with->rig->pitch_deg / NODE_DEG * sum[column] / count[column], shares);
  for (int node = 0; node < NODES; ++node) shares[node] = least(1.0f, shares[node]);
}

/* Lays the half against the map, and tells the filter. */
static void judge_half(tracker* t, const alignment* with, const exposed_turn* turn, view* v,
                       half_result* result) {
  heading_filter* filter = &t->filter;
  const float azimuth_deg = exposed_deg(filter, turn);
  float ahead[NODES], row[STATES], across[STATES], prior_deg2, expected_deg2, noise_deg2, known_deg2;
  comparison found;
  memset(ahead, 0, sizeof ahead);
  add_shares(azimuth_deg, 1.0f, ahead);
  prior_deg2 = in_map_deg2(filter, turn, ahead, row, across);
  t->in_map_deg = root(prior_deg2);
  v->trust_deg2 = prior_deg2;
  v->is_strict = t->halves > SETTLED_HALVES && prior_deg2 < square(SETTLED_DEG);
  if (!find_azimuth(with, v, azimuth_deg, t->in_map_deg, &result->innovation_deg, &found)) return;
  v->common_k = found.common_k;
  known_deg2 = in_map_deg2(filter, turn, found.about, row, across);
  noise_deg2 = VARIANCE_SHARE * variance_deg2_of(&found) + square(LEAST_SIGMA_DEG) +
               square(CHANGE_S * turn->change_dps) + square(t->half.time_sigma_s * result->rate_dps);
  expected_deg2 = known_deg2 + noise_deg2;
  result->is_judged = 1;
  result->squared = square(result->innovation_deg) / expected_deg2;
  result->is_flat = found.flat_cost + FLAT_MARGIN < found.cost;
  result->is_used = result->squared <= IMPOSSIBLE && !result->is_flat;
  if (!result->is_used) return;
  if (filter->is_learning) noise_deg2 += (SHARE_OF_NEW_MAP - VARIANCE_SHARE) * variance_deg2_of(&found);
  if (result->squared > SURPRISING) noise_deg2 += expected_deg2 * (result->squared / SURPRISING - 1.0f);
  filter_update(filter, across, result->innovation_deg, known_deg2 + noise_deg2);
  t->in_map_deg = root(in_map_deg2(filter, turn, found.about, row, across));
  if (size_of(result->rate_dps) > MOVING_DPS) learn_pixels(t, with, v, exposed_deg(filter, turn));
}

/* What the half shows at a column, where it lies now. */
static void show_column(const tracker* t, const alignment* with, const view* v, float azimuth_deg, int column,
                        shown_column* shown) {
  const int j = column / 2, before = j > 0 ? j - 1 : j, behind = j + 1 < HALF_COLUMNS ? j + 1 : j;
  const float apart_deg = with->rig->direction * with->rig->pitch_deg * (float)(2 * (behind - before));
  shown->row_class = row_class(column, t->half.parity);
  shown->position = column_position(with, azimuth_deg, column);
  shown->half = v->half;
  for (int k = 0; k < ROWS / 2; ++k) {
    const int row = 2 * k + shown->row_class;
    const float* temp_k = t->half.temp_k[row];
    const int has_slope = temp_k[before] < UNKNOWN_K && temp_k[behind] < UNKNOWN_K;
    shown->temp_k[k] = temp_k[j] - v->common_k;
    shown->slope[k] = has_slope ? (temp_k[behind] - temp_k[before]) / apart_deg : 0.0f;
    shown->variance[k] = noise_of(v, row, j) + square(t->in_map_deg * shown->slope[k]);
    shown->is_read[k] = temp_k[j] < UNKNOWN_K;
  }
}

static void write_half(tracker* t, const alignment* with, const view* v, float azimuth_deg) {
  panorama* map = &t->of.map.panorama;
  const float pitch = with->rig->pitch_deg / BIN_DEG;
  const float swept_deg2 = square(v->half * BIN_DEG) + square(with->rig->pitch_deg);
  shown_column shown;
  for (int column = 0; column < COLUMNS; ++column) {
    const int is_edge = column < 2 || column + 2 >= COLUMNS;
    show_column(t, with, v, azimuth_deg, column, &shown);
    seed_column(map, &shown, is_edge ? most(v->half, pitch) : pitch, swept_deg2, &t->noise);
  }
  for (int column = 0; column < COLUMNS; ++column) {
    show_column(t, with, v, azimuth_deg, column, &shown);
    write_column(map, &shown, &t->noise);
  }
}

/* The newest half tells the heading, and is written into the map. */
static half_result add_half(tracker* t, const gyro_path* path, const rig_profile* rig) {
  const exposed_turn turn = turn_of(t, path);
  const alignment with = alignment_of(t, rig);
  half_result result = {0, 0, 0, 0.0f, 0.0f, 0.0f};
  view v = view_of(t, &turn);
  float shown_deg, edge_deg, rewritten[NODES], nowhere[NODES], shown[STATES];
  memset(rewritten, 0, sizeof rewritten);
  memset(nowhere, 0, sizeof nowhere);
  result.rate_dps = exposed_rate_dps(&t->filter, &turn);
  if (t->halves < 1000000) ++t->halves;
  if (t->halves > FIRST_HALVES) {
    judge_half(t, &with, &turn, &v, &result);
    t->common_c = v.common_k;
    if (result.is_judged && !result.is_used) return result;
    if (result.is_used && t->filter.is_open && has_gap(&t->filter))
      written_shares(&with, &v, exposed_deg(&t->filter, &turn), rewritten);
  } else {
    v.common_k = 0.0f;
  }
  shown_deg = exposed_deg(&t->filter, &turn);
  edge_deg = (0.5f * (float)COLUMNS + 1.0f) * rig->pitch_deg + v.half * BIN_DEG;
  derivative(&t->filter, &turn, nowhere, shown);
  begin_nodes(&t->filter, shown_deg - edge_deg, shown_deg + edge_deg, shown);
  write_half(t, &with, &v, shown_deg);
  rewrite_nodes(&t->filter, rewritten, shown);
  return result;
}

/* The newest half, if its heading is searched for: the filter learns nothing of it until it is found. */
typedef struct {
  int is_found;
  float jump_deg; /* from what the gyro let expect */
  float rate_dps;
} located_half;

static located_half locate_half(tracker* t, const gyro_path* path, const rig_profile* rig) {
  const exposed_turn turn = turn_of(t, path);
  const float azimuth_deg = exposed_deg(&t->filter, &turn);
  const alignment with = alignment_of(t, rig);
  const view v = view_of(t, &turn);
  circle_search* circle = &t->of.map.by.circle;
  located_half located = {0, 0.0f, 0.0f};
  float found_deg, sigma_deg;
  add_to_circle(circle, &with, &v, azimuth_deg);
  located.is_found = circle_found(circle, &found_deg, &sigma_deg);
  if (!located.is_found) return located;
  located.jump_deg = apart(found_deg - azimuth_deg);
  turn_heading(&t->filter, located.jump_deg, sigma_deg);
  t->in_map_deg = sigma_deg;
  located.rate_dps = exposed_rate_dps(&t->filter, &turn);
  return located;
}

/* SPDX-License-Identifier: MIT */
#pragma once

#include "gyro_path.h"

/* A Kalman filter over heading (deg), gyro bias (deg/s), gyro scale, camera latency (s), and how the map is
 * off at nodes 15 degrees apart, whose errors are those of where they were put when they were first seen. */
typedef thermorig_odometer_heading_filter heading_filter;

#define NODES THERMORIG_ODOMETER_NODES
#define STATES THERMORIG_ODOMETER_STATES

enum { HEADING, BIAS, SCALE, LATENCY, FIRST_NODE };

#define NODE_DEG (360.0f / (float)NODES)
#define START_SIGMA_DEG 1e-3f  /* the map's origin is the first heading */
#define HEADING_WALK_DEG 0.03f /* in a square root of a second: noise of the gyro */
#define BIAS_WALK_DPS 0.008f
#define SCALE_WALK 2e-5f
#define LATENCY_WALK_S 2e-5f
#define MAP_SIGMA_DEG 0.4f /* what a part of the map may be off by itself */

/* A lower triangle, row after row. */
static float* covariance_at(heading_filter* filter, int i, int j) {
  return &filter->covariance[i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i];
}

static float covariance_of(const heading_filter* filter, int i, int j) {
  return filter->covariance[i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i];
}

static float sigma_of(const heading_filter* filter, int i) {
  return root(covariance_of(filter, i, i));
}

static void keep_heading_around(heading_filter* filter) {
  const int32_t turns = floor_of(filter->value[HEADING] / 360.0f);
  filter->value[HEADING] -= 360.0f * (float)turns;
  filter->turns += turns;
}

/* A new guess of the heading: so much more, and how well that is known. */
static void turn_heading(heading_filter* filter, float deg, float sigma_deg) {
  filter->value[HEADING] += deg;
  filter->moved_deg += deg;
  keep_heading_around(filter);
  for (int i = 0; i < STATES; ++i) *covariance_at(filter, HEADING, i) = 0.0f;
  *covariance_at(filter, HEADING, HEADING) = square(sigma_deg);
}

/* What is known of the sensors; nothing is of a map. */
static void know_sensors(heading_filter* filter, float bias_sigma_dps, float scale_sigma,
                         float latency_sigma_s) {
  memset(filter->covariance, 0, sizeof filter->covariance);
  *covariance_at(filter, BIAS, BIAS) = square(bias_sigma_dps);
  *covariance_at(filter, SCALE, SCALE) = square(scale_sigma);
  *covariance_at(filter, LATENCY, LATENCY) = square(latency_sigma_s);
}

/* The map's origin is the heading, and the sensors are known as they are. */
static void begin_filter(heading_filter* filter) {
  for (int i = FIRST_NODE; i < STATES; ++i) {
    filter->value[i] = 0.0f;
    for (int j = 0; j < STATES; ++j) *covariance_at(filter, i, j) = 0.0f;
  }
  for (int i = BIAS; i < FIRST_NODE; ++i) *covariance_at(filter, HEADING, i) = 0.0f;
  *covariance_at(filter, HEADING, HEADING) = square(START_SIGMA_DEG);
  memset(filter->node, 0, sizeof filter->node);
  filter->is_learning = 1;
}

static void filter_predict(heading_filter* filter, float turned_deg, float step_s, float unseen_deg2) {
  const float scale = filter->value[SCALE], step_deg = (turned_deg - filter->value[BIAS] * step_s) / scale;
  const float by_bias = -step_s / scale, by_scale = -step_deg / scale;
  float moved[STATES], own;
  filter->value[HEADING] += step_deg;
  keep_heading_around(filter);
  for (int i = 0; i < STATES; ++i)
    moved[i] = covariance_of(filter, HEADING, i) + by_bias * covariance_of(filter, BIAS, i) +
               by_scale * covariance_of(filter, SCALE, i);
  own = moved[HEADING] + by_bias * moved[BIAS] + by_scale * moved[SCALE];
  for (int i = 0; i < STATES; ++i) *covariance_at(filter, HEADING, i) = moved[i];
  *covariance_at(filter, HEADING, HEADING) = own + square(HEADING_WALK_DEG) * step_s + unseen_deg2;
  *covariance_at(filter, BIAS, BIAS) += square(BIAS_WALK_DPS) * step_s;
  *covariance_at(filter, SCALE, SCALE) += square(SCALE_WALK) * step_s;
  *covariance_at(filter, LATENCY, LATENCY) += square(LATENCY_WALK_S) * step_s;
}

/* To a time, with the path's variance of what nothing measured. Returns whether that is later than it was. */
static int advance(heading_filter* filter, const gyro_path* path, uint32_t now_us, float unseen_deg2) {
  const gyro_knot now = path_until(path, now_us);
  const float step_s = seconds_between(filter->now_us, now_us);
  if (filter->has_begun && step_s <= 0.0f) return 0;
  if (filter->has_begun)
    filter_predict(filter, degrees_between(filter->now_turned, now.turned), step_s, unseen_deg2);
  filter->has_begun = 1;
  filter->now_us = now_us;
  filter->now_turned = now.turned;
  return 1;
}

/* What the gyro turned by since the middle of an exposure; the heading then was so much less. */
static float turned_since_deg(const heading_filter* filter, const exposed_turn* turn) {
  return (degrees_between(turn->mean_turned, filter->now_turned) -
          filter->value[BIAS] * seconds_between(turn->mean_us, filter->now_us)) /
         filter->value[SCALE];
}

static float exposed_deg(const heading_filter* filter, const exposed_turn* turn) {
  return around(filter->value[HEADING] - turned_since_deg(filter, turn));
}

static float exposed_rate_dps(const heading_filter* filter, const exposed_turn* turn) {
  return (turn->turned_deg / turn->length_s - filter->value[BIAS]) / filter->value[SCALE];
}

/* Half the width of what a ray sweeps, if it sweeps evenly. */
static float half_width_deg(const heading_filter* filter, const exposed_turn* turn) {
  const float bias = filter->value[BIAS];
  const float variance =
      turn->variance_deg2 - 2.0f * bias * turn->covariance + bias * bias * turn->variance_s2;
  return root(3.0f * variance) / size_of(filter->value[SCALE]);
}

/* Between its nodes the map's offset is a straight line. */
static void add_shares(float azimuth_deg, float weight, float shares[NODES]) {
  const float position = around(azimuth_deg) / NODE_DEG;
  const int left = (int)position;
  const float part = position - (float)left;
  shares[left % NODES] += weight * (1.0f - part);
  shares[(left + 1) % NODES] += weight * part;
}

static float map_offset_deg(const heading_filter* filter, float azimuth_deg) {
  const float position = around(azimuth_deg) / NODE_DEG;
  const int left = (int)position;
  const float a = filter->value[FIRST_NODE + left % NODES],
              b = filter->value[FIRST_NODE + (left + 1) % NODES];
  return a + (position - (float)left) * (b - a);
}

/* Of exposed_deg() less the map's offset about it, by the state. */
static void derivative(const heading_filter* filter, const exposed_turn* turn, const float about[NODES],
                       float row[STATES]) {
  row[HEADING] = 1.0f;
  row[BIAS] = seconds_between(turn->mean_us, filter->now_us) / filter->value[SCALE];
  row[SCALE] = turned_since_deg(filter, turn) / filter->value[SCALE];
  row[LATENCY] = -exposed_rate_dps(filter, turn);
  for (int node = 0; node < NODES; ++node) row[FIRST_NODE + node] = -about[node];
}

/* Returns the variance of row * state, and leaves the covariance times the row in `across`. */
static float variance_along(const heading_filter* filter, const float row[STATES], float across[STATES]) {
  float total = 0.0f;
  for (int i = 0; i < STATES; ++i) {
    across[i] = 0.0f;
    for (int j = 0; j < STATES; ++j)
      if (row[j] != 0.0f) across[i] += covariance_of(filter, i, j) * row[j];
    total += row[i] * across[i];
  }
  return most(0.0f, total);
}

static void filter_update(heading_filter* filter, const float across[STATES], float innovation, float total) {
  float* covariance = filter->covariance;
  for (int i = 0; i < STATES; ++i) {
    const float gain = across[i] / total;
    filter->value[i] += gain * innovation;
    for (int j = 0; j <= i; ++j) *covariance++ -= gain * across[j];
  }
  filter->moved_deg += across[HEADING] / total * innovation;
  for (int i = 0; i < FIRST_NODE; ++i)
    *covariance_at(filter, i, i) = most(*covariance_at(filter, i, i), 1e-14f);
  filter->value[SCALE] = least(2.0f, most(0.5f, filter->value[SCALE]));
  keep_heading_around(filter);
}

enum { NODE_NONE, NODE_NEAR, NODE_SEEN }; /* near: only what lies between it and the next */

/* Nodes that are first shown begin with the error of where the half is put. That is not what the heading is
 * off: latency moves all halves of one speed alike, and none of them shows it. And they are off by
 * themselves. `shown`: derivative() of where the half is put, without a map. */
static void begin_nodes(heading_filter* filter, float low_deg, float high_deg, const float shown[STATES]) {
  const int32_t last = -floor_of(-high_deg / NODE_DEG);
  float across[STATES];
  for (int32_t node = floor_of(low_deg / NODE_DEG); node <= last; ++node) {
    const int place = (int)((node % NODES + NODES) % NODES), at = FIRST_NODE + place;
    const int before = (place + NODES - 1) % NODES, behind = (place + 1) % NODES;
    const float at_deg = (float)node * NODE_DEG;
    const uint8_t now = at_deg >= low_deg && at_deg <= high_deg ? NODE_SEEN : NODE_NEAR;
    if (now <= filter->node[place]) continue;
    if (filter->node[place] == NODE_NONE) {
      if (filter->node[before] != NODE_NONE)
        filter->value[at] = filter->value[FIRST_NODE + before];
      else if (filter->node[behind] != NODE_NONE)
        filter->value[at] = filter->value[FIRST_NODE + behind];
    }
    filter->node[place] = now;
    across[at] = variance_along(filter, shown, across) + square(MAP_SIGMA_DEG);
    for (int i = 0; i < STATES; ++i) *covariance_at(filter, at, i) = across[i];
  }
}

/* Parts of the surroundings were never seen. */
static int has_gap(const heading_filter* filter) {
  for (int node = 0; node < NODES; ++node)
    if (filter->node[node] != NODE_SEEN) return 1;
  return 0;
}

/* So much of the map about each node was written anew, where the half is put: it is off by as much. */
static void rewrite_nodes(heading_filter* filter, const float shares[NODES], const float shown[STATES]) {
  float mixed[STATES], across[STATES];
  for (int node = 0; node < NODES; ++node) {
    const float share = shares[node];
    const int at = FIRST_NODE + node;
    if (share <= 0.0f) continue;
    variance_along(filter, shown, across);
    for (int i = 0; i < STATES; ++i)
      mixed[i] = (1.0f - share) * covariance_of(filter, at, i) + share * across[i];
    mixed[at] = (1.0f - share) * mixed[at];
    for (int i = 0; i < FIRST_NODE; ++i) mixed[at] += share * shown[i] * mixed[i];
    for (int i = 0; i < STATES; ++i) *covariance_at(filter, at, i) = mixed[i];
  }
}

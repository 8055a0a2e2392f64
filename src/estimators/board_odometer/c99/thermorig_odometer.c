/* SPDX-License-Identifier: MIT
 *
 * Heading from a gyro, a thermal camera and a map of the surroundings, for small boards. A Kalman filter over
 * heading, gyro bias, gyro scale, camera latency and 24 offsets of the map; each chess half that is new is
 * laid against the map, tells the heading, and is then written into the map.
 *
 *   gyro path -> exposed turn -> search of the bias (3 s of halves: the sharpest mosaic)
 *                             -> alignment with the map -> filter -> pixels, map
 *                             -> search on the circle, where the heading is lost
 */
#include "thermorig_odometer.h"

#include <math.h>
#include <string.h>

#define ROWS THERMORIG_ODOMETER_ROWS
#define COLUMNS THERMORIG_ODOMETER_COLUMNS
#define HALF_COLUMNS THERMORIG_ODOMETER_HALF_COLUMNS
#define BINS THERMORIG_ODOMETER_BINS
#define NODES THERMORIG_ODOMETER_NODES
#define STATES THERMORIG_ODOMETER_STATES
#define KNOTS THERMORIG_ODOMETER_KNOTS
#define HALVES THERMORIG_ODOMETER_SEARCHED_HALVES
#define BIASES THERMORIG_ODOMETER_BIASES
#define WINDOW THERMORIG_ODOMETER_WINDOW

typedef thermorig_odometer_state odometer;
typedef thermorig_odometer_knot gyro_knot;
typedef thermorig_odometer_sums row_sums;

/* The caller's memory is as large as the header says. */
typedef char odometer_state_size_is_as_stated[sizeof(odometer) == THERMORIG_ODOMETER_STATE_BYTES ? 1 : -1];

enum { HEADING, BIAS, SCALE, LATENCY, FIRST_NODE };
enum { SEARCHING, LEARNING, RUNNING, LOCATING };

/* ---- Numbers ---- */

#define UNKNOWN_K 1e6f          /* a pixel without a reading */
#define MAP_STEPS 256.0f        /* of the map, a kelvin */
#define PIXEL_STEPS 4096.0f     /* of a pixel's error, a kelvin */
#define VARIANCE_STEPS 16384.0f /* of a variance, a kelvin squared */
#define TURNED_STEPS 1048576.0f /* of the gyro's path, a degree */

static float square(float x) {
  return x * x;
}

static float least(float a, float b) {
  return a < b ? a : b;
}

static float most(float a, float b) {
  return a > b ? a : b;
}

static float size_of(float x) {
  return x < 0.0f ? -x : x;
}

static float root(float x) {
  return sqrtf(most(0.0f, x));
}

static int32_t floor_of(float x) {
  const int32_t whole = (int32_t)x;
  return (float)whole > x ? whole - 1 : whole;
}

/* Of what is not above 0, within 5e-6: libraries' expf differ in the last bit, and boards should not. */
static float power_of_e(float x) {
  const float twos = most(-80.0f, x) * 1.44269504f;
  const int32_t whole = floor_of(twos);
  const float y = (twos - (float)whole) * 0.69314718f;
  const uint32_t bits = (uint32_t)(whole + 127) << 23; /* 2 to the power of `whole` */
  float scale, series = 1.0f;
  if (x < -80.0f) return 0.0f;
  memcpy(&scale, &bits, sizeof scale);
  for (int i = 7; i > 0; --i) series = 1.0f + y / (float)i * series;
  return scale * series;
}

/* An angle between 0 and 360. */
static float around(float deg) {
  const float rest = deg - 360.0f * (float)floor_of(deg / 360.0f);
  return rest >= 360.0f ? rest - 360.0f : most(0.0f, rest);
}

/* An angle between -180 and 180. */
static float apart(float deg) {
  return around(deg + 180.0f) - 180.0f;
}

static float seconds_between(uint32_t from_us, uint32_t to_us) {
  return 1e-6f * (float)(int32_t)(to_us - from_us);
}

static float degrees_between(uint32_t from, uint32_t to) {
  return (float)(int32_t)(to - from) / TURNED_STEPS;
}

/* Numerical Recipes' linear congruential generator. What is kept in few bits is rounded at random: then many
 * small changes add up as they should. */
static uint32_t next_noise(odometer* s) {
  s->noise = s->noise * 1664525u + 1013904223u;
  return s->noise;
}

/* `x` may be beyond any whole number. */
static int32_t rounded(float x, uint32_t noise, int32_t limit) {
  const float between = (float)(noise >> 16) / 65536.0f;
  if (!(x > (float)-limit)) return -limit;
  return x < (float)limit ? floor_of(x + between) : limit;
}

/* Degrees as a part of the gyro's path: more than a thousand at once are of a gyro that was away. */
static uint32_t steps_of(float deg) {
  return (uint32_t)(int32_t)(least(1000.0f, most(-1000.0f, deg)) * TURNED_STEPS);
}

/* A variance in 8 bits, 4 of exponent and 4 of mantissa; 0 stands for what nothing has seen. */
static uint32_t variance_of(uint8_t code) {
  return code == 0 ? 0u : (16u + (code & 15u)) << (code >> 4);
}

static uint8_t code_of(float variance, uint32_t noise) {
  const float steps = least(1015807.0f, most(17.0f, variance * VARIANCE_STEPS)); /* codes 1 to 255 */
  uint32_t bits;
  memcpy(&bits, &steps, sizeof bits);
  bits = ((bits + (noise >> 13)) >> 19) - (131u << 4);
  return (uint8_t)(bits > 255u ? 255u : bits);
}

/* ---- The gyro's path ---- */

/* What the gyro turned by while a chess half was exposed, bias and scale not removed: enough to know the mean
 * heading and its spread for any bias and scale. */
typedef struct {
  uint32_t mean_us, mean_turned;
  float length_s, turned_deg;
  float variance_s2, variance_deg2, covariance;
  float change_dps; /* of the reading, from the first third to the last */
  float across_dps; /* from one end to the other */
} exposed_turn;

static const gyro_knot* knot_at(const odometer* s, uint32_t place) {
  return &s->knot[place % KNOTS];
}

static uint32_t first_knot(const odometer* s) {
  return s->knots > KNOTS ? s->knots - KNOTS : 0u;
}

/* At any time; after the newest sample its rate goes on, and before the oldest that is kept its was. */
static gyro_knot path_until(const odometer* s, uint32_t time_us) {
  uint32_t later = s->knots;
  gyro_knot at;
  float step_s, slope;
  const gyro_knot *a, *b;
  while (later > first_knot(s) && (int32_t)(knot_at(s, later - 1u)->time_us - time_us) > 0) --later;
  if (later == first_knot(s) || later == s->knots) {
    at = *knot_at(s, later == s->knots ? later - 1u : later);
    step_s = seconds_between(at.time_us, time_us);
    at.turned += steps_of(at.rate_dps * step_s);
    at.time_us = time_us;
    return at;
  }
  a = knot_at(s, later - 1u);
  b = knot_at(s, later);
  step_s = seconds_between(a->time_us, time_us);
  slope = (b->rate_dps - a->rate_dps) / seconds_between(a->time_us, b->time_us);
  at.time_us = time_us;
  at.turned = a->turned + steps_of((a->rate_dps + 0.5f * slope * step_s) * step_s);
  at.rate_dps = a->rate_dps + slope * step_s;
  return at;
}

static void path_over(const odometer* s, uint32_t begin_us, uint32_t end_us, exposed_turn* turn) {
  enum { POINTS = 24, THIRD = POINTS / 3 };
  const gyro_knot first = path_until(s, begin_us), last = path_until(s, end_us);
  const uint32_t length_us = end_us - begin_us;
  float sum = 0.0f, squares = 0.0f, products = 0.0f, first_deg = 0.0f, last_deg = 0.0f, third_s;
  turn->mean_us = begin_us + length_us / 2u;
  turn->length_s = 1e-6f * (float)length_us;
  turn->turned_deg = degrees_between(first.turned, last.turned);
  turn->across_dps = last.rate_dps - first.rate_dps;
  turn->variance_s2 = 0.0f;
  for (int i = 0; i < POINTS; ++i) {
    const float off_s = turn->length_s * (((float)i + 0.5f) / (float)POINTS - 0.5f);
    const uint32_t time_us = turn->mean_us + (uint32_t)(int32_t)(1e6f * off_s);
    const float deg = degrees_between(first.turned, path_until(s, time_us).turned);
    sum += deg;
    squares += deg * deg;
    products += deg * off_s;
    turn->variance_s2 += off_s * off_s / (float)POINTS;
    if (i == THIRD) first_deg = deg;
    if (i == POINTS - 1 - THIRD) last_deg = deg;
  }
  sum /= (float)POINTS;
  turn->mean_turned = first.turned + steps_of(sum);
  turn->variance_deg2 = squares / (float)POINTS - sum * sum;
  turn->covariance = products / (float)POINTS;
  third_s = turn->length_s * ((float)THIRD + 0.5f) / (float)POINTS;
  turn->change_dps = (turn->turned_deg - last_deg - first_deg) / third_s;
}

/* ---- The filter ---- */

#define NODE_DEG (360.0f / (float)NODES)
#define START_SIGMA_DEG 1e-3f  /* the map's origin is the first heading */
#define HEADING_WALK_DEG 0.03f /* in a square root of a second: noise of the gyro */
#define BIAS_WALK_DPS 0.008f
#define SCALE_WALK 2e-5f
#define LATENCY_WALK_S 2e-5f

/* A lower triangle, row after row. */
static float* covariance_at(odometer* s, int i, int j) {
  return &s->covariance[i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i];
}

static float covariance_of(const odometer* s, int i, int j) {
  return s->covariance[i >= j ? i * (i + 1) / 2 + j : j * (j + 1) / 2 + i];
}

static float sigma_of(const odometer* s, int i) {
  return root(covariance_of(s, i, i));
}

static void keep_heading_around(odometer* s) {
  const int32_t turns = floor_of(s->value[HEADING] / 360.0f);
  s->value[HEADING] -= 360.0f * (float)turns;
  s->turns += turns;
}

/* What is known of the sensors; nothing is of a map. */
static void know_sensors(odometer* s, float bias_sigma_dps, float scale_sigma, float latency_sigma_s) {
  memset(s->covariance, 0, sizeof s->covariance);
  *covariance_at(s, BIAS, BIAS) = square(bias_sigma_dps);
  *covariance_at(s, SCALE, SCALE) = square(scale_sigma);
  *covariance_at(s, LATENCY, LATENCY) = square(latency_sigma_s);
}

/* The map's origin is the heading, and the sensors are known as they are. */
static void begin_filter(odometer* s) {
  for (int i = FIRST_NODE; i < STATES; ++i) {
    s->value[i] = 0.0f;
    for (int j = 0; j < STATES; ++j) *covariance_at(s, i, j) = 0.0f;
  }
  for (int i = BIAS; i < FIRST_NODE; ++i) *covariance_at(s, HEADING, i) = 0.0f;
  *covariance_at(s, HEADING, HEADING) = square(START_SIGMA_DEG);
  memset(s->node, 0, sizeof s->node);
}

static void filter_predict(odometer* s, float turned_deg, float step_s, float unseen_deg2) {
  const float scale = s->value[SCALE], step_deg = (turned_deg - s->value[BIAS] * step_s) / scale;
  const float by_bias = -step_s / scale, by_scale = -step_deg / scale;
  float moved[STATES], own;
  s->value[HEADING] += step_deg;
  keep_heading_around(s);
  for (int i = 0; i < STATES; ++i)
    moved[i] = covariance_of(s, HEADING, i) + by_bias * covariance_of(s, BIAS, i) +
               by_scale * covariance_of(s, SCALE, i);
  own = moved[HEADING] + by_bias * moved[BIAS] + by_scale * moved[SCALE];
  for (int i = 0; i < STATES; ++i) *covariance_at(s, HEADING, i) = moved[i];
  *covariance_at(s, HEADING, HEADING) = own + square(HEADING_WALK_DEG) * step_s + unseen_deg2;
  *covariance_at(s, BIAS, BIAS) += square(BIAS_WALK_DPS) * step_s;
  *covariance_at(s, SCALE, SCALE) += square(SCALE_WALK) * step_s;
  *covariance_at(s, LATENCY, LATENCY) += square(LATENCY_WALK_S) * step_s;
}

/* What the gyro turned by since the middle of an exposure; the heading then was so much less. */
static float turned_since_deg(const odometer* s, const exposed_turn* turn) {
  return (degrees_between(turn->mean_turned, s->now_turned) -
          s->value[BIAS] * seconds_between(turn->mean_us, s->now_us)) /
         s->value[SCALE];
}

static float exposed_deg(const odometer* s, const exposed_turn* turn) {
  return around(s->value[HEADING] - turned_since_deg(s, turn));
}

static float exposed_rate_dps(const odometer* s, const exposed_turn* turn) {
  return (turn->turned_deg / turn->length_s - s->value[BIAS]) / s->value[SCALE];
}

/* Half the width of what a ray sweeps, if it sweeps evenly. */
static float half_width_deg(const odometer* s, const exposed_turn* turn) {
  const float bias = s->value[BIAS];
  const float variance =
      turn->variance_deg2 - 2.0f * bias * turn->covariance + bias * bias * turn->variance_s2;
  return root(3.0f * variance) / size_of(s->value[SCALE]);
}

/* Between its nodes the map's offset is a straight line. */
static void add_shares(float azimuth_deg, float weight, float shares[NODES]) {
  const float position = around(azimuth_deg) / NODE_DEG;
  const int left = (int)position;
  const float part = position - (float)left;
  shares[left % NODES] += weight * (1.0f - part);
  shares[(left + 1) % NODES] += weight * part;
}

static float map_offset_deg(const odometer* s, float azimuth_deg) {
  const float position = around(azimuth_deg) / NODE_DEG;
  const int left = (int)position;
  const float a = s->value[FIRST_NODE + left % NODES], b = s->value[FIRST_NODE + (left + 1) % NODES];
  return a + (position - (float)left) * (b - a);
}

/* Of exposed_deg() less the map's offset about it, by the state. */
static void derivative(const odometer* s, const exposed_turn* turn, const float about[NODES],
                       float row[STATES]) {
  row[HEADING] = 1.0f;
  row[BIAS] = seconds_between(turn->mean_us, s->now_us) / s->value[SCALE];
  row[SCALE] = turned_since_deg(s, turn) / s->value[SCALE];
  row[LATENCY] = -exposed_rate_dps(s, turn);
  for (int node = 0; node < NODES; ++node) row[FIRST_NODE + node] = -about[node];
}

/* Returns the variance of row * state, and leaves the covariance times the row in `across`. */
static float variance_along(const odometer* s, const float row[STATES], float across[STATES]) {
  float total = 0.0f;
  for (int i = 0; i < STATES; ++i) {
    across[i] = 0.0f;
    for (int j = 0; j < STATES; ++j)
      if (row[j] != 0.0f) across[i] += covariance_of(s, i, j) * row[j];
    total += row[i] * across[i];
  }
  return most(0.0f, total);
}

static void filter_update(odometer* s, const float across[STATES], float innovation, float total) {
  float* covariance = s->covariance;
  for (int i = 0; i < STATES; ++i) {
    const float gain = across[i] / total;
    s->value[i] += gain * innovation;
    for (int j = 0; j <= i; ++j) *covariance++ -= gain * across[j];
  }
  for (int i = 0; i < FIRST_NODE; ++i) *covariance_at(s, i, i) = most(*covariance_at(s, i, i), 1e-14f);
  s->value[SCALE] = least(2.0f, most(0.5f, s->value[SCALE]));
  keep_heading_around(s);
}

enum { NODE_NONE, NODE_NEAR, NODE_SEEN }; /* near: only what lies between it and the next */

/* Nodes that are first shown begin with the error of the heading: what is seen there is put where that says.
 */
static void begin_nodes(odometer* s, float low_deg, float high_deg) {
  const int32_t last = -floor_of(-high_deg / NODE_DEG);
  for (int32_t node = floor_of(low_deg / NODE_DEG); node <= last; ++node) {
    const int place = (int)((node % NODES + NODES) % NODES), at = FIRST_NODE + place;
    const int before = (place + NODES - 1) % NODES, behind = (place + 1) % NODES;
    const float at_deg = (float)node * NODE_DEG;
    const uint8_t now = at_deg >= low_deg && at_deg <= high_deg ? NODE_SEEN : NODE_NEAR;
    if (now <= s->node[place]) continue;
    if (s->node[place] == NODE_NONE) {
      if (s->node[before] != NODE_NONE)
        s->value[at] = s->value[FIRST_NODE + before];
      else if (s->node[behind] != NODE_NONE)
        s->value[at] = s->value[FIRST_NODE + behind];
    }
    s->node[place] = now;
    for (int i = 0; i < STATES; ++i)
      if (i != at) *covariance_at(s, at, i) = covariance_of(s, HEADING, i);
    *covariance_at(s, at, at) = covariance_of(s, HEADING, HEADING);
  }
}

/* ---- The map ---- */

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

static float bearing_deg(const odometer* s, int column) {
  return s->profile.direction * s->profile.pitch_deg * ((float)column - 0.5f * (float)(COLUMNS - 1));
}

/* In bins from the map's origin, without its end: neighbouring columns lie side by side. */
static float column_position(const odometer* s, float azimuth_deg, int column) {
  const float at_deg = azimuth_deg + bearing_deg(s, column);
  return (at_deg - map_offset_deg(s, at_deg)) / BIN_DEG;
}

static float half_bins(float half_deg) {
  return least(WIDEST, most(0.5f, half_deg / BIN_DEG));
}

/* Rows of one class were seen together: of even rows the first tells, of odd ones the second. */
static void find_known(const odometer* s, uint32_t parity, int32_t reach, sweep* at) {
  uint8_t unseen[2][WINDOW + 1];
  for (int odd = 0; odd < 2; ++odd) {
    int32_t bin = bin_of(at->begin);
    unseen[odd][0] = 0;
    for (int i = 0; i < at->length; ++i) {
      unseen[odd][i + 1] = (uint8_t)(unseen[odd][i] + (s->of.map.variance[odd][bin] == 0 ? 1 : 0));
      if (++bin == BINS) bin = 0;
    }
  }
  for (int column = 0; column < COLUMNS; ++column) {
    const uint8_t* of = unseen[((uint32_t)column ^ parity) & 1u];
    if (at->known[column])
      at->known[column] = of[at->low[column] - reach] == of[at->high[column] + reach + 1];
  }
}

static void place_columns(const odometer* s, uint32_t parity, float azimuth_deg, float half, int32_t reach,
                          sweep* at) {
  float position[COLUMNS], lowest = 1e9f, highest = -1e9f;
  for (int column = 0; column < COLUMNS; ++column) {
    position[column] = column_position(s, azimuth_deg, column);
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
  find_known(s, parity, reach, at);
}

/* Sums over all bins of the window before. */
static const row_sums* add_up(odometer* s, int row, const sweep* at) {
  const int16_t* of = s->of.map.temp[row];
  const uint8_t* code = s->of.map.variance[row];
  row_sums* sums = &s->scratch.sums;
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
  return sums;
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

/* ---- Alignment ---- */

#define FEWEST_PIXELS 40.0f
#define HUBER 3.0f
#define STRICT_SQUARES 9.0f
#define LARGEST_SQUARES (HUBER * HUBER * HUBER) /* what one pixel counts at most */
#define LEAST_KNOWN_SHARE 0.25f

typedef struct {
  uint32_t parity;
  float half;       /* bins to either side of what a ray sweeps */
  float trust_deg2; /* of the heading beforehand: what it explains is no outlier */
  int is_strict;    /* what fits badly counts for nothing */
  float common_k, flat_k;
} view;

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

static float pixel_variance(const odometer* s, uint32_t parity, int row, int j) {
  return (float)variance_of(s->pixel_variance[parity][row][j]) / VARIANCE_STEPS;
}

/* What all pixels have in common, and how well a half fits without it: no slopes, no weights. `limit_k`: a
 * pixel counts so much at most. Returns the mean square of a pixel by its noise, and less where it cannot be
 * told 1e9. */
static float fit_at(odometer* s, const view* v, float azimuth_deg, float limit_k, float* common_k,
                    float* flat_k) {
  sweep at;
  float count = 0.0f, weights = 0.0f, sum = 0.0f, squares = 0.0f, flat = 0.0f;
  place_columns(s, v->parity, azimuth_deg, v->half, 1, &at);
  for (int row = 0; row < ROWS; ++row) {
    const row_sums* sums = add_up(s, row, &at);
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const int column = 2 * j + (int)(((uint32_t)row ^ v->parity) & 1u);
      const float shown_k = s->half[row][j];
      float off, weight;
      if (!at.known[column] || shown_k >= UNKNOWN_K) continue;
      weight = 1.0f / (pixel_variance(s, v->parity, row, j) + expected_variance(sums, &at, column));
      off = shown_k - expected_k(sums, &at, column) - *common_k;
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
  float temp_k[HALF_COLUMNS], variance[HALF_COLUMNS]; /* of the half's own columns */
  float slope[COLUMNS], slope_variance[COLUMNS];      /* K a deg */
} row_look;

static void look_at_row(odometer* s, int row, const view* v, const sweep* at, int32_t reach, int all_columns,
                        row_look* look) {
  const float scale = 1.0f / (at->width * 2.0f * (float)reach * BIN_DEG);
  const int own = (int)(((uint32_t)row ^ v->parity) & 1u);
  const row_sums* sums = add_up(s, row, at);
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

typedef struct {
  float weights, residuals, slopes, squares, products, noise;
  float of_column[COLUMNS]; /* squares */
} slope_sums;

/* The pixels of a row; `above` and `below` lend their slopes, if they are not the row itself. */
static void compare_row(const odometer* s, int row, const view* v, const sweep* at, const row_look* own,
                        const row_look* above, const row_look* below, slope_sums* sums, comparison* to) {
  for (int j = 0; j < HALF_COLUMNS; ++j) {
    const int column = 2 * j + (int)(((uint32_t)row ^ v->parity) & 1u);
    const float shown_k = s->half[row][j];
    float slope = own->slope[column], slope_variance = own->slope_variance[column];
    float residual, weight, squares, flat;
    if (!at->known[column] || shown_k >= UNKNOWN_K) continue;
    if (above != own) {
      slope = 0.5f * slope + 0.25f * (above->slope[column] + below->slope[column]);
      slope_variance =
          0.25f * slope_variance + 0.0625f * (above->slope_variance[column] + below->slope_variance[column]);
    }
    weight = 1.0f / (pixel_variance(s, v->parity, row, j) + own->variance[j]);
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
static void compare(odometer* s, const view* v, float azimuth_deg, int32_t reach, int smooth,
                    comparison* to) {
  sweep at;
  row_look look[3];
  slope_sums sums;
  float steepness = 0.0f;
  memset(to, 0, sizeof *to);
  memset(&sums, 0, sizeof sums);
  place_columns(s, v->parity, azimuth_deg, v->half, reach, &at);
  for (int row = 0; row < ROWS + smooth; ++row) { /* with the row below a row is complete */
    const row_look* own = &look[smooth ? (row + 2) % 3 : 0];
    if (row < ROWS) look_at_row(s, row, v, &at, reach, smooth, &look[smooth ? row % 3 : 0]);
    if (!smooth)
      compare_row(s, row, v, &at, own, own, own, &sums, to);
    else if (row > 0)
      compare_row(s, row - 1, v, &at, own, &look[(row == 1 ? 1 : row + 1) % 3],
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
    add_shares(azimuth_deg + bearing_deg(s, column), sums.of_column[column] / steepness, to->about);
}

#define SEARCH_FROM_DEG 1.0f /* a heading that is known less well is searched for first */
#define SEARCH_STEPS 20      /* to either side */

/* The best of the headings that it may be, on a grid. Returns by how much it is off. */
static float searched_deg(odometer* s, const view* v, float azimuth_deg, float sigma_deg) {
  const float reach_deg = least(20.0f, 3.0f * sigma_deg),
              step_deg = most(0.5f, reach_deg / (float)SEARCH_STEPS);
  const int steps = (int)(reach_deg / step_deg);
  float best = 1e9f, best_deg = 0.0f;
  for (int i = -steps; i <= steps; ++i) {
    const float off_deg = (float)i * step_deg;
    float common_k = v->common_k, flat_k, cost;
    cost = fit_at(s, v, around(azimuth_deg + off_deg), 4.0f, &common_k, &flat_k) +
           square(off_deg / sigma_deg) / (float)(ROWS * HALF_COLUMNS);
    if (cost >= best) continue;
    best = cost;
    best_deg = off_deg;
  }
  return best_deg;
}

/* The best azimuth about one that is known to `sigma_deg`. Returns whether there is one; `off_deg`: from
 * there. */
static int find_azimuth(odometer* s, view* v, float azimuth_deg, float sigma_deg, float* off_deg,
                        comparison* found) {
  static const int32_t reaches[3] = {1, 2, 4};
  float least_deg2 = 1e9f;
  int slope = 0;
  comparison tried;
  *off_deg = 0.0f;
  if (fit_at(s, v, azimuth_deg, UNKNOWN_K, &v->common_k, &v->flat_k) >= 1e9f && sigma_deg <= SEARCH_FROM_DEG)
    return 0;
  if (sigma_deg > SEARCH_FROM_DEG) {
    *off_deg = searched_deg(s, v, azimuth_deg, sigma_deg);
    fit_at(s, v, around(azimuth_deg + *off_deg), UNKNOWN_K, &v->common_k, &v->flat_k);
  }
  for (int i = 0; i < 3; ++i) {
    compare(s, v, around(azimuth_deg + *off_deg), reaches[i], i > 0, &tried);
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
    compare(s, v, around(azimuth_deg + *off_deg), reaches[slope], slope > 0, found);
    if (found->pixels < FEWEST_PIXELS) return 0;
    if (size_of(step_deg) < 0.002f) break;
  }
  return variance_deg2_of(found) < 25.0f;
}

/* ---- Pixels and map learn ---- */

#define OFFSET_PRIOR 15.0f    /* readings: noise of 0.6 K against constant errors of 0.16 K */
#define VARIANCE_PRIOR 16.0f  /* readings for which a pixel counts as noisy as the data sheet says */
#define MOST_READINGS 4000.0f /* then what is older fades */
#define MOST_VARIANCES 500.0f
#define FIRST_PIXEL_VARIANCE 0.36f
#define LEAST_PIXEL_VARIANCE 0.01f

/* What is left of each pixel is its own error, and its noise. */
static void learn_pixels(odometer* s, view* v, float azimuth_deg) {
  sweep at;
  const float n = least(s->learnt[v->parity] + 1.0f, MOST_READINGS), m = least(n, MOST_VARIANCES);
  if (fit_at(s, v, azimuth_deg, UNKNOWN_K, &v->common_k, &v->flat_k) >= 1e9f) return;
  s->learnt[v->parity] = n;
  place_columns(s, v->parity, azimuth_deg, v->half, 1, &at);
  for (int row = 0; row < ROWS; ++row) {
    const row_sums* sums = add_up(s, row, &at);
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const int column = 2 * j + (int)(((uint32_t)row ^ v->parity) & 1u);
      int16_t* offset = &s->pixel_offset[v->parity][row][j];
      float residual, of_map, own;
      if (!at.known[column] || s->half[row][j] >= UNKNOWN_K) continue;
      residual = s->half[row][j] - expected_k(sums, &at, column) - v->common_k;
      of_map = expected_variance(sums, &at, column);
      own = pixel_variance(s, v->parity, row, j);
      *offset = (int16_t)rounded((float)*offset + PIXEL_STEPS * residual / (n + OFFSET_PRIOR), next_noise(s),
                                 32767);
      own += (least(16.0f * (own + of_map), residual * residual) - of_map - own) / (m + VARIANCE_PRIOR);
      s->pixel_variance[v->parity][row][j] = code_of(most(LEAST_PIXEL_VARIANCE, own), next_noise(s));
    }
  }
}

/* What a half shows at a column: the temperature without what is common, its slope along the row, its
 * variance. */
typedef struct {
  float temp_k, slope, variance;
} written;

static int to_write(const odometer* s, const view* v, int row, int j, float sigma_deg, written* pixel) {
  const int before = j > 0 ? j - 1 : j, behind = j + 1 < HALF_COLUMNS ? j + 1 : j;
  const float a = s->half[row][before], b = s->half[row][behind];
  pixel->temp_k = s->half[row][j] - v->common_k;
  pixel->slope = 0.0f;
  if (a < UNKNOWN_K && b < UNKNOWN_K)
    pixel->slope = (b - a) / (s->profile.direction * s->profile.pitch_deg * (float)(2 * (behind - before)));
  pixel->variance = pixel_variance(s, v->parity, row, j) + square(sigma_deg * pixel->slope);
  return s->half[row][j] < UNKNOWN_K;
}

static int16_t map_temp(odometer* s, float temp_k) {
  return (int16_t)rounded(temp_k * MAP_STEPS, next_noise(s), 32767);
}

/* Bins that nothing has seen yet begin with what the column lets expect. */
static void seed_column(odometer* s, const view* v, int column, float position, float sigma_deg) {
  const float pitch = s->profile.pitch_deg / BIN_DEG;
  const float about = column < 2 || column + 2 >= COLUMNS ? most(v->half, pitch) : pitch;
  const int odd = (int)(((uint32_t)column ^ v->parity) & 1u);
  const float swept_deg2 = square(v->half * BIN_DEG) + square(s->profile.pitch_deg);
  const int32_t to = floor_of(position + about);
  for (int32_t bin = floor_of(position - about); bin <= to; ++bin) {
    const int32_t place = bin_of(bin);
    const float off_deg = ((float)bin + 0.5f - position) * BIN_DEG;
    if (s->of.map.variance[odd][place] != 0) continue;
    for (int row = odd; row < ROWS; row += 2) {
      written pixel;
      const int is_read = to_write(s, v, row, column / 2, sigma_deg, &pixel);
      const float variance = 2.0f * pixel.variance + 0.3f * swept_deg2 * square(pixel.slope);
      s->of.map.temp[row][place] = is_read ? map_temp(s, pixel.temp_k + pixel.slope * off_deg) : 0;
      s->of.map.variance[row][place] = is_read ? code_of(variance, next_noise(s)) : 255;
    }
  }
}

/* A Kalman filter a bin, of all bins that a pixel sweeps. */
static void write_pixel(odometer* s, int row, float low, float width, const written* pixel) {
  int16_t* temp = s->of.map.temp[row];
  uint8_t* code = s->of.map.variance[row];
  const float high = low + width;
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
  innovation = pixel->temp_k * MAP_STEPS - mean;
  scale = 1.0f / (spread + pixel->variance * VARIANCE_STEPS);
  bin = first;
  for (int32_t i = from; i <= to; ++i) {
    const float share = i == from ? at_low : i == to ? at_high : inside;
    const float variance = (float)variance_of(code[bin]), gain = share * variance * scale;
    if (code[bin] != 0) {
      temp[bin] = (int16_t)rounded((float)temp[bin] + gain * innovation, next_noise(s), 32767);
      code[bin] = code_of(variance * (1.0f - gain * share) / VARIANCE_STEPS, next_noise(s));
    }
    if (++bin == BINS) bin = 0;
  }
}

static void write_map(odometer* s, const view* v, float azimuth_deg, float sigma_deg) {
  for (int column = 0; column < COLUMNS; ++column)
    seed_column(s, v, column, column_position(s, azimuth_deg, column), sigma_deg);
  for (int column = 0; column < COLUMNS; ++column) {
    const float low = column_position(s, azimuth_deg, column) - v->half;
    for (int row = (int)(((uint32_t)column ^ v->parity) & 1u); row < ROWS; row += 2) {
      written pixel;
      if (to_write(s, v, row, column / 2, sigma_deg, &pixel))
        write_pixel(s, row, low, 2.0f * v->half, &pixel);
    }
  }
}

/* ---- A half that was read anew ---- */

#define COLDEST_C (-60.0f) /* beyond: not a temperature of the sensor's range */
#define HOTTEST_C 400.0f
#define LARGEST_K 120.0f /* from the reference: what the map holds */

typedef struct {
  uint32_t begin_us, end_us, parity;
  float time_sigma_s;
} half_times;

/* What a half told the filter. */
typedef struct {
  int is_used, is_judged, is_flat;
  float squared, innovation_deg, rate_dps;
} half_result;

static int is_temperature(float temp_c) {
  return temp_c > COLDEST_C && temp_c < HOTTEST_C; /* not so for NaN */
}

/* Its temperatures without the pixels' errors, about a reference. */
static void take_half(odometer* s, const float* temp_c, uint32_t parity) {
  float sum = 0.0f, count = 0.0f;
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const float pixel_c = temp_c[row * COLUMNS + 2 * j + (int)(((uint32_t)row ^ parity) & 1u)];
      const int is_read = is_temperature(pixel_c);
      s->half[row][j] = is_read ? pixel_c : UNKNOWN_K;
      sum += is_read ? pixel_c : 0.0f;
      count += is_read ? 1.0f : 0.0f;
    }
  if (s->halves == 0 && count > 0.0f) s->reference_c = sum / count;
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      const float off_k = s->half[row][j] - s->reference_c;
      if (s->half[row][j] >= UNKNOWN_K) continue;
      s->half[row][j] = size_of(off_k) < LARGEST_K
                            ? off_k - (float)s->pixel_offset[parity][row][j] / PIXEL_STEPS
                            : UNKNOWN_K;
    }
}

#define VARIANCE_SHARE 1.44f /* halves see the same errors of the map again and again */
#define LEAST_SIGMA_DEG 0.03f
#define CHANGE_S 0.01f    /* a sweep that is not even is no box */
#define SURPRISING 4.0f   /* an innovation squared: counts less */
#define IMPOSSIBLE 30.0f  /* is not believed, and the map not written */
#define FIRST_HALVES 4    /* are only written: a map of one chess half has gaps */
#define FLAT_MARGIN 0.15f /* squares of a pixel */
#define SETTLED_HALVES 30
#define SETTLED_DEG 0.4f
#define MOVING_DPS 8.0f /* from there on errors of pixels are told from surroundings */

static float in_map_deg2(const odometer* s, const exposed_turn* turn, const float about[NODES],
                         float row[STATES], float across[STATES]) {
  derivative(s, turn, about, row);
  return variance_along(s, row, across);
}

/* Lays a half against the map, and tells the filter. */
static void judge_half(odometer* s, const half_times* times, const exposed_turn* turn, view* v,
                       half_result* result) {
  const float azimuth_deg = exposed_deg(s, turn);
  float ahead[NODES], row[STATES], across[STATES], prior_deg2, expected_deg2, noise_deg2, known_deg2;
  comparison found;
  memset(ahead, 0, sizeof ahead);
  add_shares(azimuth_deg, 1.0f, ahead);
  prior_deg2 = in_map_deg2(s, turn, ahead, row, across);
  s->in_map_deg = root(prior_deg2);
  v->trust_deg2 = prior_deg2;
  v->is_strict = s->halves > SETTLED_HALVES && prior_deg2 < square(SETTLED_DEG);
  if (!find_azimuth(s, v, azimuth_deg, s->in_map_deg, &result->innovation_deg, &found)) return;
  v->common_k = found.common_k;
  known_deg2 = in_map_deg2(s, turn, found.about, row, across);
  noise_deg2 = VARIANCE_SHARE * variance_deg2_of(&found) + square(LEAST_SIGMA_DEG) +
               square(CHANGE_S * turn->change_dps) + square(times->time_sigma_s * result->rate_dps);
  expected_deg2 = known_deg2 + noise_deg2;
  result->is_judged = 1;
  result->squared = square(result->innovation_deg) / expected_deg2;
  result->is_flat = found.flat_cost + FLAT_MARGIN < found.cost;
  result->is_used = result->squared <= IMPOSSIBLE && !result->is_flat;
  if (!result->is_used) return;
  if (result->squared > SURPRISING) noise_deg2 += expected_deg2 * (result->squared / SURPRISING - 1.0f);
  filter_update(s, across, result->innovation_deg, known_deg2 + noise_deg2);
  s->in_map_deg = root(in_map_deg2(s, turn, found.about, row, across));
  if (size_of(result->rate_dps) > MOVING_DPS) learn_pixels(s, v, exposed_deg(s, turn));
}

static exposed_turn turn_of(const odometer* s, const half_times* times) {
  const uint32_t late_us = (uint32_t)(int32_t)(1e6f * least(0.5f, most(-0.5f, s->value[LATENCY])));
  exposed_turn turn;
  path_over(s, times->begin_us - late_us, times->end_us - late_us, &turn);
  return turn;
}

static half_result add_half(odometer* s, const half_times* times) {
  const exposed_turn turn = turn_of(s, times);
  half_result result = {0, 0, 0, 0.0f, 0.0f, 0.0f};
  view v;
  float shown_deg, edge_deg;
  memset(&v, 0, sizeof v);
  result.rate_dps = exposed_rate_dps(s, &turn);
  v.parity = times->parity;
  v.half = half_bins(half_width_deg(s, &turn));
  v.common_k = s->common_c;
  if (s->halves < 1000000) ++s->halves;
  if (s->halves > FIRST_HALVES) {
    judge_half(s, times, &turn, &v, &result);
    s->common_c = v.common_k;
    if (result.is_judged && !result.is_used) return result;
  } else {
    v.common_k = 0.0f;
  }
  shown_deg = exposed_deg(s, &turn);
  edge_deg = (0.5f * (float)COLUMNS + 1.0f) * s->profile.pitch_deg + v.half * BIN_DEG;
  begin_nodes(s, shown_deg - edge_deg, shown_deg + edge_deg);
  write_map(s, &v, shown_deg, s->in_map_deg);
  return result;
}

/* ---- The bias from the first seconds ---- */

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
static void keep_half(odometer* s, const half_times* times) {
  thermorig_odometer_search* search = &s->of.search;
  const exposed_turn turn = turn_of(s, times);
  const int place = s->found_halves % HALVES;
  float sum = 0.0f, count = 1e-6f;
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j)
      if (s->half[row][j] < UNKNOWN_K) {
        sum += s->half[row][j];
        count += 1.0f;
      }
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j)
      search->temp[place][row][j] =
          s->half[row][j] < UNKNOWN_K
              ? (int16_t)rounded((s->half[row][j] - sum / count) * SEARCH_STEPS_A_K, 0x80000000u, 32767)
              : BROKEN;
  search->turned[place] = turn.mean_turned;
  search->time_us[place] = turn.mean_us;
  search->parity[place] = (uint8_t)times->parity;
  ++s->found_halves;
}

/* What a pixel shows on average beyond its neighbours is its own error; one that is far beyond is broken.
 * Otherwise the mosaic is sharpest where nothing seems to move. */
static void find_pixel_errors(odometer* s, uint32_t parity) {
  const thermorig_odometer_search* search = &s->of.search;
  float halves = 0.0f;
  for (int i = 0; i < HALVES; ++i) halves += search->parity[i] == parity ? 1.0f : 0.0f;
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      float sum = 0.0f;
      for (int i = 0; i < HALVES; ++i)
        if (search->parity[i] == parity)
          sum = search->temp[i][row][j] == BROKEN ? UNKNOWN_K : sum + (float)search->temp[i][row][j];
      s->half[row][j] = sum < UNKNOWN_K && halves > 0.0f ? sum / (halves * SEARCH_STEPS_A_K) : UNKNOWN_K;
    }
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      float about = 0.0f, count = 0.0f, error_k;
      for (int r = row - 2; r <= row + 2; ++r)
        for (int c = j - 1; c <= j + 1; ++c) {
          if (r < 0 || r >= ROWS || c < 0 || c >= HALF_COLUMNS || (r == row && c == j)) continue;
          if (s->half[r][c] >= UNKNOWN_K) continue;
          about += s->half[r][c];
          count += 1.0f;
        }
      error_k = s->half[row][j] < UNKNOWN_K && count > 0.0f ? s->half[row][j] - about / count : UNKNOWN_K;
      s->pixel_offset[parity][row][j] =
          size_of(error_k) > LARGEST_ERROR_K ? BROKEN : (int16_t)(int32_t)(error_k * SEARCH_STEPS_A_K);
    }
}

static int cells_a_row(const odometer* s) {
  const int cells = (int)(360.0f / s->profile.pitch_deg) + 1;
  return cells < THERMORIG_ODOMETER_CELLS ? cells : THERMORIG_ODOMETER_CELLS;
}

/* Of the readings within the cells of the mosaic that a bias makes. */
static float mosaic_variance(odometer* s, float bias_dps) {
  thermorig_odometer_search* search = &s->of.search;
  const int cells = cells_a_row(s);
  float squares = 0.0f, freedom = 1.0f;
  for (int i = 0; i < HALVES; ++i) {
    const float turned_deg = (degrees_between(search->turned[0], search->turned[i]) -
                              bias_dps * seconds_between(search->time_us[0], search->time_us[i])) /
                             s->profile.scale;
    for (int column = 0; column < COLUMNS; ++column) {
      const int cell = (int)(around(turned_deg + bearing_deg(s, column)) * (float)cells / 360.0f);
      search->cell_of[i][column] = (uint16_t)(cell < cells ? cell : cells - 1);
    }
  }
  for (int row = 0; row < ROWS; ++row) {
    memset(search->cell, 0, sizeof search->cell);
    for (int i = 0; i < HALVES; ++i) {
      const int odd = (row ^ search->parity[i]) & 1;
      const int16_t *temp = search->temp[i][row], *error = s->pixel_offset[search->parity[i]][row];
      for (int j = 0; j < HALF_COLUMNS; ++j) {
        thermorig_odometer_cell* cell = &search->cell[search->cell_of[i][2 * j + odd]];
        const float off_k = (float)(temp[j] - error[j]) / SEARCH_STEPS_A_K;
        if (temp[j] == BROKEN || error[j] == BROKEN) continue;
        cell->sum += off_k;
        cell->squares += off_k * off_k;
        cell->count += 1.0f;
      }
    }
    for (int i = 0; i < cells; ++i) {
      const thermorig_odometer_cell* cell = &search->cell[i];
      if (cell->count < 2.0f) continue;
      squares += cell->squares - cell->sum * cell->sum / cell->count;
      freedom += cell->count - 1.0f;
    }
  }
  return squares / freedom;
}

static int bias_steps(const odometer* s) {
  const float reach_dps = least(3.0f * s->profile.bias_sigma_dps, 0.5f * (float)(BIASES - 1) * BIAS_STEP_DPS);
  return (int)(reach_dps / BIAS_STEP_DPS);
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

/* Whether the mosaics tell the bias; else they do not yet. */
static int bias_found(const odometer* s, float* bias_dps, float* sigma_dps) {
  const float* variance = s->of.search.variance;
  const int steps = bias_steps(s), count = 2 * steps + 1;
  const float readings = TRUSTED_OF_MOSAIC * 0.5f * (float)(HALVES * ROWS * HALF_COLUMNS);
  float smallest = 1e30f, sum = 0.0f, mean = 0.0f, squares = 0.0f;
  for (int i = 0; i < count; ++i) smallest = least(smallest, variance[i]);
  if (!(smallest > 0.0f) || smallest > DISTINCT_SHARE * median_of(variance, count)) return 0;
  for (int i = -steps; i <= steps; ++i) {
    const float off_dps = (float)i * BIAS_STEP_DPS;
    const float weight = power_of_e(-readings * (variance[i + steps] / smallest - 1.0f) -
                                    0.5f * square(off_dps / s->profile.bias_sigma_dps));
    sum += weight;
    mean += weight * off_dps;
    squares += weight * off_dps * off_dps;
  }
  mean /= sum;
  *bias_dps = s->profile.bias_dps + mean;
  *sigma_dps = root(squares / sum - mean * mean + BIAS_STEP_DPS * BIAS_STEP_DPS / 12.0f);
  return *sigma_dps <= KNOWN_WELL_DPS;
}

/* Of the shaft, on average, while these halves were seen. */
static float searched_rate_dps(const odometer* s, float bias_dps) {
  const thermorig_odometer_search* search = &s->of.search;
  const int first = s->found_halves % HALVES, last = (first + HALVES - 1) % HALVES;
  const float step_s = seconds_between(search->time_us[first], search->time_us[last]);
  return (degrees_between(search->turned[first], search->turned[last]) / step_s - bias_dps) /
         s->profile.scale;
}

/* ---- Where the camera looks in a map that there is ---- */

#define TRUSTED_OF_HALF 0.2f /* of its likelihood: the next one sees the same surroundings */
#define FORGOTTEN 0.97f      /* a half: what came before counts a little less */
#define FEWEST_HALVES 6
#define CIRCLE_REACH 4 /* degrees to either side that belong to one place */
#define SURE 0.999f
#define BLOCK 120 /* places at a time */

/* Means of a row of the map over what a ray sweeps, around each bin. */
static void box_of(const odometer* s, int row, int beside, int16_t box[BINS]) {
  const int16_t* temp = s->of.map.temp[row];
  const int32_t count = 2 * beside + 1;
  int32_t sum = 0;
  for (int i = -beside; i <= beside; ++i) sum += temp[bin_of(i)];
  for (int bin = 0; bin < BINS; ++bin) {
    box[bin] = (int16_t)(sum / count);
    sum += temp[bin_of(bin + beside + 1)] - temp[bin_of(bin - beside)];
  }
}

static void known_of(const odometer* s, int odd, int beside, uint8_t known[BINS]) {
  const uint8_t* code = s->of.map.variance[odd];
  int32_t unseen = 0;
  for (int i = -beside; i <= beside; ++i) unseen += code[bin_of(i)] == 0;
  for (int bin = 0; bin < BINS; ++bin) {
    known[bin] = unseen == 0;
    unseen += (code[bin_of(bin + beside + 1)] == 0) - (code[bin_of(bin - beside)] == 0);
  }
}

/* A probability each degree of the circle, half after half. Where nothing is known of the surroundings, they
 * should be all alike. */
static void add_to_circle(odometer* s, const view* v) {
  const int beside = (int)(v->half + 0.001f);
  uint8_t known[2][BINS];
  int16_t box[BINS], base[COLUMNS];
  float count_of[COLUMNS], sum_of[COLUMNS], squares_of[COLUMNS], noise = 0.0f, best = -1e30f, mean_k = 0.0f,
                                                                 pixels = 0.0f;
  int32_t limit, sum[BLOCK], squares[BLOCK];
  for (int odd = 0; odd < 2; ++odd) known_of(s, odd, beside, known[odd]);
  for (int row = 0; row < ROWS; ++row)
    for (int j = 0; j < HALF_COLUMNS; ++j) {
      if (s->half[row][j] >= UNKNOWN_K) continue;
      pixels += 1.0f;
      noise += pixel_variance(s, v->parity, row, j);
      mean_k += s->half[row][j];
    }
  if (pixels < FEWEST_PIXELS) return;
  noise /= pixels;
  mean_k /= pixels;
  limit = (int32_t)(least(8.0f, sqrtf(LARGEST_SQUARES * noise)) * MAP_STEPS);
  for (int column = 0; column < COLUMNS; ++column) {
    base[column] = (int16_t)bin_of(floor_of((s->circle_deg + bearing_deg(s, column)) / BIN_DEG));
    count_of[column] = sum_of[column] = squares_of[column] = 0.0f;
    for (int row = (int)(((uint32_t)column ^ v->parity) & 1u); row < ROWS; row += 2) {
      const float shown_k = s->half[row][column / 2];
      if (shown_k >= UNKNOWN_K) continue;
      count_of[column] += 1.0f;
      sum_of[column] += shown_k - mean_k;
      squares_of[column] += least(LARGEST_SQUARES * noise, square(shown_k - mean_k));
    }
  }
  for (int first = 0; first < 360; first += BLOCK) {
    memset(sum, 0, sizeof sum);
    memset(squares, 0, sizeof squares);
    for (int row = 0; row < ROWS; ++row) {
      box_of(s, row, beside, box);
      for (int j = 0; j < HALF_COLUMNS; ++j) {
        const int column = 2 * j + (int)(((uint32_t)row ^ v->parity) & 1u);
        const uint8_t* is_known = known[row & 1];
        const float shown_k = s->half[row][j];
        const int32_t shown = (int32_t)((shown_k < UNKNOWN_K ? shown_k - s->common_c : 0.0f) * MAP_STEPS);
        int bin = (int)bin_of(base[column] + first);
        if (shown_k >= UNKNOWN_K) continue;
        for (int i = 0; i < BLOCK; ++i) {
          int32_t off = shown - box[bin];
          off = off > limit ? limit : off < -limit ? -limit : off;
          if (is_known[bin]) {
            sum[i] += off;
            squares[i] += off * off;
          }
          if (++bin == BINS) bin = 0;
        }
      }
    }
    for (int i = 0; i < BLOCK; ++i) {
      float count = 1e-6f, others = 1e-6f, flat = 0.0f, flat_squares = 0.0f, cost;
      for (int column = 0; column < COLUMNS; ++column) {
        const int bin = (int)bin_of(base[column] + first + i);
        if (known[((uint32_t)column ^ v->parity) & 1u][bin]) {
          count += count_of[column];
        } else {
          others += count_of[column];
          flat += sum_of[column];
          flat_squares += squares_of[column];
        }
      }
      cost = ((float)squares[i] - (float)sum[i] * (float)sum[i] / count) / (MAP_STEPS * MAP_STEPS) +
             flat_squares - flat * flat / others;
      s->scratch.circle[first + i] =
          FORGOTTEN * s->scratch.circle[first + i] - 0.5f * TRUSTED_OF_HALF * cost / noise;
    }
  }
  for (int i = 0; i < 360; ++i) best = most(best, s->scratch.circle[i]);
  for (int i = 0; i < 360; ++i) s->scratch.circle[i] -= best;
  ++s->searched;
}

/* Where it is, unless more than one place may be it. */
static int circle_found(const odometer* s, float* azimuth_deg, float* sigma_deg) {
  int best = 0;
  float all = 0.0f, near = 0.0f, mean = 0.0f, squares = 0.0f;
  if (s->searched < FEWEST_HALVES) return 0;
  for (int i = 0; i < 360; ++i)
    if (s->scratch.circle[i] > s->scratch.circle[best]) best = i;
  for (int i = 0; i < 360; ++i) {
    const float weight = power_of_e(s->scratch.circle[i]), off = apart((float)(i - best));
    all += weight;
    if (size_of(off) > (float)CIRCLE_REACH) continue;
    near += weight;
    mean += weight * off;
    squares += weight * off * off;
  }
  if (near < SURE * all) return 0;
  mean /= near;
  *azimuth_deg = around((float)best + mean + s->circle_deg);
  *sigma_deg = root(squares / near - mean * mean) + 0.7f;
  return 1;
}

/* ---- What goes on ---- */

/* Of the start: then the map is begun anew, with what was learnt of the sensors. */
#define FIRST_PASS_S 15.0f
#define PASS_S 20.0f
#define BIAS_WIDENING 2.0f
#define MOST_PASSES 6
#define PASS_WIDENING 3.0f /* of what the pass before learnt, and beside it */
#define DOUBT_BIAS_DPS 0.1f
#define DOUBT_SCALE 0.002f
#define DOUBT_LATENCY_S 0.003f
#define SETTLED_BIAS_DPS 0.2f
#define SETTLED_SCALE 0.003f
#define SETTLED_LATENCY_S 0.003f
#define SETTLED_NIS 2.0f
#define KNOWN_BIAS_DPS 1.0f
#define NIS_SHARE (1.0f / 30.0f) /* of a half in the mean of its kind */
#define NIS_LOST 8.0f
#define NIS_UNFIT 3.0f /* not trusted from the one on until the other */
#define NIS_FITS 2.0f
#define LONGEST_UNFIT_S 30.0f /* then the map is wrong */
#define MOST_NIS 60.0f        /* that one half counts with */
#define COVERED_HALVES 4      /* in a row */
#define HALVES_TO_TRUST 8     /* after a search */
#define DOUBTED_DEG 2.0f      /* a jump by more is doubted */
#define DOUBTED_SIGMAS 4.0f
#define TELLING_CHANGE_DPS 40.0f /* of the speed: then a wrong time would show */
#define LEAN_SHARE (1.0f / 16.0f)
#define MUCH_LEAN 0.7f
#define STEPPED_BIAS_DPS 0.3f
#define LONGEST_GYRO_GAP_S 0.25f
#define LONGEST_CAMERA_GAP_S 1.0f
#define LOST_DEG 3.0f /* a heading that is known less well is searched for */
#define GIVE_UP_S 40.0f
#define SATURATED_DPS 15.0f /* what a reading at the end of its range may be off */
#define SAMPLE_NOISE_DPS 0.15f
#define FROZEN_S 0.3f
#define LARGEST_RATE_DPS 10000.0f
#define LONGEST_EXPOSURE_US 4000000u

/* A new map; the heading goes on from where it is. */
static void begin_map(odometer* s) {
  memset(&s->of, 0, sizeof s->of);
  memset(s->pixel_offset, 0, sizeof s->pixel_offset);
  memset(s->pixel_variance, code_of(FIRST_PIXEL_VARIANCE, 0u), sizeof s->pixel_variance);
  s->learnt[0] = s->learnt[1] = 0.0f;
  begin_filter(s);
  s->halves = 0;
  s->common_c = 0.0f;
  s->in_map_deg = 0.0f;
  s->nis = 1.0f;
  s->lean = 0.0f;
}

/* The bias is searched for. */
static void begin_anew(odometer* s) {
  know_sensors(s, s->profile.bias_sigma_dps, s->profile.scale_sigma, s->profile.latency_sigma_s);
  begin_map(s);
  s->value[SCALE] = s->profile.scale;
  s->value[LATENCY] = 0.0f;
  s->found_halves = 0;
  s->tried = -1;
  s->covered = s->to_trust = 0;
  s->is_doubted = s->is_unfit = s->gyro_was_away = 0;
  s->pass_since_us = s->now_us;
  s->phase = SEARCHING;
}

/* The start once more, with what was learnt of the sensors meanwhile. */
static void begin_pass(odometer* s) {
  static const float doubt[FIRST_NODE] = {0.0f, DOUBT_BIAS_DPS, DOUBT_SCALE, DOUBT_LATENCY_S};
  for (int i = BIAS; i < FIRST_NODE; ++i) {
    for (int j = BIAS; j <= i; ++j) *covariance_at(s, i, j) *= square(PASS_WIDENING);
    *covariance_at(s, i, i) += square(doubt[i]);
  }
  s->begun_bias_dps = s->value[BIAS];
  s->begun_scale = s->value[SCALE];
  s->begun_latency_s = s->value[LATENCY];
  begin_map(s);
  ++s->pass;
  s->pass_since_us = s->now_us;
  s->phase = LEARNING;
}

/* The map was begun wrongly, and the sensors are known from the pass before. */
static void begin_pass_again(odometer* s) {
  s->value[BIAS] = s->begun_bias_dps;
  s->value[SCALE] = s->begun_scale;
  s->value[LATENCY] = s->begun_latency_s;
  know_sensors(s, 2.0f * DOUBT_BIAS_DPS, 2.0f * DOUBT_SCALE, 2.0f * DOUBT_LATENCY_S);
  begin_map(s);
  ++s->pass;
  s->pass_since_us = s->now_us;
}

static void search_bias(odometer* s, const half_times* times) {
  const int count = 2 * bias_steps(s) + 1;
  float bias_dps, sigma_dps, rate_dps;
  if (s->tried < 0) {
    keep_half(s, times);
    if (s->found_halves < HALVES || s->found_halves % SEARCH_EVERY != 0) return;
    for (uint32_t parity = 0; parity < 2u; ++parity) find_pixel_errors(s, parity);
    s->tried = 0;
    return;
  }
  for (int i = 0; i < BIASES_A_FRAME && s->tried < count; ++i, ++s->tried) {
    const int32_t from_middle = s->tried - count / 2;
    s->of.search.variance[s->tried] =
        mosaic_variance(s, s->profile.bias_dps + (float)from_middle * BIAS_STEP_DPS);
  }
  if (s->tried < count) return;
  s->tried = -1;
  memset(s->pixel_offset, 0, sizeof s->pixel_offset); /* halves are kept as they come */
  if (!bias_found(s, &bias_dps, &sigma_dps)) return;
  /* The heading went on with the bias of before. */
  s->value[HEADING] -=
      (bias_dps - s->value[BIAS]) * seconds_between(s->pass_since_us, s->now_us) / s->value[SCALE];
  s->value[BIAS] = bias_dps;
  if (!s->has_origin) {
    s->value[HEADING] = 0.0f;
    s->turns = 0;
  }
  keep_heading_around(s);
  s->has_origin = 1;
  rate_dps = searched_rate_dps(s, bias_dps); /* at another speed another scale would look like another bias */
  know_sensors(s, BIAS_WIDENING * sigma_dps, s->profile.scale_sigma, s->profile.latency_sigma_s);
  *covariance_at(s, BIAS, BIAS) += square(rate_dps * s->profile.scale_sigma);
  *covariance_at(s, BIAS, SCALE) = -rate_dps * square(s->profile.scale_sigma);
  begin_map(s);
  s->pass = 0;
  s->pass_since_us = s->now_us;
  s->phase = LEARNING;
}

static void learn_of(odometer* s, const half_result* result) {
  if (result->is_judged) s->nis += NIS_SHARE * (least(MOST_NIS, result->squared) - s->nis);
}

/* The pass ended with what it began with: another one would make the same map. */
static int has_settled(const odometer* s) {
  if (s->pass == 0) return 0;
  if (s->pass >= MOST_PASSES) return s->nis < NIS_FITS;
  return s->nis < SETTLED_NIS && size_of(s->value[BIAS] - s->begun_bias_dps) < SETTLED_BIAS_DPS &&
         size_of(s->value[SCALE] - s->begun_scale) < SETTLED_SCALE &&
         size_of(s->value[LATENCY] - s->begun_latency_s) < SETTLED_LATENCY_S;
}

static void learn(odometer* s, const half_times* times) {
  const half_result result = add_half(s, times);
  const int is_over = seconds_between(s->pass_since_us, s->now_us) > (s->pass == 0 ? FIRST_PASS_S : PASS_S);
  learn_of(s, &result);
  if (s->nis > NIS_LOST && s->pass > 0 && s->pass < MOST_PASSES)
    begin_pass_again(s);
  else if (s->nis <= NIS_LOST && is_over && has_settled(s))
    s->phase = RUNNING;
  else if (s->nis <= NIS_LOST && is_over && s->pass < MOST_PASSES && sigma_of(s, BIAS) < KNOWN_BIAS_DPS)
    begin_pass(s);
  else if (s->nis > NIS_LOST || is_over)
    begin_anew(s);
}

static int is_frozen(const odometer* s) {
  return s->has_sample && seconds_between(s->repeats_since_us, s->last_sample_us) >= FROZEN_S;
}

/* One that sets itself to zero at rest has taken its bias off. */
static int is_zeroed(const odometer* s) {
  return is_frozen(s) && s->last_rate_dps[0] == 0.0f && s->last_rate_dps[1] == 0.0f &&
         s->last_rate_dps[2] == 0.0f;
}

static void begin_search(odometer* s) {
  s->is_explained = s->gyro_was_away;
  s->expected_sigma_deg = s->in_map_deg;
  s->gyro_was_away = 0;
  memset(s->scratch.circle, 0, sizeof s->scratch.circle);
  s->circle_deg = 0.0f;
  s->searched = 0;
  s->locating_since_us = s->now_us;
  s->phase = LOCATING;
}

/* Innovations that all lean to one side: the bias is another than before. */
static void follow_bias(odometer* s, const half_result* result) {
  const float lean = result->innovation_deg < 0.0f ? -sqrtf(result->squared) : sqrtf(result->squared);
  s->lean += LEAN_SHARE * (lean - s->lean);
  if (size_of(s->lean) < MUCH_LEAN) return;
  *covariance_at(s, BIAS, BIAS) += square(STEPPED_BIAS_DPS);
  s->lean = 0.0f;
}

static void run(odometer* s, const half_times* times) {
  half_result result;
  if (is_frozen(s) && !is_zeroed(s)) return;
  result = add_half(s, times);
  if (!result.is_judged) return;
  s->covered = result.is_flat ? s->covered + 1 : 0;
  if (!result.is_flat) learn_of(s, &result);
  if (result.is_used) {
    if (s->to_trust > 0) --s->to_trust;
    follow_bias(s, &result);
  }
  s->slowest_dps = least(s->slowest_dps, result.rate_dps);
  s->fastest_dps = most(s->fastest_dps, result.rate_dps);
  if (s->is_doubted && s->fastest_dps - s->slowest_dps > TELLING_CHANGE_DPS) {
    s->is_doubted = 0;
    s->to_trust = HALVES_TO_TRUST;
  }
  if (s->nis > NIS_UNFIT && !s->is_unfit) {
    s->is_unfit = 1;
    s->unfit_since_us = times->end_us;
  }
  if (s->nis < NIS_FITS) s->is_unfit = 0;
  if (s->is_unfit && seconds_between(s->unfit_since_us, times->end_us) > LONGEST_UNFIT_S) {
    begin_anew(s);
    return;
  }
  if ((s->nis > NIS_LOST || s->in_map_deg > LOST_DEG) && s->covered < COVERED_HALVES) begin_search(s);
}

static void locate(odometer* s, const half_times* times) {
  const exposed_turn turn = turn_of(s, times);
  const float azimuth_deg = exposed_deg(s, &turn);
  float found_deg, sigma_deg, jump_deg;
  view v;
  memset(&v, 0, sizeof v);
  v.parity = times->parity;
  v.half = half_bins(half_width_deg(s, &turn));
  if (s->searched > 0) s->circle_deg = around(s->circle_deg + apart(azimuth_deg - s->located_deg));
  s->located_deg = azimuth_deg;
  add_to_circle(s, &v);
  if (!circle_found(s, &found_deg, &sigma_deg)) {
    if (seconds_between(s->locating_since_us, s->now_us) > GIVE_UP_S) begin_anew(s);
    return;
  }
  jump_deg = apart(found_deg - azimuth_deg);
  s->value[HEADING] += jump_deg;
  keep_heading_around(s);
  for (int i = 0; i < STATES; ++i) *covariance_at(s, HEADING, i) = 0.0f;
  *covariance_at(s, HEADING, HEADING) = square(sigma_deg);
  s->in_map_deg = sigma_deg;
  /* The gyro said something else, and was there all the time: one of the two is wrong, and as long as the rig
   * keeps its speed nobody can tell. */
  s->is_doubted =
      !s->is_explained && size_of(jump_deg) > DOUBTED_DEG + DOUBTED_SIGMAS * s->expected_sigma_deg;
  s->slowest_dps = s->fastest_dps = exposed_rate_dps(s, &turn);
  s->nis = 1.0f;
  s->lean = 0.0f;
  s->to_trust = HALVES_TO_TRUST;
  s->phase = RUNNING;
}

void thermorig_odometer_reset(thermorig_odometer_state* state, const thermorig_odometer_profile* profile) {
  memset(state, 0, sizeof *state);
  state->profile = *profile;
  state->noise = 1u;
  state->value[BIAS] = profile->bias_dps;
  begin_anew(state);
}

/* What a shaft may have turned by beside a straight line through both ends of a time in which nothing
 * measured it: it may have left its speed and come back to it. */
static float unseen_deg(float gap_s) {
  return least(2000.0f * gap_s * gap_s / 16.0f, 200.0f * gap_s);
}

/* The path's newest point moves along until it is far enough from the one before. */
static void add_to_path(odometer* s, uint32_t time_us, float rate_dps, float step_s) {
  gyro_knot next;
  const gyro_knot* last = s->knots > 0u ? knot_at(s, s->knots - 1u) : 0;
  next.time_us = time_us;
  next.rate_dps = rate_dps;
  next.turned = 0u;
  if (last) next.turned = last->turned + steps_of(0.5f * (s->last_read_dps + rate_dps) * step_s);
  s->last_read_dps = rate_dps;
  if (s->knots > 1u && last->time_us - knot_at(s, s->knots - 2u)->time_us < s->profile.knot_us) --s->knots;
  s->knot[s->knots++ % KNOTS] = next;
  if (s->knots > 0x80000000u) s->knots -= 0x40000000u; /* places stay: a multiple of KNOTS */
}

void thermorig_odometer_push_gyro(thermorig_odometer_state* state, uint32_t time_us, const float rate_dps[3],
                                  int saturated) {
  odometer* s = state;
  const float read_dps = (float)s->profile.gyro_sign * rate_dps[s->profile.gyro_axis];
  float step_s, lost_s, unseen;
  if (!(size_of(read_dps) < LARGEST_RATE_DPS)) return;
  step_s = s->has_sample ? seconds_between(s->last_sample_us, time_us) : 0.0f;
  if (s->has_sample && step_s <= 0.0f) {
    if (step_s > -1.0f) return;
    s->knots = 0u; /* the clock was set */
    s->has_sample = s->has_seen = s->has_begun = 0;
    begin_anew(s);
    step_s = 0.0f;
  }
  /* Bit by bit. NOLINTNEXTLINE(bugprone-suspicious-memory-comparison) */
  if (!s->has_sample || memcmp(s->last_rate_dps, rate_dps, sizeof s->last_rate_dps) != 0)
    s->repeats_since_us = time_us;
  memcpy(s->last_rate_dps, rate_dps, sizeof s->last_rate_dps);
  s->last_sample_us = time_us;
  s->has_sample = 1;
  lost_s = step_s > 1.5f * s->profile.gyro_period_s ? step_s - s->profile.gyro_period_s : 0.0f;
  unseen = unseen_deg(lost_s);
  s->saturated_s = saturated ? s->saturated_s + step_s : 0.0f;
  s->unseen_deg2 += unseen * unseen + 2.0f * SATURATED_DPS * SATURATED_DPS * s->saturated_s * step_s;
  if (lost_s > LONGEST_GYRO_GAP_S || (is_frozen(s) && !is_zeroed(s))) s->gyro_was_away = 1;
  add_to_path(s, time_us, is_zeroed(s) ? s->value[BIAS] : read_dps, step_s);
}

static void advance(odometer* s, uint32_t now_us) {
  const gyro_knot now = path_until(s, now_us);
  const float step_s = seconds_between(s->now_us, now_us);
  if (s->has_begun && step_s <= 0.0f) return;
  if (s->has_begun) filter_predict(s, degrees_between(s->now_turned, now.turned), step_s, s->unseen_deg2);
  s->has_begun = 1;
  s->unseen_deg2 = 0.0f;
  s->now_us = now_us;
  s->now_turned = now.turned;
}

static void take_fresh_half(odometer* s, const thermorig_odometer_frame* frame, uint32_t parity) {
  half_times times;
  times.begin_us = frame->begin_us[parity];
  times.end_us = frame->end_us[parity];
  times.parity = parity;
  times.time_sigma_s = frame->time_sigma_s;
  if (times.end_us - times.begin_us - 1u >= LONGEST_EXPOSURE_US) return;
  if (seconds_between(knot_at(s, first_knot(s))->time_us, times.begin_us) <= 0.0f) return;
  s->last_half_us = times.end_us;
  s->has_seen = 1;
  take_half(s, frame->temp_c, parity);
  if (s->phase == SEARCHING)
    search_bias(s, &times);
  else if (s->phase == LEARNING)
    learn(s, &times);
  else if (s->phase == RUNNING)
    run(s, &times);
  else
    locate(s, &times);
}

/* Of the halves that the image shows, the other one's exposure too if it was the one before. */
static uint32_t begin_of_image(odometer* s, const thermorig_odometer_frame* frame, uint32_t first,
                               uint32_t last) {
  const uint32_t before_us = s->half_begin_us[first ^ 1u], begin_us = frame->begin_us[first];
  const float length_s = seconds_between(begin_us, frame->end_us[first]);
  s->half_begin_us[first] = begin_us;
  s->half_begin_us[last] = frame->begin_us[last];
  return first == last && seconds_between(before_us, begin_us) < 1.5f * length_s &&
                 begin_us - before_us < 8000000u
             ? before_us
             : begin_us;
}

void thermorig_odometer_push_frame(thermorig_odometer_state* state, const thermorig_odometer_frame* frame) {
  odometer* s = state;
  const uint32_t fresh = frame->fresh & 3u;
  const uint32_t first = fresh == 3u ? (seconds_between(frame->end_us[0], frame->end_us[1]) < 0.0f ? 1u : 0u)
                                     : (fresh == 2u ? 1u : 0u);
  const uint32_t last = fresh == 3u ? first ^ 1u : first;
  exposed_turn turn;
  if (s->knots == 0u || fresh == 0u) return;
  if (seconds_between(s->last_sample_us, frame->end_us[last]) > LONGEST_GYRO_GAP_S)
    return; /* see reason_of() */
  advance(s, frame->end_us[last]);
  if (s->phase == RUNNING && s->gyro_was_away && !is_frozen(s)) begin_search(s);
  take_fresh_half(s, frame, first);
  if (last != first) take_fresh_half(s, frame, last);
  s->frame_begin_us = begin_of_image(s, frame, first, last);
  s->frame_end_us = frame->end_us[last];
  path_over(s, s->frame_begin_us, s->frame_end_us, &turn);
  s->rate_dps = turn.turned_deg / turn.length_s;
  s->rate_change_dps = turn.across_dps / turn.length_s;
}

static int32_t reason_of(const odometer* s, uint32_t time_us) {
  const float gyro_gap_s = seconds_between(s->last_sample_us, time_us);
  const float camera_gap_s = seconds_between(s->last_half_us, time_us);
  /* A gap that is far below zero is one of half an hour: the clock wrapped around. */
  if (!s->has_sample || gyro_gap_s > LONGEST_GYRO_GAP_S || gyro_gap_s < -60.0f)
    return THERMORIG_ODOMETER_NO_GYRO;
  if (!s->has_seen || camera_gap_s > LONGEST_CAMERA_GAP_S || camera_gap_s < -60.0f)
    return THERMORIG_ODOMETER_NO_CAMERA;
  if (is_frozen(s) && !is_zeroed(s)) return THERMORIG_ODOMETER_GYRO_FROZEN;
  if (s->covered >= COVERED_HALVES || s->is_unfit) return THERMORIG_ODOMETER_VIEW_DIFFERS;
  return THERMORIG_ODOMETER_NONE;
}

static int32_t state_of(const odometer* s, int32_t reason) {
  if (reason != THERMORIG_ODOMETER_NONE) return THERMORIG_ODOMETER_NOT_TRUSTED;
  if (s->phase == LOCATING || (s->phase == RUNNING && (s->to_trust > 0 || s->is_doubted)))
    return THERMORIG_ODOMETER_RELOCALISING;
  return s->phase == RUNNING ? THERMORIG_ODOMETER_TRACKING : THERMORIG_ODOMETER_STARTING;
}

void thermorig_odometer_read(const thermorig_odometer_state* state, uint32_t time_us,
                             thermorig_odometer_output* output) {
  const odometer* s = state;
  float since_s, heading_deg, rate_dps, samples, frame_s;
  int32_t turns;
  memset(output, 0, sizeof *output);
  output->reason = reason_of(s, time_us);
  output->state = state_of(s, output->reason);
  output->bias_dps = s->value[BIAS];
  output->scale = s->value[SCALE];
  output->latency_s = s->value[LATENCY];
  output->nis = s->nis;
  output->heading_sigma_deg = 180.0f;
  output->rate_sigma_dps = s->profile.bias_sigma_dps;
  if (!s->has_begun || s->frame_end_us == s->frame_begin_us) return;
  frame_s = seconds_between(s->frame_begin_us, s->frame_end_us);
  rate_dps = (s->rate_dps - s->value[BIAS]) / s->value[SCALE];
  samples = most(1.0f, frame_s / s->profile.gyro_period_s);
  output->rate_dps = rate_dps;
  output->rate_sigma_dps =
      root((covariance_of(s, BIAS, BIAS) + square(SAMPLE_NOISE_DPS) / samples) / square(s->value[SCALE]) +
           square(sigma_of(s, SCALE) * rate_dps) + square(s->profile.gyro_time_sigma_s * s->rate_change_dps));
  since_s = most(0.0f, seconds_between(s->now_us, time_us));
  heading_deg = s->value[HEADING];
  if (since_s > 0.0f)
    heading_deg +=
        (degrees_between(s->now_turned, path_until(s, time_us).turned) - s->value[BIAS] * since_s) /
        s->value[SCALE];
  turns = floor_of(heading_deg / 360.0f);
  output->turns = s->turns + turns;
  output->heading_deg = heading_deg - 360.0f * (float)turns;
  if (s->phase == SEARCHING) return;
  /* No image tells how late the gyro is: what it says of now, it says of then. */
  output->heading_sigma_deg =
      root(square(s->in_map_deg) + covariance_of(s, BIAS, BIAS) * since_s * since_s +
           square(HEADING_WALK_DEG) * since_s + square(s->profile.gyro_time_sigma_s * rate_dps));
}

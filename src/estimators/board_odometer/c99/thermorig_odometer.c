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

#include "bias_search.h"
#include "circle_search.h"
#include "gyro_noise.h"
#include "gyro_path.h"
#include "gyro_watch.h"
#include "heading_filter.h"
#include "tracker.h"

typedef thermorig_odometer_state odometer;

/* The caller's memory is as large as the header says. */
typedef char odometer_state_size_is_as_stated[sizeof(odometer) == THERMORIG_ODOMETER_STATE_BYTES ? 1 : -1];

enum { SEARCHING, LEARNING, RUNNING, LOCATING };

/* Of the start: then the map is begun anew, with what was learnt of the sensors. */
#define FIRST_PASS_S 15.0f
#define PASS_S 20.0f
#define STILL_DPS 3.0f
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
#define FAR_DEG 4.0f             /* an innovation: the map shows something else there */
#define MOST_FAR 0.25f           /* of a pass's halves: false maps have 40 to 70 %, sound ones 3 to 15 */
#define PASSES_TO_TELL 2         /* earlier ones may begin with a wrong bias */
#define NIS_SHARE (1.0f / 30.0f) /* of a half in the mean of its kind */
#define NIS_LOST 8.0f
#define NIS_UNFIT 3.0f /* not trusted from the one on until the other */
#define NIS_FITS 2.0f
#define LONGEST_UNFIT_S 30.0f    /* then the map is wrong */
#define MOST_NIS 60.0f           /* that one half counts with */
#define COVERED_HALVES 4         /* in a row */
#define HALVES_TO_TRUST 8        /* after a search */
#define DOUBTED_HALVES 16        /* where the gyro says something else */
#define DOUBTED_DEG 2.0f         /* off the gyro's heading: further is doubted */
#define TELLING_CHANGE_DPS 40.0f /* of the speed: then a wrong time would show */
#define LEAN_SHARE (1.0f / 16.0f)
#define MUCH_LEAN 0.7f
#define STEPPED_BIAS_DPS 0.3f
#define LONGEST_CAMERA_GAP_S 1.0f
#define LOST_DEG 3.0f /* a heading that is known less well is searched for */
#define GIVE_UP_S 40.0f
#define SAMPLE_NOISE_DPS 0.15f
#define LARGEST_RATE_DPS 10000.0f
#define LONGEST_EXPOSURE_US 4000000u
#define LARGEST_SIGMA_S 1e6f /* beyond: no number of seconds, infinity as well */

/* A new map begins where the heading is: how well that is known in the one before. */
static void keep_origin(odometer* s) {
  if (s->has_tracked) s->origin_deg2 += covariance_of(&s->tracker.filter, HEADING, HEADING);
}

/* A new map, and nothing is known of how well it fits. */
static void begin_new_map(odometer* s) {
  begin_map(&s->tracker);
  s->nis = 1.0f;
  s->lean = 0.0f;
  s->judged = s->far = 0;
}

/* The bias is searched for. */
static void begin_anew(odometer* s) {
  heading_filter* filter = &s->tracker.filter;
  keep_origin(s);
  know_sensors(filter, s->profile.bias_sigma_dps, s->profile.scale_sigma, s->profile.latency_sigma_s);
  filter->is_open = 0;
  begin_new_map(s);
  filter->value[SCALE] = s->profile.scale;
  filter->value[LATENCY] = 0.0f;
  begin_bias_search(&s->tracker.of.search);
  s->covered = s->to_trust = 0;
  s->is_doubted = s->is_unfit = s->watch.was_away = 0;
  s->pass_since_us = filter->now_us;
  s->phase = SEARCHING;
}

/* The start once more, with what was learnt of the sensors meanwhile. */
static void begin_pass(odometer* s) {
  static const float doubt[FIRST_NODE] = {0.0f, DOUBT_BIAS_DPS, DOUBT_SCALE, DOUBT_LATENCY_S};
  heading_filter* filter = &s->tracker.filter;
  for (int i = BIAS; i < FIRST_NODE; ++i) {
    for (int j = BIAS; j <= i; ++j) *covariance_at(filter, i, j) *= square(PASS_WIDENING);
    *covariance_at(filter, i, i) += square(doubt[i]);
  }
  s->begun_bias_dps = filter->value[BIAS];
  s->begun_scale = filter->value[SCALE];
  s->begun_latency_s = filter->value[LATENCY];
  filter->is_open = (uint8_t)has_gap(filter); /* before the map is forgotten */
  keep_origin(s);
  begin_new_map(s);
  ++s->pass;
  s->pass_since_us = filter->now_us;
  s->phase = LEARNING;
}

/* The map was begun wrongly, and the sensors are known from the pass before. */
static void begin_pass_again(odometer* s) {
  heading_filter* filter = &s->tracker.filter;
  keep_origin(s);
  filter->value[BIAS] = s->begun_bias_dps;
  filter->value[SCALE] = s->begun_scale;
  filter->value[LATENCY] = s->begun_latency_s;
  know_sensors(filter, 2.0f * DOUBT_BIAS_DPS, 2.0f * DOUBT_SCALE, 2.0f * DOUBT_LATENCY_S);
  begin_new_map(s);
  ++s->pass;
  s->pass_since_us = filter->now_us;
}

/* The first map, with the bias that the search found: the heading went on with the one of before. */
static void begin_first_pass(odometer* s, const found_bias* found) {
  heading_filter* filter = &s->tracker.filter;
  const float searched_s = seconds_between(s->pass_since_us, filter->now_us);
  if (s->has_tracked) s->origin_deg2 += square(BIAS_WIDENING * found->sigma_dps * searched_s);
  filter->value[HEADING] -= (found->bias_dps - filter->value[BIAS]) * searched_s / filter->value[SCALE];
  filter->value[BIAS] = found->bias_dps;
  if (!s->has_origin) {
    filter->value[HEADING] = 0.0f;
    filter->turns = 0;
  }
  keep_heading_around(filter);
  s->has_origin = 1;
  know_sensors(filter, BIAS_WIDENING * found->sigma_dps, s->profile.scale_sigma, s->profile.latency_sigma_s);
  /* At another speed another scale would look like another bias. */
  *covariance_at(filter, BIAS, BIAS) += square(found->rate_dps * s->profile.scale_sigma);
  *covariance_at(filter, BIAS, SCALE) = -found->rate_dps * square(s->profile.scale_sigma);
  begin_new_map(s);
  s->pass = 0;
  s->pass_since_us = filter->now_us;
  s->phase = LEARNING;
}

static void search_bias(odometer* s) {
  tracker* t = &s->tracker;
  found_bias found;
  if (!is_trying(&t->of.search)) {
    const exposed_turn turn = turn_of(t, &s->path);
    add_to_search(&t->of.search, &t->half, &turn);
  } else if (try_biases(&t->of.search, &s->profile, &found)) {
    begin_first_pass(s, &found);
  }
}

static void learn_of(odometer* s, const half_result* result) {
  if (result->is_judged) s->nis += NIS_SHARE * (least(MOST_NIS, result->squared) - s->nis);
}

/* The pass ended with what it began with: another one would make the same map. */
static int has_settled(const odometer* s) {
  const heading_filter* filter = &s->tracker.filter;
  if (s->pass == 0) return 0;
  if (s->pass >= MOST_PASSES) return s->nis < NIS_FITS;
  return s->nis < SETTLED_NIS && size_of(filter->value[BIAS] - s->begun_bias_dps) < SETTLED_BIAS_DPS &&
         size_of(filter->value[SCALE] - s->begun_scale) < SETTLED_SCALE &&
         size_of(filter->value[LATENCY] - s->begun_latency_s) < SETTLED_LATENCY_S;
}

static int is_false_map(const odometer* s) {
  return s->pass >= PASSES_TO_TELL && (float)s->far > MOST_FAR * (float)s->judged;
}

/* Without rests: they tell the bias and nothing else. */
static float length_of_pass_s(odometer* s, const half_result* newest) {
  if (size_of(newest->rate_dps) < STILL_DPS) s->pass_since_us += s->tracker.half.end_us - s->last_half_us;
  return seconds_between(s->pass_since_us, s->tracker.filter.now_us);
}

static void begin_running(odometer* s) {
  s->tracker.filter.is_learning = 0;
  s->has_tracked = 1;
  s->phase = RUNNING;
}

static void learn(odometer* s) {
  const half_result result = add_half(&s->tracker, &s->path, &s->profile);
  const heading_filter* filter = &s->tracker.filter;
  const int is_over = length_of_pass_s(s, &result) > (s->pass == 0 ? FIRST_PASS_S : PASS_S);
  learn_of(s, &result);
  s->judged = (uint16_t)(s->judged + result.is_judged);
  if (result.is_judged && size_of(result.innovation_deg) > FAR_DEG) ++s->far;
  if (is_over && is_false_map(s)) {
    begin_anew(s);
    return;
  }
  if (s->nis > NIS_LOST && s->pass > 0 && s->pass < MOST_PASSES)
    begin_pass_again(s);
  else if (s->nis <= NIS_LOST && is_over && has_settled(s))
    begin_running(s);
  else if (s->nis <= NIS_LOST && is_over && s->pass < MOST_PASSES && sigma_of(filter, BIAS) < KNOWN_BIAS_DPS)
    begin_pass(s);
  else if (s->nis > NIS_LOST || is_over)
    begin_anew(s);
}

static void begin_search(odometer* s) {
  s->is_explained = s->watch.was_away || (s->to_trust > 0 && s->is_explained);
  s->watch.was_away = 0;
  begin_circle(&s->tracker.of.map.by.circle);
  s->locating_since_us = s->tracker.filter.now_us;
  s->phase = LOCATING;
}

/* Innovations that all lean to one side: the bias is another than before. */
static void follow_bias(odometer* s, const half_result* result) {
  const float lean = result->innovation_deg < 0.0f ? -sqrtf(result->squared) : sqrtf(result->squared);
  s->lean += LEAN_SHARE * (lean - s->lean);
  if (size_of(s->lean) < MUCH_LEAN) return;
  *covariance_at(&s->tracker.filter, BIAS, BIAS) += square(STEPPED_BIAS_DPS);
  s->lean = 0.0f;
}

static void run(odometer* s) {
  const uint32_t end_us = s->tracker.half.end_us;
  half_result result;
  if (is_frozen(&s->watch)) return;
  result = add_half(&s->tracker, &s->path, &s->profile);
  if (!result.is_judged) return;
  s->covered = result.is_flat ? s->covered + 1 : 0;
  if (!result.is_flat) learn_of(s, &result);
  if (result.is_used) {
    const int may_tell = !s->is_doubted || size_of(result.rate_dps - s->found_dps) >= TELLING_CHANGE_DPS;
    if (may_tell && s->to_trust > 0) --s->to_trust;
    follow_bias(s, &result);
    if (s->to_trust == 0 && s->nis < NIS_FITS) s->tracker.filter.moved_deg = 0.0f;
  }
  if (s->nis > NIS_UNFIT && !s->is_unfit) {
    s->is_unfit = 1;
    s->unfit_since_us = end_us;
  }
  if (s->nis < NIS_FITS) s->is_unfit = 0;
  if (s->is_unfit && seconds_between(s->unfit_since_us, end_us) > LONGEST_UNFIT_S) {
    begin_anew(s);
    return;
  }
  if ((s->nis > NIS_LOST || s->tracker.in_map_deg > LOST_DEG) && s->covered < COVERED_HALVES) begin_search(s);
}

static void locate(odometer* s) {
  const located_half located = locate_half(&s->tracker, &s->path, &s->profile);
  if (!located.is_found) {
    if (seconds_between(s->locating_since_us, s->tracker.filter.now_us) > GIVE_UP_S) begin_anew(s);
    return;
  }
  /* The gyro said something else, and was there all the time: one of the two is wrong, and as long as the rig
   * keeps its speed nobody can tell. */
  s->is_doubted = !s->is_explained && size_of(apart(s->tracker.filter.moved_deg)) > DOUBTED_DEG;
  s->found_dps = located.rate_dps;
  s->nis = 1.0f;
  s->lean = 0.0f;
  s->to_trust = s->is_doubted ? DOUBTED_HALVES : HALVES_TO_TRUST;
  s->phase = RUNNING;
}

void thermorig_odometer_reset(thermorig_odometer_state* state, const thermorig_odometer_profile* profile) {
  memset(state, 0, sizeof *state);
  state->profile = *profile;
  state->tracker.noise = 1u;
  state->tracker.filter.value[BIAS] = profile->bias_dps;
  begin_anew(state);
}

static void forget_clock(odometer* s) {
  s->path.knots = 0u;
  s->watch.has_sample = s->has_seen = s->tracker.filter.has_begun = 0;
  s->has_tracked = 0; /* nobody knows how far it turned meanwhile: the heading has another origin */
  s->origin_deg2 = 0.0f;
  begin_anew(s);
}

void thermorig_odometer_push_gyro(thermorig_odometer_state* state, uint32_t time_us, const float rate_dps[3],
                                  int saturated) {
  odometer* s = state;
  gyro_watch* watch = &s->watch;
  const float read_dps = (float)s->profile.gyro_sign * rate_dps[s->profile.gyro_axis];
  float step_s;
  for (int axis = 0; axis < 3; ++axis)
    if (!(size_of(rate_dps[axis]) < LARGEST_RATE_DPS)) {
      ++s->ignored;
      return;
    }
  step_s = watch->has_sample ? seconds_between(watch->last_us, time_us) : 0.0f;
  if (watch->has_sample && step_s <= 0.0f) {
    if (step_s > -1.0f) return;
    forget_clock(s); /* it was set */
    step_s = 0.0f;
  }
  watch_sample(watch, time_us, rate_dps, saturated, step_s, s->profile.gyro_period_s);
  hear_sample(&s->noise, rate_dps, s->profile.gyro_axis, step_s);
  watch->unseen_deg2 += most(0.0f, s->noise.walk_deg2 - square(HEADING_WALK_DEG)) * step_s;
  add_to_path(&s->path, time_us, is_zeroed(watch) ? s->tracker.filter.value[BIAS] : read_dps, step_s,
              s->profile.knot_us);
}

static void take_fresh_half(odometer* s, const camera_frame* frame, uint32_t parity) {
  const uint32_t begin_us = frame->begin_us[parity], end_us = frame->end_us[parity];
  if (end_us - begin_us - 1u >= LONGEST_EXPOSURE_US) return;
  if (seconds_between(knot_at(&s->path, first_knot(&s->path))->time_us, begin_us) <= 0.0f) return;
  s->has_seen = 1;
  take_half(&s->tracker, frame, parity);
  if (s->phase == SEARCHING)
    search_bias(s);
  else if (s->phase == LEARNING)
    learn(s);
  else if (s->phase == RUNNING)
    run(s);
  else
    locate(s);
  s->last_half_us = end_us;
}

/* Of the halves that the image shows, the other one's exposure too if it was the one before. */
static uint32_t begin_of_image(odometer* s, const camera_frame* frame, uint32_t first, uint32_t last) {
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
  if (!(frame->time_sigma_s >= 0.0f && frame->time_sigma_s < LARGEST_SIGMA_S)) {
    ++s->ignored;
    return;
  }
  if (s->path.knots == 0u || fresh == 0u) return;
  if (seconds_between(s->watch.last_us, frame->end_us[last]) > LONGEST_GYRO_GAP_S)
    return; /* see reason_of() */
  if (advance(&s->tracker.filter, &s->path, frame->end_us[last], s->watch.unseen_deg2))
    s->watch.unseen_deg2 = 0.0f;
  if (s->phase == RUNNING && s->watch.was_away && !repeats_itself(&s->watch)) begin_search(s);
  take_fresh_half(s, frame, first);
  if (last != first) take_fresh_half(s, frame, last);
  s->frame_begin_us = begin_of_image(s, frame, first, last);
  s->frame_end_us = frame->end_us[last];
  path_over(&s->path, s->frame_begin_us, s->frame_end_us, &turn);
  s->rate_dps = turn.turned_deg / turn.length_s;
  s->rate_change_dps = turn.across_dps / turn.length_s;
}

static int32_t reason_of(const odometer* s, uint32_t time_us) {
  const float gyro_gap_s = seconds_between(s->watch.last_us, time_us);
  const float camera_gap_s = seconds_between(s->last_half_us, time_us);
  /* A gap that is far below zero is one of half an hour: the clock wrapped around. */
  if (!s->watch.has_sample || gyro_gap_s > LONGEST_GYRO_GAP_S || gyro_gap_s < -60.0f)
    return THERMORIG_ODOMETER_NO_GYRO;
  if (!s->has_seen || camera_gap_s > LONGEST_CAMERA_GAP_S || camera_gap_s < -60.0f)
    return THERMORIG_ODOMETER_NO_CAMERA;
  if (is_frozen(&s->watch)) return THERMORIG_ODOMETER_GYRO_FROZEN;
  if (s->covered >= COVERED_HALVES || s->is_unfit) return THERMORIG_ODOMETER_VIEW_DIFFERS;
  return THERMORIG_ODOMETER_NONE;
}

static int32_t state_of(const odometer* s, int32_t reason) {
  if (reason != THERMORIG_ODOMETER_NONE) return THERMORIG_ODOMETER_NOT_TRUSTED;
  if (s->phase == LOCATING || (s->phase == RUNNING && s->to_trust > 0))
    return THERMORIG_ODOMETER_RELOCALISING;
  return s->phase == RUNNING ? THERMORIG_ODOMETER_TRACKING : THERMORIG_ODOMETER_STARTING;
}

void thermorig_odometer_read(const thermorig_odometer_state* state, uint32_t time_us,
                             thermorig_odometer_output* output) {
  const odometer* s = state;
  const heading_filter* filter = &s->tracker.filter;
  float since_s, heading_deg, rate_dps, samples, frame_s;
  int32_t turns;
  memset(output, 0, sizeof *output);
  output->reason = reason_of(s, time_us);
  output->state = state_of(s, output->reason);
  output->bias_dps = filter->value[BIAS];
  output->scale = filter->value[SCALE];
  output->latency_s = filter->value[LATENCY];
  output->nis = s->nis;
  output->ignored = s->ignored;
  output->heading_sigma_deg = 180.0f;
  output->rate_sigma_dps = s->profile.bias_sigma_dps;
  if (!filter->has_begun || s->frame_end_us == s->frame_begin_us) return;
  frame_s = seconds_between(s->frame_begin_us, s->frame_end_us);
  rate_dps = (s->rate_dps - filter->value[BIAS]) / filter->value[SCALE];
  samples = most(1.0f, frame_s / s->profile.gyro_period_s);
  output->rate_dps = rate_dps;
  output->rate_sigma_dps = root((covariance_of(filter, BIAS, BIAS) + square(SAMPLE_NOISE_DPS) / samples) /
                                    square(filter->value[SCALE]) +
                                square(sigma_of(filter, SCALE) * rate_dps) +
                                square(s->profile.gyro_time_sigma_s * s->rate_change_dps));
  since_s = most(0.0f, seconds_between(filter->now_us, time_us));
  heading_deg = filter->value[HEADING];
  if (since_s > 0.0f)
    heading_deg += (degrees_between(filter->now_turned, path_until(&s->path, time_us).turned) -
                    filter->value[BIAS] * since_s) /
                   filter->value[SCALE];
  turns = floor_of(heading_deg / 360.0f);
  output->turns = filter->turns + turns;
  output->heading_deg = heading_deg - 360.0f * (float)turns;
  if (s->phase == SEARCHING) return;
  /* No image tells how late the gyro is: what it says of now, it says of then. */
  output->heading_sigma_deg = root(
      square(s->tracker.in_map_deg) + s->origin_deg2 + covariance_of(filter, BIAS, BIAS) * since_s * since_s +
      square(HEADING_WALK_DEG) * since_s + square(s->profile.gyro_time_sigma_s * rate_dps));
}

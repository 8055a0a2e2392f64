/* SPDX-License-Identifier: MIT */
/* The motion law, without registers: how the commanded angle moves, one step a millisecond.
 *
 * Units inside: a step is 1 ms; a rate is micro-degrees a step (0.001 deg/s), so an acceleration in
 * micro-degrees a step squared is the same number as in degrees per second squared. All of it is exact. */
#ifndef THERMORIG_MOTION_H
#define THERMORIG_MOTION_H

#include "servo_link.h"

#define MOTION_UDEG_PER_CDEG ((int32_t)10000)
#define MOTION_RATE_PER_CDPS ((int32_t)10) /* micro-degrees a step in a centidegree per second */

enum motion_goal { MOTION_REST, MOTION_RUN, MOTION_GO_TO, MOTION_STOP };

enum motion_event {                     /* bits of motion_step()'s result */
                    MOTION_REACHED = 1, /* a run's rate, for the first time */
                    MOTION_TURNED = 2,
                    MOTION_AT_LIMIT = 4, /* and may not turn back: at rest there */
                    MOTION_ENDED = 8
};

struct motion {
  bool continuous;
  bool bounded; /* has angle limits */
  int32_t low_cdeg, high_cdeg;
  uint16_t acceleration_limit;

  int32_t angle_cdeg;
  uint16_t angle_udeg; /* and so many micro-degrees more, 0..9999 */
  int32_t cable_cdeg;  /* sum of a continuous servo's turns, whatever angle_cdeg began at */
  int32_t rate;

  enum motion_goal goal;
  enum servo_motion phase;
  int32_t wanted; /* rate of a run, signed; of a go-to, positive */
  uint16_t acceleration;
  int32_t target_cdeg;
  uint32_t steps_left; /* of a run */
  bool turn_back, reached;
};

/* At rest at `angle_cdeg`, within the configuration's limits; a continuous servo with limits begins at
 * `cable_cdeg`, which may lie beyond them (then it moves only towards them), one without at 0. */
void motion_start(struct motion* motion, const struct servo_configure* limits, int32_t angle_cdeg);
void motion_run(struct motion* motion, const struct servo_run* run);
void motion_go_to(struct motion* motion, const struct servo_go_to* go_to);
/* Decelerates to rest; an acceleration of 0 keeps that of the motion in hand. */
void motion_stop(struct motion* motion, uint16_t acceleration_dps2);
/* One millisecond. Returns bits of enum motion_event. */
uint8_t motion_step(struct motion* motion);

static inline bool motion_is_at_rest(const struct motion* motion) {
  return motion->goal == MOTION_REST;
}
static inline int32_t motion_rate_cdps(const struct motion* motion) {
  return motion->rate / MOTION_RATE_PER_CDPS;
}

#endif

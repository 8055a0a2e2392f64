/* SPDX-License-Identifier: MIT */
#include "motion.h"

/* Distances beyond this many micro-degrees are all "far": more than any stop takes (300 deg/s at
 * SERVO_LIMIT_ACCELERATION_MIN_DPS2: 450 degrees). It keeps the arithmetic in 32 bits. */
#define FAR_UDEG 1000000000UL
#define FAR_CDEG ((int32_t)(FAR_UDEG / (uint32_t)MOTION_UDEG_PER_CDEG))

static uint32_t lesser(uint32_t a, uint32_t b) {
  return a < b ? a : b;
}
static uint32_t magnitude(int32_t rate) {
  return (uint32_t)(rate < 0 ? -rate : rate);
}
static uint32_t less_down_to_zero(uint32_t a, uint32_t b) {
  return a > b ? a - b : 0U;
}

/* Way to rest of a speed that is lowered by `a` before each step but the first: v + (v-a) + (v-2a) + ... */
static uint32_t stopping_distance(uint32_t speed, uint32_t a) {
  const uint32_t n = speed / a;
  return (n + 1U) * speed - a * (n * (n + 1U) / 2U);
}

/* Whether a stop from `speed` surely fits into `distance`, without a division: the way to rest is at most
 * speed^2 / 2a + speed, here in units of 4096 micro-degrees, rounded to the safe side. A step of an AVR needs
 * the exact answer only when it is about to brake. */
static bool stops_well_within(uint32_t speed, uint32_t a, uint32_t distance) {
  const uint32_t coarse_distance = lesser(distance >> 12U, 100000U), coarse_speed = (speed >> 6U) + 1U;
  const uint32_t one_step = (speed >> 12U) + 1U;
  return coarse_distance > one_step && 2U * a * (coarse_distance - one_step) > coarse_speed * coarse_speed;
}

static bool stops_within(uint32_t speed, uint32_t a, uint32_t distance) {
  return distance >= FAR_UDEG || stops_well_within(speed, a, distance) ||
         stopping_distance(speed, a) <= distance;
}

/* The highest speed whose stopping distance is at most `distance`. `near` is a speed not far from it: the
 * number of steps is searched from there. */
static uint32_t speed_to_stop_within(uint32_t distance, uint32_t a, uint32_t near) {
  uint32_t n = near / a;
  for (;;) {
    const uint32_t speed = (distance + a * (n * (n + 1U) / 2U)) / (n + 1U);
    if (speed >= (n + 1U) * a)
      ++n;
    else if (speed < n * a)
      --n;
    else
      return speed;
  }
}

/* From here to `bound_cdeg` when going up or down; 0 where it is passed. */
static uint32_t distance_to(const struct motion* motion, int32_t bound_cdeg, bool up) {
  const int32_t ahead = up ? bound_cdeg : motion->angle_cdeg;
  const int32_t behind = up ? motion->angle_cdeg : bound_cdeg;
  const uint32_t gap = (uint32_t)ahead - (uint32_t)behind; /* unsigned: a cable's sum may be any number */
  const int32_t part = up ? -(int32_t)motion->angle_udeg : (int32_t)motion->angle_udeg;
  int32_t distance;
  if (ahead > behind && gap > (uint32_t)FAR_CDEG - 1U) return FAR_UDEG;
  if (ahead < behind && gap != UINT32_MAX) return 0U;
  distance = (int32_t)gap * MOTION_UDEG_PER_CDEG + part;
  return distance > 0 ? (uint32_t)distance : 0U;
}

static uint32_t distance_to_limit(const struct motion* motion, bool up) {
  if (!motion->bounded) return FAR_UDEG;
  return distance_to(motion, up ? motion->high_cdeg : motion->low_cdeg, up);
}

/* The speed of this step so that the way to rest stays within `distance`, braking by at most the motion's own
 * acceleration: where that is not enough, the distance will be overrun. */
static uint32_t speed_for(uint32_t next, uint32_t before, uint32_t a, uint32_t distance) {
  const uint32_t slowest = less_down_to_zero(before, a);
  if (stops_within(next, a, distance)) return next;
  if (stopping_distance(slowest, a) >= distance) return slowest;
  return lesser(next, speed_to_stop_within(distance, a, before));
}

/* The same for a limit, which is never overrun: the deceleration rises up to the configured limit. That is
 * always enough, since whatever speed there is was reached under this rule. */
static uint32_t speed_within_limit(const struct motion* motion, uint32_t next, uint32_t before,
                                   uint32_t distance) {
  const uint32_t a = motion->acceleration;
  const uint32_t speed = speed_for(next, before, a, distance);
  if (stops_within(speed, a, distance)) return speed;
  return lesser(speed, speed_to_stop_within(distance, motion->acceleration_limit, before));
}

/* The wanted rate of this step, before acceleration and bounds. */
static int32_t wanted_rate(const struct motion* motion) {
  if (motion->goal == MOTION_RUN) return motion->wanted;
  if (motion->goal != MOTION_GO_TO) return 0;
  if (distance_to(motion, motion->target_cdeg, true) > 0U) return motion->wanted;
  return distance_to(motion, motion->target_cdeg, false) > 0U ? -motion->wanted : 0;
}

static int32_t ramped(int32_t rate, int32_t wanted, int32_t a) {
  if (wanted > rate + a) return rate + a;
  if (wanted < rate - a) return rate - a;
  return wanted;
}

/* A run comes to rest with its last step: its speed falls to zero in the steps that are left. */
static uint32_t speed_for_end(const struct motion* motion, uint32_t next, uint32_t before) {
  const uint32_t most = (motion->steps_left - 1U) * motion->acceleration;
  const uint32_t slowest = less_down_to_zero(before, motion->acceleration);
  if (next <= most) return next;
  return most > slowest ? most : slowest;
}

static uint32_t bounded_speed(struct motion* motion, uint32_t next, uint32_t before, bool up) {
  uint32_t speed = next;
  if (motion->goal == MOTION_RUN) speed = speed_for_end(motion, next, before);
  if (motion->goal == MOTION_GO_TO && wanted_rate(motion) != 0 && (wanted_rate(motion) > 0) == up)
    speed = speed_for(next, before, motion->acceleration, distance_to(motion, motion->target_cdeg, up));
  if (speed < next) motion->phase = SERVO_MOTION_STOPPING;
  return speed_within_limit(motion, speed, before, distance_to_limit(motion, up));
}

static int32_t next_rate(struct motion* motion) {
  const int32_t wanted = wanted_rate(motion);
  const int32_t ramp = ramped(motion->rate, wanted, (int32_t)motion->acceleration);
  const bool up = ramp > 0 || (ramp == 0 && motion->rate > 0);
  const int32_t along = up ? motion->rate : -motion->rate; /* the rate so far in the new direction */
  int32_t speed;
  motion->phase = motion->goal == MOTION_STOP ? SERVO_MOTION_STOPPING : SERVO_MOTION_RAMPING;
  speed = (int32_t)bounded_speed(motion, magnitude(ramp), along > 0 ? (uint32_t)along : 0U, up);
  if (speed == (int32_t)magnitude(wanted) && (ramp == wanted) && motion->goal != MOTION_STOP)
    motion->phase = SERVO_MOTION_STEADY;
  return up ? speed : -speed;
}

static void move_on(struct motion* motion) {
  int32_t part = (int32_t)motion->angle_udeg + motion->rate;
  int32_t whole = part / MOTION_UDEG_PER_CDEG;
  part -= whole * MOTION_UDEG_PER_CDEG;
  if (part < 0) {
    part += MOTION_UDEG_PER_CDEG;
    --whole;
  }
  motion->angle_udeg = (uint16_t)part;
  /* Unsigned, since the angle of a continuous servo may run for weeks and wrap. */
  motion->angle_cdeg = (int32_t)((uint32_t)motion->angle_cdeg + (uint32_t)whole);
  if (motion->continuous) motion->cable_cdeg = (int32_t)((uint32_t)motion->cable_cdeg + (uint32_t)whole);
}

static uint8_t come_to_rest(struct motion* motion, uint8_t events) {
  motion->goal = MOTION_REST;
  motion->phase = SERVO_MOTION_HOLDING;
  motion->rate = 0;
  return (uint8_t)(events | MOTION_ENDED);
}

static uint8_t at_limit(struct motion* motion) {
  if (!motion->turn_back) return come_to_rest(motion, MOTION_AT_LIMIT);
  motion->wanted = -motion->wanted;
  motion->phase = SERVO_MOTION_RAMPING;
  return MOTION_TURNED;
}

static uint8_t after_run_step(struct motion* motion) {
  --motion->steps_left;
  if (motion->steps_left == 0U) {
    if (motion->rate == 0) return come_to_rest(motion, 0);
    motion->goal = MOTION_STOP; /* taken over too fast to be at rest in time */
    return 0;
  }
  if (motion->rate == 0 && motion->wanted != 0 && distance_to_limit(motion, motion->wanted > 0) == 0U)
    return at_limit(motion);
  if (motion->reached || motion->phase != SERVO_MOTION_STEADY) return 0;
  motion->reached = true;
  return MOTION_REACHED;
}

void motion_start(struct motion* motion, const struct servo_configure* limits, int32_t angle_cdeg) {
  const bool positional = limits->kind == SERVO_KIND_POSITIONAL;
  motion->continuous = !positional;
  motion->bounded = positional || limits->angle_min_cdeg < limits->angle_max_cdeg;
  motion->low_cdeg = limits->angle_min_cdeg;
  motion->high_cdeg = limits->angle_max_cdeg;
  motion->acceleration_limit = limits->limit_acceleration_dps2;
  motion->acceleration = limits->limit_acceleration_dps2;
  if (positional)
    motion->angle_cdeg = angle_cdeg;
  else /* the turns of a cable are counted on from one arming to the next */
    motion->angle_cdeg = motion->bounded ? motion->cable_cdeg : 0;
  motion->angle_udeg = 0;
  (void)come_to_rest(motion, 0);
}

void motion_run(struct motion* motion, const struct servo_run* run) {
  motion->goal = MOTION_RUN;
  motion->phase = SERVO_MOTION_RAMPING;
  motion->wanted = run->rate_cdps * MOTION_RATE_PER_CDPS;
  motion->acceleration = run->acceleration_dps2;
  motion->steps_left = run->duration_ms;
  motion->turn_back = (run->flags & SERVO_RUN_TURN_BACK) != 0U;
  motion->reached = false;
}

void motion_go_to(struct motion* motion, const struct servo_go_to* go_to) {
  motion->goal = MOTION_GO_TO;
  motion->phase = SERVO_MOTION_RAMPING;
  motion->wanted = (int32_t)go_to->rate_cdps * MOTION_RATE_PER_CDPS;
  motion->acceleration = go_to->acceleration_dps2;
  motion->target_cdeg = go_to->angle_cdeg;
}

void motion_stop(struct motion* motion, uint16_t acceleration_dps2) {
  if (motion->goal == MOTION_REST) return;
  motion->goal = MOTION_STOP;
  motion->phase = SERVO_MOTION_STOPPING;
  if (acceleration_dps2 != 0U) motion->acceleration = acceleration_dps2;
}

uint8_t motion_step(struct motion* motion) {
  if (motion->goal == MOTION_REST) return 0;
  motion->rate = next_rate(motion);
  move_on(motion);
  if (motion->goal == MOTION_RUN) return after_run_step(motion);
  if (motion->rate != 0) return 0;
  if (motion->goal == MOTION_STOP || wanted_rate(motion) == 0) return come_to_rest(motion, 0);
  return 0;
}

/* SPDX-License-Identifier: MIT */
/* What each message of the host does, and why it may be refused: protocols/servo_link.md. */
#include "servo.h"

#define ACCEPTED 0U /* a reason that is none */
#define ANGLE_RANGE_MIN_CDEG 100
#define GUARD_MAX_CDEG 100000000L /* 2778 turns either way: the motion law counts in 32 bits */

static uint32_t magnitude(int32_t value) {
  return value < 0 ? 0U - (uint32_t)value : (uint32_t)value;
}

static void answer(struct servo* servo, uint8_t sequence, uint8_t type, const uint8_t* payload,
                   uint8_t size) {
  servo_report(servo, type, sequence, payload, size);
}

static void refuse(struct servo* servo, uint8_t type, uint8_t sequence, uint8_t reason, uint8_t detail) {
  const uint8_t payload[SERVO_NACK_SIZE] = {type, reason, detail};
  answer(servo, sequence, SERVO_NACK, payload, SERVO_NACK_SIZE);
}

static uint8_t check_rate(const struct servo* servo, uint32_t rate_cdps, uint16_t acceleration_dps2) {
  if (acceleration_dps2 == 0U) return SERVO_REASON_BAD_VALUE;
  if (rate_cdps > servo->configuration.limit_rate_cdps) return SERVO_REASON_BEYOND_LIMIT;
  if (acceleration_dps2 < SERVO_LIMIT_ACCELERATION_MIN_DPS2) return SERVO_REASON_BEYOND_LIMIT;
  return acceleration_dps2 > servo->configuration.limit_acceleration_dps2 ? SERVO_REASON_BEYOND_LIMIT
                                                                          : ACCEPTED;
}

/* A positional servo always has angle limits; a continuous one if its cable is guarded. */
static bool has_angle_limits(const struct servo_configure* servo) {
  return servo->kind == SERVO_KIND_POSITIONAL || servo->angle_min_cdeg < servo->angle_max_cdeg;
}

static uint8_t check_angle(const struct servo* servo, int32_t angle_cdeg) {
  const bool within =
      angle_cdeg >= servo->configuration.angle_min_cdeg && angle_cdeg <= servo->configuration.angle_max_cdeg;
  return within ? ACCEPTED : SERVO_REASON_BEYOND_LIMIT;
}

/* Whether a motion may begin or change. */
static uint8_t check_ready(const struct servo* servo) {
  if (servo->fault != SERVO_FAULT_NONE) return SERVO_REASON_FAULT;
  return servo->armed && !servo->disarming ? ACCEPTED : SERVO_REASON_NOT_ARMED;
}

static bool configuration_makes_sense(const struct servo_configure* asked) {
  if (asked->kind > SERVO_KIND_CONTINUOUS || asked->pulse_min_us >= asked->pulse_max_us) return false;
  if (asked->span == 0U || asked->limit_rate_cdps == 0U || asked->limit_acceleration_dps2 == 0U) return false;
  if (asked->kind == SERVO_KIND_CONTINUOUS) return asked->angle_min_cdeg <= asked->angle_max_cdeg;
  return asked->angle_min_cdeg < asked->angle_max_cdeg;
}

static bool angles_are_within_span(const struct servo_configure* asked) {
  const int32_t half = (int32_t)(asked->span / 2U);
  if (asked->angle_min_cdeg < -half || asked->angle_max_cdeg > half) return false;
  return asked->angle_max_cdeg - asked->angle_min_cdeg >= ANGLE_RANGE_MIN_CDEG;
}

static bool guard_is_within_limits(const struct servo_configure* asked) {
  if (!has_angle_limits(asked)) return true;
  if (asked->angle_min_cdeg < -GUARD_MAX_CDEG || asked->angle_max_cdeg > GUARD_MAX_CDEG) return false;
  return asked->angle_max_cdeg - asked->angle_min_cdeg >= ANGLE_RANGE_MIN_CDEG;
}

static bool configuration_is_within_limits(const struct servo_configure* asked) {
  if (asked->pulse_min_us < SERVO_LIMIT_PULSE_MIN_US || asked->pulse_max_us > SERVO_LIMIT_PULSE_MAX_US)
    return false;
  if (asked->span > SERVO_LIMIT_SPAN || asked->limit_rate_cdps > (uint32_t)SERVO_LIMIT_RATE_CDPS)
    return false;
  if (asked->limit_acceleration_dps2 > SERVO_LIMIT_ACCELERATION_DPS2) return false;
  if (asked->limit_acceleration_dps2 < SERVO_LIMIT_ACCELERATION_MIN_DPS2) return false;
  if (asked->kind == SERVO_KIND_CONTINUOUS)
    return asked->limit_rate_cdps <= asked->span / 2U && guard_is_within_limits(asked);
  return angles_are_within_span(asked);
}

static uint8_t configure(struct servo* servo, const uint8_t* at) {
  struct servo_configure asked;
  asked.kind = at[0];
  asked.pulse_min_us = servo_get_u16(at + 1);
  asked.pulse_max_us = servo_get_u16(at + 3);
  asked.span = servo_get_u32(at + 5);
  asked.limit_rate_cdps = servo_get_u32(at + 9);
  asked.limit_acceleration_dps2 = servo_get_u16(at + 13);
  asked.angle_min_cdeg = (int32_t)servo_get_u32(at + 15);
  asked.angle_max_cdeg = (int32_t)servo_get_u32(at + 19);
  if (servo->armed) return SERVO_REASON_ARMED;
  if (!configuration_makes_sense(&asked)) return SERVO_REASON_BAD_VALUE;
  if (!configuration_is_within_limits(&asked)) return SERVO_REASON_BEYOND_LIMIT;
  servo->configuration = asked;
  servo->configured = true;
  return ACCEPTED;
}

static uint8_t arm_again(struct servo* servo) {
  if (servo->fault == SERVO_FAULT_NONE || servo->disarming) return SERVO_REASON_ARMED;
  if (!motion_is_at_rest(&servo->motion)) return SERVO_REASON_FAULT;
  servo->fault = SERVO_FAULT_NONE;
  return ACCEPTED;
}

static uint8_t arm(struct servo* servo, const uint8_t* at) {
  const int32_t angle_cdeg = (int32_t)servo_get_u32(at);
  const bool positional = servo->configuration.kind == SERVO_KIND_POSITIONAL;
  if (servo->armed) return arm_again(servo);
  if (!servo->configured) return SERVO_REASON_NOT_CONFIGURED;
  /* A cable that is wound up too far must be unwound: the motion law lets it move that way only. */
  if (positional && check_angle(servo, angle_cdeg) != ACCEPTED) return SERVO_REASON_BEYOND_LIMIT;
  motion_start(&servo->motion, &servo->configuration, angle_cdeg);
  servo->fault = SERVO_FAULT_NONE;
  servo->armed = true;
  return ACCEPTED;
}

static uint8_t disarm(struct servo* servo) {
  servo->disarming = servo->armed && !motion_is_at_rest(&servo->motion);
  servo->armed = servo->disarming;
  /* After a fault the stop that is under way is the harder one. */
  if (servo->fault == SERVO_FAULT_NONE)
    motion_stop(&servo->motion, servo->configuration.limit_acceleration_dps2);
  return ACCEPTED;
}

static uint8_t run(struct servo* servo, const uint8_t* at) {
  struct servo_run asked;
  uint8_t reason = check_ready(servo);
  asked.leg = servo_get_u16(at);
  asked.flags = at[2];
  asked.rate_cdps = (int32_t)servo_get_u32(at + 3);
  asked.acceleration_dps2 = servo_get_u16(at + 7);
  asked.duration_ms = servo_get_u32(at + 9);
  if (reason != ACCEPTED) return reason;
  if (asked.duration_ms == 0U || (asked.flags & ~SERVO_RUN_TURN_BACK) != 0U) return SERVO_REASON_BAD_VALUE;
  reason = check_rate(servo, magnitude(asked.rate_cdps), asked.acceleration_dps2);
  if (reason != ACCEPTED) return reason;
  if (asked.duration_ms > SERVO_LIMIT_RUN_MS) return SERVO_REASON_BEYOND_LIMIT;
  servo_end_leg(servo);
  motion_run(&servo->motion, &asked);
  servo->leg = asked.leg;
  return ACCEPTED;
}

static uint8_t go_to(struct servo* servo, const uint8_t* at) {
  struct servo_go_to asked;
  uint8_t reason = check_ready(servo);
  asked.angle_cdeg = (int32_t)servo_get_u32(at);
  asked.rate_cdps = servo_get_u32(at + 4);
  asked.acceleration_dps2 = servo_get_u16(at + 8);
  if (reason != ACCEPTED) return reason;
  if (asked.rate_cdps == 0U || !has_angle_limits(&servo->configuration)) return SERVO_REASON_BAD_VALUE;
  reason = check_rate(servo, asked.rate_cdps, asked.acceleration_dps2);
  if (reason != ACCEPTED) return reason;
  if (check_angle(servo, asked.angle_cdeg) != ACCEPTED) return SERVO_REASON_BEYOND_LIMIT;
  servo_end_leg(servo);
  motion_go_to(&servo->motion, &asked);
  return ACCEPTED;
}

static uint8_t halt(struct servo* servo) {
  const uint8_t reason = check_ready(servo);
  if (reason == ACCEPTED) motion_stop(&servo->motion, 0);
  return reason;
}

static uint8_t obey(struct servo* servo, uint8_t type, const uint8_t* payload) {
  switch (type) {
    case SERVO_CONFIGURE:
      return configure(servo, payload);
    case SERVO_ARM:
      return arm(servo, payload);
    case SERVO_DISARM:
      return disarm(servo);
    case SERVO_RUN:
      return run(servo, payload);
    case SERVO_GO_TO:
      return go_to(servo, payload);
    default:
      return halt(servo);
  }
}

/* Length of the payload of each message of the host; 0xFF: no such message. */
static uint8_t payload_size(uint8_t type) {
  static const uint8_t sizes[] = {0xFFU, SERVO_HELLO_SIZE, SERVO_CONFIGURE_SIZE, SERVO_ARM_SIZE,
                                  0U,    SERVO_RUN_SIZE,   SERVO_GO_TO_SIZE,     0U,
                                  0U,    SERVO_PING_SIZE};
  return type < sizeof sizes ? sizes[type] : 0xFFU;
}

static void hello(struct servo* servo, uint8_t sequence, const uint8_t* payload, uint8_t size,
                  uint32_t time_us) {
  const uint8_t asked = size >= SERVO_HELLO_ASKING_SIZE ? payload[1] : 0U;
  servo->session = payload[0] == SERVO_LINK_VERSION;
  encoder_want(&servo->encoder, servo->session && (asked & SERVO_ASK_SHAFT) != 0U);
  servo->expected_sequence = (uint8_t)(sequence + 1U);
  servo->last.any = false;
  if (servo->fault == SERVO_FAULT_NONE) motion_stop(&servo->motion, 0);
  servo_report_welcome(servo, sequence, time_us);
}

static void ping(struct servo* servo, uint8_t sequence, const uint8_t* payload, uint32_t time_us) {
  const uint16_t delay_max_us = servo_get_u16(payload + 4);
  uint32_t random = servo->random;
  if (delay_max_us > SERVO_PING_DELAY_MAX_US) {
    refuse(servo, SERVO_PING, sequence, SERVO_REASON_BEYOND_LIMIT, 0);
    return;
  }
  random ^= random << 13U;
  random ^= random >> 17U;
  random ^= random << 5U;
  servo->random = random;
  servo->ping.waiting = true;
  servo->ping.sequence = sequence;
  servo->ping.token = servo_get_u32(payload);
  servo->ping.receive_us = time_us;
  servo->ping.due_us = time_us + (((random >> 16U) * ((uint32_t)delay_max_us + 1U)) >> 16U);
}

/* Carries out a command that is next in sequence, answers it and remembers the answer for a duplicate. */
static void obey_in_sequence(struct servo* servo, uint8_t type, uint8_t sequence, uint16_t crc) {
  struct servo_remembered* last = &servo->last;
  const uint8_t reason = obey(servo, type, servo->decoder.body + 2);
  last->any = true;
  last->type = type;
  last->sequence = sequence;
  last->crc = crc;
  last->answer_type = reason == ACCEPTED ? SERVO_ACK : SERVO_NACK;
  last->answer_size = reason == ACCEPTED ? SERVO_ACK_SIZE : SERVO_NACK_SIZE;
  last->answer[0] = type;
  if (reason == ACCEPTED) {
    servo_put_u32(last->answer + 1, servo->time_us + SERVO_TICK_US);
  } else {
    last->answer[1] = reason;
    last->answer[2] = 0;
  }
  servo->expected_sequence = (uint8_t)(sequence + 1U);
  answer(servo, sequence, last->answer_type, last->answer, last->answer_size);
}

static bool is_duplicate(const struct servo_remembered* last, uint8_t type, uint8_t sequence, uint16_t crc) {
  return last->any && last->type == type && last->sequence == sequence && last->crc == crc;
}

static void sequenced(struct servo* servo, uint8_t type, uint8_t sequence, uint16_t crc) {
  const struct servo_remembered* last = &servo->last;
  if (is_duplicate(last, type, sequence, crc))
    answer(servo, sequence, last->answer_type, last->answer, last->answer_size);
  else if (sequence != servo->expected_sequence)
    refuse(servo, type, sequence, SERVO_REASON_OUT_OF_SEQUENCE, servo->expected_sequence);
  else
    obey_in_sequence(servo, type, sequence, crc);
}

void servo_command(struct servo* servo, uint8_t size, uint32_t time_us) {
  const uint8_t* body = servo->decoder.body;
  const uint8_t type = body[0], sequence = body[1];
  if (type >= 0x80U) return;
  if (servo->session) servo->fed_us = time_us;
  if (type == SERVO_HELLO && size >= SERVO_HELLO_SIZE)
    hello(servo, sequence, body + 2, size, time_us);
  else if (!servo->session && type != SERVO_REFRESH)
    refuse(servo, type, sequence, SERVO_REASON_WRONG_VERSION, SERVO_LINK_VERSION);
  else if (payload_size(type) == 0xFFU)
    refuse(servo, type, sequence, SERVO_REASON_UNKNOWN_TYPE, 0);
  else if (payload_size(type) != size)
    refuse(servo, type, sequence, SERVO_REASON_WRONG_LENGTH, 0);
  else if (type == SERVO_PING)
    ping(servo, sequence, body + 2, time_us);
  else if (type != SERVO_REFRESH)
    sequenced(servo, type, sequence, servo_get_u16(body + 2 + size));
}

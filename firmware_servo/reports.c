/* SPDX-License-Identifier: MIT */
#include "servo.h"

static uint8_t room(const struct servo_output* output) {
  return (uint8_t)(output->taken - output->put - 1U);
}

static void put_out(struct servo_output* output, const uint8_t* bytes, uint8_t size) {
  uint8_t i;
  if (room(output) < size) return;
  for (i = 0; i < size; ++i) output->bytes[(uint8_t)(output->put + i)] = bytes[i];
  output->put = (uint8_t)(output->put + size); /* last: the board's interrupt takes what is complete */
}

void servo_report(struct servo* servo, uint8_t type, uint8_t sequence, const uint8_t* payload, uint8_t size) {
  uint8_t frame[SERVO_FRAME_MAX];
  put_out(&servo->output, frame, servo_frame(frame, type, sequence, payload, size));
}

void servo_report_event(struct servo* servo, enum servo_event_kind kind, uint16_t detail) {
  uint8_t payload[SERVO_EVENT_SIZE];
  payload[0] = (uint8_t)kind;
  servo_put_u32(servo_put_u16(payload + 1, detail), servo->time_us);
  servo_report(servo, SERVO_EVENT, servo->event_sequence++, payload, SERVO_EVENT_SIZE);
}

void servo_report_telemetry(struct servo* servo) {
  uint8_t payload[SERVO_TELEMETRY_SIZE];
  uint8_t* at = servo_put_u32(payload, servo->time_us);
  at = servo_put_u32(at, (uint32_t)servo->motion.angle_cdeg);
  at = servo_put_u32(at, (uint32_t)motion_rate_cdps(&servo->motion));
  at = servo_put_u16(at, servo->pulse_started);
  *at++ = (uint8_t)(SERVO_FINE_TICKS | (servo->armed ? servo->motion.phase : SERVO_MOTION_DISARMED));
  *at++ = (uint8_t)servo->fault;
  servo_put_u16(at, servo->leg);
  servo_report(servo, SERVO_TELEMETRY, servo->telemetry_sequence++, payload, SERVO_TELEMETRY_SIZE);
}

void servo_report_shaft(struct servo* servo, const struct servo_shaft* shaft) {
  uint8_t payload[SERVO_SHAFT_SIZE];
  uint8_t* at = servo_put_u32(payload, shaft->mcu_us);
  at = servo_put_u16(at, shaft->raw);
  *at++ = shaft->status;
  *at = shaft->gain;
  servo_report(servo, SERVO_SHAFT, servo->shaft_sequence++, payload, SERVO_SHAFT_SIZE);
}

void servo_report_welcome(struct servo* servo, uint8_t sequence, uint32_t time_us) {
  uint8_t payload[SERVO_WELCOME_SIZE] = {SERVO_LINK_VERSION, SERVO_FIRMWARE_MAJOR, SERVO_FIRMWARE_MINOR,
                                         SERVO_FIRMWARE_PATCH};
  uint8_t* at = payload + 4;
  *at++ = servo->board;
  *at++ = servo->reset_cause;
  at = servo_put_u32(at, time_us);
  at = servo_put_u16(at, SERVO_LIMIT_PULSE_MIN_US);
  at = servo_put_u16(at, SERVO_LIMIT_PULSE_MAX_US);
  at = servo_put_u32(at, SERVO_LIMIT_RATE_CDPS);
  at = servo_put_u16(at, SERVO_LIMIT_ACCELERATION_DPS2);
  servo_put_u16(at, SERVO_WATCHDOG_MS);
  servo_report(servo, SERVO_WELCOME, sequence, payload, SERVO_WELCOME_SIZE);
}

bool servo_ping_is_due(const struct servo* servo, uint32_t now_us) {
  return servo->ping.waiting && (int32_t)(now_us - servo->ping.due_us) >= 0;
}

void servo_answer_ping(struct servo* servo, uint32_t send_us) {
  uint8_t payload[SERVO_PONG_SIZE];
  uint8_t frame[SERVO_FRAME_MAX];
  uint8_t size;
  servo_put_u32(servo_put_u32(servo_put_u32(payload, servo->ping.token), servo->ping.receive_us), send_us);
  size = servo_frame(frame, SERVO_PONG, servo->ping.sequence, payload, SERVO_PONG_SIZE);
  put_out(&servo->output, frame + 1, (uint8_t)(size - 1U)); /* its FLAG is on the way */
  servo->ping.waiting = false;
}

/* SPDX-License-Identifier: MIT */
#include "servo.h"

#include <string.h>

#include "pulse.h"

#define TICKS_PER_TELEMETRY ((uint8_t)(SERVO_TELEMETRY_PERIOD_MS * 1000U / SERVO_TICK_US))
#define DAMAGED_FRAMES_MAX 3U

void servo_end_leg(struct servo* servo) {
  if (servo->leg != 0U) servo_report_event(servo, SERVO_EVENT_LEG_END, servo->leg);
  servo->leg = 0;
}

void servo_latch_fault(struct servo* servo, enum servo_fault fault) {
  if (servo->fault != SERVO_FAULT_NONE) return;
  servo->fault = fault;
  motion_stop(&servo->motion, SERVO_EMERGENCY_DPS2);
  servo_report_event(servo, SERVO_EVENT_FAULT, (uint16_t)fault);
}

static void count_damaged_frame(struct servo* servo) {
  if (motion_is_at_rest(&servo->motion)) return;
  ++servo->damaged_in_a_row;
  if (servo->damaged_in_a_row >= DAMAGED_FRAMES_MAX) servo_latch_fault(servo, SERVO_FAULT_BAD_FRAMES);
}

void servo_init(struct servo* servo, enum servo_board board, uint8_t reset_cause) {
  memset(servo, 0, sizeof *servo);
  servo->board = (uint8_t)board;
  servo->reset_cause = reset_cause;
  servo->random = 2463534242UL; /* any start but 0: Marsaglia, Xorshift RNGs, 2003 */
  servo->ticks_to_telemetry = TICKS_PER_TELEMETRY;
  servo_decoder_reset(&servo->decoder);
  servo_report_event(servo, SERVO_EVENT_RESET, reset_cause);
}

void servo_remember(struct servo* servo, int32_t angle_cdeg, int32_t cable_cdeg) {
  servo->motion.angle_cdeg = angle_cdeg;
  servo->motion.cable_cdeg = cable_cdeg;
}

void servo_receive(struct servo* servo, uint8_t byte, uint32_t time_us) {
  switch (servo_decoder_push(&servo->decoder, byte)) {
    case SERVO_DECODED_FRAME:
      servo->damaged_in_a_row = 0;
      servo_command(servo, servo_decoder_payload_size(&servo->decoder), time_us);
      break;
    case SERVO_DECODED_BAD:
      count_damaged_frame(servo);
      break;
    case SERVO_DECODED_STOP:
      servo_latch_fault(servo, SERVO_FAULT_STOP_BYTE);
      break;
    case SERVO_DECODED_NOTHING:
    case SERVO_DECODED_OUTSIDE:
      break;
  }
}

static void watch(struct servo* servo) {
  const int32_t silence_us = (int32_t)(servo->time_us - servo->fed_us);
  if (motion_is_at_rest(&servo->motion)) return;
  if (silence_us > (int32_t)(SERVO_WATCHDOG_MS * 1000UL)) servo_latch_fault(servo, SERVO_FAULT_WATCHDOG);
}

static void move(struct servo* servo) {
  const uint8_t events = motion_step(&servo->motion);
  if (servo->leg != 0U && (events & MOTION_REACHED) != 0U)
    servo_report_event(servo, SERVO_EVENT_LEG_START, servo->leg);
  if ((events & MOTION_TURNED) != 0U) servo_report_event(servo, SERVO_EVENT_REVERSAL, servo->leg);
  if ((events & MOTION_ENDED) != 0U) servo_end_leg(servo);
  if ((events & MOTION_AT_LIMIT) != 0U) servo_latch_fault(servo, SERVO_FAULT_LIMIT);
}

void servo_tick(struct servo* servo, uint32_t time_us) {
  servo->time_us = time_us;
  watch(servo);
  move(servo);
  if (servo->disarming && motion_is_at_rest(&servo->motion)) {
    servo->disarming = false;
    servo->armed = false;
  }
  if (--servo->ticks_to_telemetry == 0U) {
    servo->ticks_to_telemetry = TICKS_PER_TELEMETRY;
    servo_report_telemetry(servo);
  }
}

uint16_t servo_next_pulse(const struct servo* servo) {
  return servo->armed ? pulse_ticks(&servo->configuration, &servo->motion) : 0U;
}

void servo_pulse_started(struct servo* servo, uint16_t ticks) {
  servo->pulse_started = ticks;
}

bool servo_encoder_next(struct servo* servo, struct encoder_transfer* transfer) {
  return encoder_next(&servo->encoder, transfer);
}

void servo_encoder_done(struct servo* servo, bool acknowledged, const uint8_t* read, uint32_t read_us) {
  struct servo_shaft shaft;
  shaft.mcu_us = read_us;
  if (encoder_done(&servo->encoder, acknowledged, read, &shaft)) servo_report_shaft(servo, &shaft);
}

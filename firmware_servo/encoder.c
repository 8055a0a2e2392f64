/* SPDX-License-Identifier: MIT */
#include "encoder.h"

#define REGISTER_CONF 0x07U
#define REGISTER_STATUS 0x0BU /* with RAW ANGLE behind it, 0x0C and 0x0D, and the high byte of ANGLE */
#define REGISTER_AGC 0x1AU
/* Slow filter 2x (settles in 0.286 ms), fast filter from 6 LSB on, no hysteresis, no watchdog that would slow
 * down a shaft at rest ("CONF register"). */
#define CONF_HIGH 0x07U
#define CONF_LOW 0x00U

#define TICKS_PER_READING SERVO_SHAFT_PERIOD_MS
#define TICKS_PER_SEARCH 1000U
#define READINGS_PER_GAIN 250U
#define FAILURES_MAX 50U /* then it may have lost its supply, and CONF with it */
#define UNUSED_BITS 0xF0U

void encoder_want(struct encoder* encoder, bool wanted) {
  if (wanted && !encoder->wanted) encoder->pause = 0;
  encoder->wanted = wanted;
}

static void ask(struct encoder_transfer* transfer, uint8_t reg, uint8_t read_size) {
  transfer->write[0] = reg;
  transfer->write_size = 1;
  transfer->read_size = read_size;
}

static void set_up(struct encoder_transfer* transfer) {
  transfer->write[0] = REGISTER_CONF;
  transfer->write[1] = CONF_HIGH;
  transfer->write[2] = CONF_LOW;
  transfer->write_size = 3;
  transfer->read_size = 0;
}

bool encoder_next(struct encoder* encoder, struct encoder_transfer* transfer) {
  if (encoder->pause > 0U) --encoder->pause;
  if (encoder->pause > 0U || encoder->task != ENCODER_NOTHING || !encoder->wanted) return false;
  encoder->pause = TICKS_PER_READING;
  if (!encoder->is_set_up) {
    encoder->task = ENCODER_SETTING_UP;
    set_up(transfer);
  } else if (encoder->to_gain == 0U) {
    encoder->task = ENCODER_ASKING_GAIN;
    encoder->pause = 1; /* the reading that is due comes in the next tick */
    ask(transfer, REGISTER_AGC, 1);
  } else {
    encoder->task = ENCODER_READING;
    ask(transfer, REGISTER_STATUS, ENCODER_READ_MAX);
  }
  return true;
}

/* It does not answer, or not yet: it is looked for once a second. */
static void lose(struct encoder* encoder) {
  encoder->is_set_up = false;
  encoder->pause = TICKS_PER_SEARCH;
}

static bool take_reading(struct encoder* encoder, bool acknowledged, const uint8_t* read,
                         struct servo_shaft* shaft) {
  /* A bus that hangs high reads as ones, and the acknowledge of a byte that is read is our own. */
  const bool whole = acknowledged && ((read[1] | read[3]) & UNUSED_BITS) == 0U;
  encoder->failures = whole ? 0U : (uint8_t)(encoder->failures + 1U);
  --encoder->to_gain;
  shaft->raw = whole ? (uint16_t)((uint16_t)((uint16_t)read[1] << 8U) | read[2]) : 0U;
  shaft->status = whole ? (uint8_t)(read[0] & SERVO_SHAFT_MAGNET_BITS) : SERVO_SHAFT_UNREAD;
  shaft->gain = encoder->gain;
  if (encoder->failures >= FAILURES_MAX) lose(encoder);
  return true;
}

bool encoder_done(struct encoder* encoder, bool acknowledged, const uint8_t* read,
                  struct servo_shaft* shaft) {
  const enum encoder_task task = encoder->task;
  encoder->task = ENCODER_NOTHING;
  if (task == ENCODER_READING) return take_reading(encoder, acknowledged, read, shaft);
  if (task == ENCODER_ASKING_GAIN) {
    encoder->to_gain = READINGS_PER_GAIN;
    if (acknowledged) encoder->gain = read[0];
  } else if (task == ENCODER_SETTING_UP) {
    encoder->is_set_up = acknowledged;
    encoder->failures = 0;
    encoder->to_gain = 0;
    encoder->pause = 1;
    if (!acknowledged) lose(encoder);
  }
  return false;
}

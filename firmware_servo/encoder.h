/* SPDX-License-Identifier: MIT */
/* An AS5600 on the shaft, a magnet's angle over I2C: what to ask it, and what its answers say. No registers
 * of a board: that moves the bytes. Sections are those of ams' data sheet AS5600, v1-06.
 *
 * It is asked while the host wants to hear of it, and never otherwise. Only its CONF is ever written, which
 * is lost when its supply is; BURN (0xFF) would be for good. */
#ifndef THERMORIG_ENCODER_H
#define THERMORIG_ENCODER_H

#include "servo_link.h"

#define ENCODER_ADDRESS 0x36U

/* One transfer: `write_size` bytes to the sensor, then, where `read_size` is not 0, a repeated start and so
 * many bytes from it. */
struct encoder_transfer {
  uint8_t write[3];
  uint8_t write_size, read_size;
};
#define ENCODER_READ_MAX 4U

enum encoder_task { ENCODER_NOTHING, ENCODER_SETTING_UP, ENCODER_READING, ENCODER_ASKING_GAIN };

struct encoder {
  bool wanted;      /* by the host */
  bool is_set_up;   /* it has answered, and has our CONF */
  uint16_t pause;   /* ticks until it is asked again */
  uint8_t to_gain;  /* readings until its gain is asked for */
  uint8_t failures; /* readings in a row without an answer */
  uint8_t gain;
  enum encoder_task task; /* the transfer that is under way */
};

/* The host wants to hear of it from now on, or no longer. */
void encoder_want(struct encoder* encoder, bool wanted);
/* Every SERVO_TICK_US: whether the board shall begin this transfer now. It then says how that went by
 * encoder_done(), before the next one. */
bool encoder_next(struct encoder* encoder, struct encoder_transfer* transfer);
/* The transfer is over; `acknowledged`: every byte of it was. Fills `shaft` in and returns true where there
 * is something to report. */
bool encoder_done(struct encoder* encoder, bool acknowledged, const uint8_t* read, struct servo_shaft* shaft);

#endif

/* SPDX-License-Identifier: MIT */
/* The servo as the host sees it: link, safety, motion. No registers and no globals: a board feeds it bytes
 * and time, sends what it puts out and makes the pulse that it asks for. board_avr.c is one board, the
 * simulator's is another. Behaviour: protocols/servo_link.md. */
#ifndef THERMORIG_SERVO_H
#define THERMORIG_SERVO_H

#include "encoder.h"
#include "motion.h"
#include "servo_link.h"

#define SERVO_FIRMWARE_MAJOR 1U
#define SERVO_FIRMWARE_MINOR 3U
#define SERVO_FIRMWARE_PATCH 0U

#define SERVO_TICK_US 1000U
#define SERVO_ANSWER_MAX 5U /* payload of ACK or NACK */

/* Bytes to the host. The servo puts, the board (an interrupt) takes. Indices wrap at 256 by themselves. */
struct servo_output {
  uint8_t bytes[256];
  volatile uint8_t put, taken;
};

struct servo_remembered { /* the last command that took a sequence number, and what was answered */
  bool any;
  uint8_t type, sequence;
  uint16_t crc;
  uint8_t answer_type, answer_size;
  uint8_t answer[SERVO_ANSWER_MAX];
};

struct servo_waiting_ping {
  bool waiting;
  uint8_t sequence;
  uint32_t token, receive_us, due_us;
};

struct servo {
  uint8_t board, reset_cause;
  uint32_t time_us; /* of the last tick */

  struct servo_decoder decoder;
  uint8_t damaged_in_a_row;
  bool session; /* a HELLO of our version has come */
  uint8_t expected_sequence;
  struct servo_remembered last;
  uint32_t fed_us; /* when the last good frame ended */
  struct servo_waiting_ping ping;
  uint32_t random;

  bool configured, armed, disarming;
  enum servo_fault fault;
  struct servo_configure configuration;
  struct motion motion;
  uint16_t leg;
  uint16_t pulse_started; /* ticks of the last pulse, 0 for none: told by the board */

  struct encoder encoder;

  uint8_t telemetry_sequence, event_sequence, shaft_sequence, ticks_to_telemetry;
  struct servo_output output;
};

/* After a reset: disarmed, no session. Puts out the reset event. */
void servo_init(struct servo* servo, enum servo_board board, uint8_t reset_cause);
/* After servo_init(): the angle that was commanded last before a reset through which the memory lived on, and
 * the sum of the cable's turns. So the host can begin where the servo was left, and they stay counted. */
void servo_remember(struct servo* servo, int32_t angle_cdeg, int32_t cable_cdeg);
/* A byte from the host; `time_us`: when its last bit came in. */
void servo_receive(struct servo* servo, uint8_t byte, uint32_t time_us);
/* Every SERVO_TICK_US; `time_us` grows by exactly that from call to call. */
void servo_tick(struct servo* servo, uint32_t time_us);
/* The next pulse's width in ticks; 0 for none. */
uint16_t servo_next_pulse(const struct servo* servo);
/* The board has started a pulse of this width, or let one out (0). */
void servo_pulse_started(struct servo* servo, uint16_t ticks);
/* After servo_tick(): whether the board shall begin this transfer with the encoder, and later say how it went
 * and when its angle was read: servo_encoder_done(). */
bool servo_encoder_next(struct servo* servo, struct encoder_transfer* transfer);
void servo_encoder_done(struct servo* servo, bool acknowledged, const uint8_t* read, uint32_t read_us);
/* Whether the pong's time has come. The board then waits for its transmitter to be idle, hands
 * SERVO_LINK_FLAG to it and calls servo_answer_ping() with that instant: so building the frame delays
 * nothing. */
bool servo_ping_is_due(const struct servo* servo, uint32_t now_us);
void servo_answer_ping(struct servo* servo, uint32_t send_us);

static inline bool servo_output_is_empty(const struct servo_output* output) {
  return output->put == output->taken;
}
static inline uint8_t servo_output_take(struct servo_output* output) {
  const uint8_t byte = output->bytes[output->taken];
  output->taken = (uint8_t)(output->taken + 1U);
  return byte;
}

/* ---- between servo.c, commands.c and reports.c ------------------------------------------------------- */

/* A good frame of `size` bytes of payload lies in the decoder. commands.c */
void servo_command(struct servo* servo, uint8_t size, uint32_t time_us);
/* Latches a fault, unless one is latched, and stops the motion. servo.c */
void servo_latch_fault(struct servo* servo, enum servo_fault fault);
/* The run in hand, if it has a leg number, is over. servo.c */
void servo_end_leg(struct servo* servo);

/* Frames out; one that does not fit into the buffer is left out whole. reports.c */
void servo_report(struct servo* servo, uint8_t type, uint8_t sequence, const uint8_t* payload, uint8_t size);
void servo_report_event(struct servo* servo, enum servo_event_kind kind, uint16_t detail);
void servo_report_telemetry(struct servo* servo);
void servo_report_shaft(struct servo* servo, const struct servo_shaft* shaft);
void servo_report_welcome(struct servo* servo, uint8_t sequence, uint32_t time_us);

#endif

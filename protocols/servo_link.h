/* SPDX-License-Identifier: MIT */
/* The servo link: the one place where its bytes are defined, for the firmware (C11, avr-gcc) and for the
 * host (C++) alike. Description: protocols/servo_link.md. Golden vectors: protocols/vectors/servo_link.txt.
 *
 * A frame on the wire:  FLAG  escaped(type, sequence, payload..., crc_low, crc_high)  FLAG
 * CRC-16/CCITT-FALSE (polynomial 0x1021, start 0xFFFF) over type, sequence and payload before escaping.
 * FLAG, ESCAPE and STOP never occur between two flags other than as themselves: each is sent as
 * ESCAPE followed by the byte XOR ESCAPE_XOR. So a raw STOP byte is a stop wherever it stands.
 * Two frames may share one FLAG. All numbers are little-endian. */
#ifndef THERMORIG_SERVO_LINK_H
#define THERMORIG_SERVO_LINK_H

#include <stdbool.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

#define SERVO_LINK_VERSION 1U

#define SERVO_LINK_FLAG 0x7EU
#define SERVO_LINK_ESCAPE 0x7DU
#define SERVO_LINK_STOP 0x21U /* '!': also what a person can type in a terminal */
#define SERVO_LINK_ESCAPE_XOR 0x20U

#define SERVO_LINK_BAUD 250000UL

/* Timing that both sides rely on. */
#define SERVO_WATCHDOG_MS 120U /* without a good frame for so long, motion stops */
#define SERVO_REFRESH_MS 40U   /* the host sends REFRESH this often while the servo is armed */
#define SERVO_TELEMETRY_PERIOD_MS 10U
#define SERVO_SHAFT_PERIOD_MS 2U
#define SERVO_PING_DELAY_MAX_US 20000U /* the largest delay that a ping may ask for */
#define SERVO_TICKS_PER_US 16U         /* pulse ticks: 1/16 us */
#define SERVO_COARSE_TICKS_PER_US 2U   /* of a firmware before 1.1.0: 1/2 us */
#define SERVO_PULSE_PERIOD_US 20000U

/* Limits that are built into the firmware. The host can only lower them (SERVO_CONFIGURE). */
#define SERVO_LIMIT_PULSE_MIN_US 500U
#define SERVO_LIMIT_PULSE_MAX_US 2500U
#define SERVO_LIMIT_RATE_CDPS 30000 /* 300 deg/s */
#define SERVO_LIMIT_ACCELERATION_DPS2 20000U
#define SERVO_LIMIT_ACCELERATION_MIN_DPS2 100U /* less would not come to rest within a run */
#define SERVO_LIMIT_SPAN 1000000UL             /* centidegrees (or centidegrees per second) over the pulses */
#define SERVO_LIMIT_RUN_MS 60000UL             /* longest motion of one command */
#define SERVO_EMERGENCY_DPS2 20000U            /* deceleration after a fault, but for LIMIT; at least 2000 */

/* Message types. Host to servo below 0x80, servo to host from 0x80. */
enum servo_type {
  SERVO_HELLO = 0x01,     /* servo_hello     -> SERVO_WELCOME; starts a new sequence */
  SERVO_CONFIGURE = 0x02, /* servo_configure -> ack/nack; only while disarmed */
  SERVO_ARM = 0x03,       /* servo_arm       -> ack/nack; first pulse; clears a fault */
  SERVO_DISARM = 0x04,    /* no payload      -> ack/nack; stops, then no pulse */
  SERVO_RUN = 0x05,       /* servo_run       -> ack/nack; constant speed until its end */
  SERVO_GO_TO = 0x06,     /* servo_go_to     -> ack/nack; to an angle */
  SERVO_HALT = 0x07,      /* no payload      -> ack/nack; decelerates to rest, stays armed */
  SERVO_REFRESH = 0x08,   /* no payload, no answer: feeds the watchdog */
  SERVO_PING = 0x09,      /* servo_ping      -> SERVO_PONG, no ack */

  SERVO_WELCOME = 0x81,   /* servo_welcome */
  SERVO_ACK = 0x82,       /* servo_ack */
  SERVO_NACK = 0x83,      /* servo_nack */
  SERVO_TELEMETRY = 0x84, /* servo_telemetry */
  SERVO_PONG = 0x85,      /* servo_pong */
  SERVO_EVENT = 0x86,     /* servo_event */
  SERVO_SHAFT = 0x87      /* servo_shaft; only where HELLO asked for it, and a sensor answers */
};

/* Why a command was refused. */
enum servo_reason {
  SERVO_REASON_UNKNOWN_TYPE = 1,
  SERVO_REASON_WRONG_LENGTH = 2,
  SERVO_REASON_WRONG_VERSION = 3, /* no HELLO yet, or of another version */
  SERVO_REASON_OUT_OF_SEQUENCE = 4,
  SERVO_REASON_NOT_CONFIGURED = 5,
  SERVO_REASON_NOT_ARMED = 6,
  SERVO_REASON_ARMED = 7,        /* not while armed */
  SERVO_REASON_FAULT = 8,        /* a fault is latched: arm again */
  SERVO_REASON_BEYOND_LIMIT = 9, /* a limit, rate, acceleration, angle or duration beyond what is allowed */
  SERVO_REASON_BAD_VALUE = 10    /* zero duration, minimum above maximum, ... */
};

enum servo_motion { /* servo_telemetry.motion */
                    SERVO_MOTION_DISARMED = 0,
                    SERVO_MOTION_HOLDING = 1,
                    SERVO_MOTION_RAMPING = 2,
                    SERVO_MOTION_STEADY = 3,
                    SERVO_MOTION_STOPPING = 4
};

enum servo_fault { /* latched until the next ARM */
                   SERVO_FAULT_NONE = 0,
                   SERVO_FAULT_WATCHDOG = 1,
                   SERVO_FAULT_STOP_BYTE = 2,
                   SERVO_FAULT_LIMIT = 3,     /* an angle limit was reached by a RUN that may not turn back */
                   SERVO_FAULT_BAD_FRAMES = 4 /* three damaged frames in a row while moving */
};

enum servo_event_kind {
  SERVO_EVENT_RESET = 1,     /* detail: reset cause (MCUSR of an AVR); sent once after reset */
  SERVO_EVENT_FAULT = 2,     /* detail: enum servo_fault */
  SERVO_EVENT_LEG_START = 3, /* detail: leg; the commanded speed has been reached for the first time */
  SERVO_EVENT_LEG_END = 4,   /* detail: leg; the motion came to its end */
  SERVO_EVENT_REVERSAL = 5   /* detail: leg; turned back at a limit */
};

enum servo_board { SERVO_BOARD_ATMEGA328P = 1, SERVO_BOARD_HOST = 2 };

enum servo_kind { SERVO_KIND_POSITIONAL = 0, SERVO_KIND_CONTINUOUS = 1 };

struct servo_hello {
  uint8_t version; /* SERVO_LINK_VERSION of the host */
};
#define SERVO_HELLO_SIZE 1U
/* A second byte, if there is one, asks for what older hosts do not know; older firmware does not look at it.
 */
#define SERVO_HELLO_ASKING_SIZE 2U
#define SERVO_ASK_SHAFT 0x01U

struct servo_welcome {
  uint8_t version; /* SERVO_LINK_VERSION of the firmware: the first byte in every version of this link */
  uint8_t firmware_major, firmware_minor, firmware_patch;
  uint8_t board;       /* enum servo_board */
  uint8_t reset_cause; /* MCUSR at reset */
  uint32_t uptime_us;  /* wraps */
  uint16_t limit_pulse_min_us, limit_pulse_max_us;
  uint32_t limit_rate_cdps;
  uint16_t limit_acceleration_dps2;
  uint16_t watchdog_ms;
};
#define SERVO_WELCOME_SIZE 22U

/* Positional: pulse_min_us..pulse_max_us spans `span` centidegrees of angle, angle 0 in the middle.
 * Continuous: pulse_min_us..pulse_max_us spans `span` centidegrees per second (-span/2..+span/2), rest in
 * the middle. Every value must lie within the firmware's own limits. */
struct servo_configure {
  uint8_t kind; /* enum servo_kind */
  uint16_t pulse_min_us, pulse_max_us;
  uint32_t span;
  uint32_t limit_rate_cdps;
  uint16_t limit_acceleration_dps2;
  int32_t angle_min_cdeg, angle_max_cdeg; /* ignored by a continuous servo */
};
#define SERVO_CONFIGURE_SIZE 23U

struct servo_arm {
  int32_t angle_cdeg; /* where the first pulse points; ignored by a continuous servo */
};
#define SERVO_ARM_SIZE 4U

/* Ramps to rate_cdps, keeps it, and turns back at an angle limit where SERVO_RUN_TURN_BACK is set (else
 * decelerates to rest there). Ends after duration_ms by decelerating to rest. A RUN during a RUN takes over
 * without stopping. */
struct servo_run {
  uint16_t leg; /* echoed in telemetry; 0: not a leg */
  uint8_t flags;
  int32_t rate_cdps;
  uint16_t acceleration_dps2;
  uint32_t duration_ms; /* 1..SERVO_LIMIT_RUN_MS, ramps included */
};
#define SERVO_RUN_SIZE 13U
#define SERVO_RUN_TURN_BACK 0x01U

struct servo_go_to {
  int32_t angle_cdeg;
  uint32_t rate_cdps; /* > 0 */
  uint16_t acceleration_dps2;
};
#define SERVO_GO_TO_SIZE 10U

struct servo_ping {
  uint32_t token;
  uint16_t delay_max_us; /* the answer waits a pseudo-random 0..delay_max_us */
};
#define SERVO_PING_SIZE 6U

struct servo_ack {
  uint8_t type;    /* of the command; its sequence number is the frame's own */
  uint32_t mcu_us; /* when it took effect */
};
#define SERVO_ACK_SIZE 5U

struct servo_nack {
  uint8_t type;
  uint8_t reason; /* enum servo_reason */
  uint8_t detail; /* WRONG_VERSION: the firmware's version; OUT_OF_SEQUENCE: the number expected; else 0 */
};
#define SERVO_NACK_SIZE 3U

struct servo_telemetry {
  uint32_t mcu_us; /* the instant at which the other fields held */
  int32_t angle_cdeg;
  int32_t rate_cdps;
  uint16_t pulse_ticks; /* of the last pulse that was started; 0: none */
  uint8_t motion;       /* enum servo_motion; with SERVO_FINE_TICKS the ticks are 1/16 us, else 1/2 us */
  uint8_t fault;        /* enum servo_fault */
  uint16_t leg;
};
#define SERVO_TELEMETRY_SIZE 18U
#define SERVO_FINE_TICKS 0x80U /* set by every firmware from 1.1.0 on */

struct servo_pong {
  uint32_t token;
  uint32_t receive_us; /* when the ping's last byte came in */
  uint32_t send_us;    /* when the answer's first byte was handed to the transmitter */
};
#define SERVO_PONG_SIZE 12U

struct servo_event {
  uint8_t kind; /* enum servo_event_kind */
  uint16_t detail;
  uint32_t mcu_us;
};
#define SERVO_EVENT_SIZE 7U

/* The shaft as a magnetic encoder (AS5600) has it. */
struct servo_shaft {
  uint32_t mcu_us; /* when its angle was read */
  uint16_t raw;    /* RAW ANGLE: SERVO_SHAFT_STEPS a turn */
  uint8_t status;  /* its STATUS: MD, ML, MH; or SERVO_SHAFT_UNREAD alone: it did not answer, raw is 0 */
  uint8_t gain;    /* its AGC when that was read last, twice a second; 0: not yet */
};
#define SERVO_SHAFT_SIZE 8U
#define SERVO_SHAFT_STEPS 4096U
#define SERVO_SHAFT_UNREAD 0x01U
#define SERVO_SHAFT_MAGNET_STRONG 0x08U
#define SERVO_SHAFT_MAGNET_WEAK 0x10U
#define SERVO_SHAFT_MAGNET_FOUND 0x20U
#define SERVO_SHAFT_MAGNET_BITS 0x38U

#define SERVO_PAYLOAD_MAX 23U
#define SERVO_BODY_MAX (SERVO_PAYLOAD_MAX + 4U)    /* type, sequence, payload, CRC */
#define SERVO_FRAME_MAX (2U * SERVO_BODY_MAX + 2U) /* everything escaped, two flags */

/* ---- numbers in bytes -------------------------------------------------------------------------------- */

static inline uint8_t* servo_put_u16(uint8_t* at, uint16_t value) {
  at[0] = (uint8_t)(value & 0xFFU);
  at[1] = (uint8_t)(value >> 8U);
  return at + 2;
}

static inline uint8_t* servo_put_u32(uint8_t* at, uint32_t value) {
  return servo_put_u16(servo_put_u16(at, (uint16_t)(value & 0xFFFFUL)), (uint16_t)(value >> 16U));
}

static inline uint16_t servo_get_u16(const uint8_t* at) {
  return (uint16_t)(at[0] | (uint16_t)((uint16_t)at[1] << 8U));
}

static inline uint32_t servo_get_u32(const uint8_t* at) {
  return (uint32_t)servo_get_u16(at) | ((uint32_t)servo_get_u16(at + 2) << 16U);
}

/* ---- check sum and framing --------------------------------------------------------------------------- */

/* One byte into the CRC, without a table and without a loop over bits: folds the byte's own remainder. */
static inline uint16_t servo_crc16(uint16_t crc, uint8_t byte) {
  uint8_t x = (uint8_t)((uint8_t)(crc >> 8U) ^ byte);
  x = (uint8_t)(x ^ (uint8_t)(x >> 4U));
  return (uint16_t)((uint16_t)(crc << 8U) ^ (uint16_t)((uint16_t)x << 12U) ^ (uint16_t)((uint16_t)x << 5U) ^
                    x);
}

static inline uint8_t* servo_put_escaped(uint8_t* at, uint8_t byte) {
  if (byte == SERVO_LINK_FLAG || byte == SERVO_LINK_ESCAPE || byte == SERVO_LINK_STOP) {
    *at++ = SERVO_LINK_ESCAPE;
    byte = (uint8_t)(byte ^ SERVO_LINK_ESCAPE_XOR);
  }
  *at++ = byte;
  return at;
}

/* Writes one whole frame to `out` (SERVO_FRAME_MAX bytes) and returns its length. */
static inline uint8_t servo_frame(uint8_t* out, uint8_t type, uint8_t sequence, const uint8_t* payload,
                                  uint8_t size) {
  uint8_t* at = out;
  uint16_t crc = servo_crc16(servo_crc16(0xFFFFU, type), sequence);
  uint8_t i;
  *at++ = SERVO_LINK_FLAG;
  at = servo_put_escaped(at, type);
  at = servo_put_escaped(at, sequence);
  for (i = 0; i < size; ++i) {
    crc = servo_crc16(crc, payload[i]);
    at = servo_put_escaped(at, payload[i]);
  }
  at = servo_put_escaped(at, (uint8_t)(crc & 0xFFU));
  at = servo_put_escaped(at, (uint8_t)(crc >> 8U));
  *at++ = SERVO_LINK_FLAG;
  return (uint8_t)(at - out);
}

/* Takes bytes one at a time. Both ends use it. */
struct servo_decoder {
  uint8_t body[SERVO_BODY_MAX]; /* unescaped: type, sequence, payload, CRC */
  uint8_t size;
  bool escaped;  /* the byte before was ESCAPE */
  bool in_frame; /* a FLAG has been seen */
  bool overlong; /* more than SERVO_BODY_MAX bytes since the FLAG */
  bool ended;    /* body belongs to a frame that has ended: the next byte starts a new one */
};

enum servo_decoded {
  SERVO_DECODED_NOTHING = 0, /* the byte was taken; nothing is complete */
  SERVO_DECODED_OUTSIDE = 1, /* the byte lies outside any frame */
  SERVO_DECODED_FRAME = 2,   /* a good frame ended with this byte: body[0] type, body[1] sequence, payload */
  SERVO_DECODED_BAD = 3,     /* a damaged frame ended with this byte, which also opens the next one */
  SERVO_DECODED_STOP = 4     /* the raw stop byte; whatever frame was open is thrown away */
};

static inline void servo_decoder_reset(struct servo_decoder* decoder) {
  decoder->size = 0;
  decoder->escaped = false;
  decoder->in_frame = false;
  decoder->overlong = false;
  decoder->ended = false;
}

/* The length of the payload of the frame in `body`, after SERVO_DECODED_FRAME. */
static inline uint8_t servo_decoder_payload_size(const struct servo_decoder* decoder) {
  return (uint8_t)(decoder->size - 4U);
}

static inline bool servo_decoder_is_good(const struct servo_decoder* decoder) {
  uint16_t crc = 0xFFFFU;
  uint8_t i;
  if (decoder->escaped || decoder->overlong || decoder->size < 4U) return false;
  for (i = 0; i < (uint8_t)(decoder->size - 2U); ++i) crc = servo_crc16(crc, decoder->body[i]);
  return crc == servo_get_u16(decoder->body + decoder->size - 2U);
}

static inline enum servo_decoded servo_decoder_flag(struct servo_decoder* decoder) {
  enum servo_decoded result = SERVO_DECODED_NOTHING; /* an opening flag, or one flag after another */
  if (decoder->in_frame && !decoder->ended && (decoder->size > 0U || decoder->escaped))
    result = servo_decoder_is_good(decoder) ? SERVO_DECODED_FRAME : SERVO_DECODED_BAD;
  decoder->in_frame = true;
  decoder->escaped = false;
  decoder->overlong = false;
  decoder->ended = true; /* body stays readable until the next byte */
  return result;
}

/* After SERVO_DECODED_FRAME, `body` and `size` hold until the next call. */
static inline enum servo_decoded servo_decoder_push(struct servo_decoder* decoder, uint8_t byte) {
  if (byte == SERVO_LINK_STOP) {
    servo_decoder_reset(decoder);
    return SERVO_DECODED_STOP;
  }
  if (byte == SERVO_LINK_FLAG) return servo_decoder_flag(decoder);
  if (!decoder->in_frame) return SERVO_DECODED_OUTSIDE;
  if (decoder->ended) {
    decoder->ended = false;
    decoder->size = 0;
  }
  if (byte == SERVO_LINK_ESCAPE && !decoder->escaped) {
    decoder->escaped = true;
    return SERVO_DECODED_NOTHING;
  }
  if (decoder->escaped) byte = (uint8_t)(byte ^ SERVO_LINK_ESCAPE_XOR);
  decoder->escaped = false;
  if (decoder->size < SERVO_BODY_MAX)
    decoder->body[decoder->size++] = byte;
  else
    decoder->overlong = true;
  return SERVO_DECODED_NOTHING;
}

#ifdef __cplusplus
}
#endif

#endif

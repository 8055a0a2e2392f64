/* SPDX-License-Identifier: MIT */
/* ATmega328P at 16 MHz (Arduino Uno, Nano): the registers. Sections are those of the data sheet DS40002061B.
 *
 * Timer 1: fast PWM with TOP = OCR1A (mode 15, 16.9.3), 1/16 us a count. 65536 such counts are only 4.1 ms,
 * so the servo's period of 20 ms is five runs of 4 ms, and only the first of them has a pulse: OC1B (PB2,
 * Arduino D10) is connected to the servo for that run alone. Its count and overflows are also the clock.
 * Timer 2: the tick of 1 ms. USART 0: 250000 baud, 8N1. TWI: 400 kHz, master, one transfer at a time, driven
 * by its interrupt alone, so that nothing waits for a bus that hangs. */
#include <avr/interrupt.h>
#include <avr/io.h>
#include <avr/sleep.h>
#include <avr/wdt.h>
#include <util/twi.h>

#include "servo.h"

#define RUN_US 4000U
#define RUN_COUNTS (RUN_US * SERVO_TICKS_PER_US)
#define RUNS_PER_PERIOD (SERVO_PULSE_PERIOD_US / RUN_US)
#define TICKS_PER_PERIOD (SERVO_PULSE_PERIOD_US / SERVO_TICK_US)
#define TICK_COUNTS 250U /* of 16 MHz / 64 */
#define RECEIVED_MAX 64U /* a power of two */
#define BUS_HZ 400000UL
#define BUS_TICKS_MAX 3U /* a transfer takes a fifth of a tick */

struct received {
  uint8_t byte;
  uint16_t time_us; /* the low half: a byte does not wait for 65 ms */
};

/* Lives through every reset but that of the supply: opening the port resets most Arduinos. */
struct kept {
  int32_t angle_cdeg, cable_cdeg;
  int32_t check; /* says whether both are whole */
};

struct bus {
  struct encoder_transfer transfer;
  uint8_t read[ENCODER_READ_MAX];
  uint8_t at; /* bytes of the part in hand that are through */
  uint32_t read_us;
  volatile bool busy, over, acknowledged;
  uint8_t ticks; /* since it began */
};

static struct servo the_servo;
static struct bus bus;
static struct kept kept __attribute__((section(".noinit")));
static struct received received[RECEIVED_MAX];
static volatile uint8_t received_put, received_taken;
static volatile uint32_t run_began_us; /* the running run of timer 1 */
static volatile uint8_t ticks_due;
static volatile uint16_t pulse_set;     /* what OC1B will put out in the next period */
static volatile uint16_t pulse_running; /* what it puts out in this one */

/* With interrupts off. */
static uint32_t now_masked_us(void) {
  uint16_t count = TCNT1;
  uint32_t base = run_began_us;
  if ((TIFR1 & _BV(TOV1)) != 0U) { /* the overflow is not yet counted */
    count = TCNT1;
    base += RUN_US;
  }
  return base + count / SERVO_TICKS_PER_US;
}

static uint32_t now_us(void) {
  uint32_t now;
  cli();
  now = now_masked_us();
  sei();
  return now;
}

/* The servo pin. OC1B's register lies behind the compare unit, the pin shows it while COM1B is not 0 (16.8).
 * With COM1B = 2 it is set at BOTTOM and cleared by the match; with COM1B = 0 nothing acts on it (16.8.1),
 * and the pin shows PORTB2, which is low. A change of COM1B takes effect at once (16.7), so it is made only
 * while the register is low as well, where it cannot be seen: after a reset and after every match. No pulse
 * is cut, doubled or moved, for both of its edges are the timer's own. */
static void connect_servo(void) {
  TIFR1 = _BV(OCF1B); /* left by the runs without a pulse */
  TIMSK1 = _BV(OCIE1B) | _BV(TOIE1);
  TCCR1A = _BV(COM1B1) | _BV(WGM11) | _BV(WGM10);
}

static void disconnect_servo(void) {
  TCCR1A = _BV(WGM11) | _BV(WGM10);
  TIMSK1 = _BV(TOIE1);
}

ISR(TIMER1_OVF_vect) {
  static uint8_t run;
  run_began_us += RUN_US;
  if (++run < RUNS_PER_PERIOD) return;
  run = 0;
  pulse_running = pulse_set;
}

/* The pulse has just ended: at least 1.5 ms before the next run would begin another one. */
ISR(TIMER1_COMPB_vect) {
  disconnect_servo();
}

ISR(TIMER2_COMPA_vect) {
  ++ticks_due;
}

ISR(USART_RX_vect) {
  const uint8_t put = received_put, next = (uint8_t)((put + 1U) % RECEIVED_MAX);
  received[put].time_us = (uint16_t)now_masked_us();
  received[put].byte = UDR0;
  if (next != received_taken) received_put = next; /* full: the byte is lost, its frame's CRC will tell */
}

ISR(USART_UDRE_vect) {
  if (servo_output_is_empty(&the_servo.output))
    UCSR0B = (uint8_t)(UCSR0B & ~_BV(UDRIE0));
  else
    UDR0 = servo_output_take(&the_servo.output);
}

#define BUS_GO (_BV(TWINT) | _BV(TWEN) | _BV(TWIE))

/* From the interrupt, or with the TWI switched off. */
static void end_transfer(bool acknowledged) {
  bus.acknowledged = acknowledged;
  bus.busy = false;
  bus.over = true;
}

static void stop_bus(bool acknowledged) {
  TWCR = _BV(TWINT) | _BV(TWEN) | _BV(TWSTO);
  end_transfer(acknowledged);
}

static void write_on(void) {
  if (bus.at < bus.transfer.write_size) {
    TWDR = bus.transfer.write[bus.at++];
    TWCR = BUS_GO;
  } else if (bus.transfer.read_size > 0U) {
    TWCR = BUS_GO | _BV(TWSTA);
  } else {
    stop_bus(true);
  }
}

/* The byte that comes next is acknowledged unless it is the last. */
static void read_on(void) {
  TWCR = bus.at + 1U < bus.transfer.read_size ? BUS_GO | _BV(TWEA) : BUS_GO;
}

ISR(TWI_vect) {
  switch (TW_STATUS) {
    case TW_START:
      bus.at = 0;
      TWDR = (uint8_t)(ENCODER_ADDRESS << 1U) | TW_WRITE;
      TWCR = BUS_GO;
      break;
    case TW_REP_START:
      bus.at = 0;
      TWDR = (uint8_t)(ENCODER_ADDRESS << 1U) | TW_READ;
      TWCR = BUS_GO;
      break;
    case TW_MT_SLA_ACK:
    case TW_MT_DATA_ACK:
      write_on();
      break;
    case TW_MR_SLA_ACK:
      bus.read_us = now_masked_us();
      read_on();
      break;
    case TW_MR_DATA_ACK:
      bus.read[bus.at++] = TWDR;
      read_on();
      break;
    case TW_MR_DATA_NACK:
      bus.read[bus.at] = TWDR;
      stop_bus(true);
      break;
    default: /* not acknowledged, arbitration lost, a fault of the bus */
      stop_bus(false);
      break;
  }
}

/* After a tick of the servo. */
static void run_encoder(void) {
  struct encoder_transfer next;
  if (bus.busy && ++bus.ticks > BUS_TICKS_MAX) {
    TWCR = 0; /* first, so that its interrupt does not come any more */
    end_transfer(false);
  }
  if (bus.busy || bus.over || !servo_encoder_next(&the_servo, &next)) return;
  bus.transfer = next;
  bus.read_us = now_us();
  bus.ticks = 0;
  bus.busy = true;
  TWCR = BUS_GO | _BV(TWSTA);
}

static void report_encoder(void) {
  if (!bus.over) return;
  bus.over = false;
  servo_encoder_done(&the_servo, bus.acknowledged, bus.read, bus.read_us);
}

static void start_bus(void) {
  PORTC |= _BV(PORTC4) | _BV(PORTC5); /* weak pull-ups: where nothing is connected, nothing acknowledges */
  TWBR = (uint8_t)((F_CPU / BUS_HZ - 16UL) / 2UL);
  TWSR = 0;
}

static void start_serial(void) {
  UCSR0A = _BV(U2X0);                 /* before the rate: some receivers of UBRR look at it then */
  UCSR0C = _BV(UCSZ01) | _BV(UCSZ00); /* 8N1 */
  UBRR0 = (uint16_t)(F_CPU / 8UL / SERVO_LINK_BAUD - 1UL);
  UCSR0B = _BV(RXEN0) | _BV(TXEN0) | _BV(RXCIE0);
}

static void start_timers(void) {
  PORTB = (uint8_t)(PORTB & ~_BV(PORTB2)); /* low: OC1B stays disconnected until the servo is armed */
  DDRB |= _BV(DDB2);
  OCR1A = RUN_COUNTS - 1U;
  OCR1B = 1500U * SERVO_TICKS_PER_US; /* never put out */
  OCR2A = TICK_COUNTS - 1U;
  disconnect_servo();
  TIMSK2 = _BV(OCIE2A);
  TCCR2A = _BV(WGM21);
  TCCR1B = _BV(WGM13) | _BV(WGM12) | _BV(CS10); /* / 1 */
  TCCR2B = _BV(CS22); /* / 64; after timer 1, so that a period begins before the tick of that instant */
}

/* In the last tick of a period, 3 ms into its last run: after that run's match, which no longer than 2.5 ms
 * after its BOTTOM found the servo disconnected, and before the BOTTOM at which the pulse begins and OCR1B is
 * taken over (16.9.3). A processor that came too late for it would leave the pulse out or begin it a run
 * later, whole. */
static void set_next_pulse(void) {
  const uint16_t ticks = servo_next_pulse(&the_servo);
  cli();
  pulse_set = ticks;
  if (ticks != 0U) {
    OCR1B = (uint16_t)(ticks - 1U); /* high from BOTTOM to the match, that count included */
    connect_servo();
  }
  sei();
}

/* Not 0 for memory that is all 0, and another one when only one of the two is new. */
static int32_t check_of_kept(void) {
  return ~(kept.angle_cdeg ^ (int32_t)((uint32_t)kept.cable_cdeg << 1U));
}

static void tick(void) {
  static uint32_t time_us;
  static uint8_t tick_of_period;
  cli();
  --ticks_due;
  servo_pulse_started(&the_servo, pulse_running);
  sei();
  wdt_reset();
  time_us += SERVO_TICK_US;
  servo_tick(&the_servo, time_us);
  run_encoder();
  kept.angle_cdeg = the_servo.motion.angle_cdeg;
  kept.cable_cdeg = the_servo.motion.cable_cdeg;
  kept.check = check_of_kept();
  if (++tick_of_period == TICKS_PER_PERIOD) tick_of_period = 0;
  if (tick_of_period == TICKS_PER_PERIOD - 1U) set_next_pulse();
}

static void receive(void) {
  while (received_taken != received_put) {
    const struct received next = received[received_taken];
    const uint32_t now = now_us();
    received_taken = (uint8_t)((received_taken + 1U) % RECEIVED_MAX);
    servo_receive(&the_servo, next.byte, now - (uint16_t)((uint16_t)now - next.time_us));
  }
}

static bool transmitter_is_idle(void) {
  return servo_output_is_empty(&the_servo.output) && (UCSR0A & _BV(UDRE0)) != 0U;
}

static void answer_ping(void) {
  uint32_t send_us;
  if (!servo_ping_is_due(&the_servo, now_us()) || !transmitter_is_idle()) return;
  cli();
  send_us = now_masked_us();
  UDR0 = SERVO_LINK_FLAG;
  sei();
  servo_answer_ping(&the_servo, send_us);
}

static void transmit(void) {
  if (servo_output_is_empty(&the_servo.output)) return;
  cli();
  UCSR0B |= _BV(UDRIE0);
  sei();
}

/* A waiting ping keeps it awake: the delay of its answer must not keep step with the ticks. */
static void sleep_until_interrupt(void) {
  cli();
  if (ticks_due == 0U && received_taken == received_put && !the_servo.ping.waiting && !bus.over) {
    sleep_enable();
    sei(); /* the instruction after it is still carried out: no interrupt slips in between */
    sleep_cpu();
    sleep_disable();
  }
  sei();
}

int main(void) {
  const uint8_t reset_cause = MCUSR;
  MCUSR = 0;
  wdt_enable(WDTO_250MS);
  start_timers(); /* first: time counts from the reset */
  servo_init(&the_servo, SERVO_BOARD_ATMEGA328P, reset_cause);
  if ((reset_cause & _BV(PORF)) == 0U && kept.check == check_of_kept())
    servo_remember(&the_servo, kept.angle_cdeg, kept.cable_cdeg);
  start_serial();
  start_bus();
  set_sleep_mode(SLEEP_MODE_IDLE);
  sei();
  for (;;) {
    receive();
    if (ticks_due != 0U) tick();
    report_encoder();
    answer_ping();
    transmit();
    sleep_until_interrupt();
  }
}

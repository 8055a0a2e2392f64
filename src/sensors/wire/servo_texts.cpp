// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::wire {

namespace {

/// The AVR's MCUSR at reset (ATmega328P data sheet, "MCU Status Register"); several bits can be set.
std::string reset_cause_text(unsigned cause) {
  std::string text;
  const auto add = [&](unsigned bit, const char* name) {
    if ((cause & bit) != 0) text += text.empty() ? name : fmt::format(", {}", name);
  };
  add(0x01U, "power-on");
  add(0x02U, "reset pin");
  add(0x04U, "brown-out");
  add(0x08U, "hung firmware");
  return text.empty() ? fmt::format("unknown cause {}", cause) : text;
}

std::string fault_text(unsigned fault) {
  switch (fault) {
    case SERVO_FAULT_NONE:
      return "no fault";
    case SERVO_FAULT_WATCHDOG:
      return fmt::format("watchdog tripped: no frame from the host for {} ms", SERVO_WATCHDOG_MS);
    case SERVO_FAULT_STOP_BYTE:
      return "stopped by a stop byte";
    case SERVO_FAULT_LIMIT:
      return "an angle limit was reached";
    case SERVO_FAULT_BAD_FRAMES:
      return "three damaged frames in a row";
    default:
      return fmt::format("unknown fault {}", fault);
  }
}

}  // namespace

std::string reason_text(std::uint8_t reason) {
  switch (reason) {
    case SERVO_REASON_UNKNOWN_TYPE:
      return "the servo does not know this command";
    case SERVO_REASON_WRONG_LENGTH:
      return "the command has the wrong length";
    case SERVO_REASON_WRONG_VERSION:
      return "no hello of the firmware's protocol version came first";
    case SERVO_REASON_OUT_OF_SEQUENCE:
      return "the command is out of sequence";
    case SERVO_REASON_NOT_CONFIGURED:
      return "the servo is not configured";
    case SERVO_REASON_NOT_ARMED:
      return "the servo is not armed";
    case SERVO_REASON_ARMED:
      return "not possible while the servo is armed";
    case SERVO_REASON_FAULT:
      return "a fault is latched: arm again";
    case SERVO_REASON_BEYOND_LIMIT:
      return "the angle, rate, acceleration or duration lies beyond a limit";
    case SERVO_REASON_BAD_VALUE:
      return "a value makes no sense";
    default:
      return fmt::format("unknown reason {}", reason);
  }
}

std::string command_name(std::uint8_t type) {
  switch (type) {
    case SERVO_HELLO:
      return "hello";
    case SERVO_CONFIGURE:
      return "configure";
    case SERVO_ARM:
      return "arm";
    case SERVO_DISARM:
      return "disarm";
    case SERVO_RUN:
      return "run";
    case SERVO_GO_TO:
      return "go_to";
    case SERVO_HALT:
      return "halt";
    case SERVO_REFRESH:
      return "refresh";
    case SERVO_PING:
      return "ping";
    default:
      return fmt::format("unknown command {}", type);
  }
}

std::string event_text(const ServoEvent& event) {
  switch (event.kind) {
    case SERVO_EVENT_RESET:
      return fmt::format("the servo's controller was reset ({})", reset_cause_text(event.detail));
    case SERVO_EVENT_FAULT:
      return fault_text(event.detail);
    case SERVO_EVENT_LEG_START:
      return fmt::format("leg {}: commanded speed reached", event.detail);
    case SERVO_EVENT_LEG_END:
      return fmt::format("leg {}: motion ended", event.detail);
    case SERVO_EVENT_REVERSAL:
      return fmt::format("leg {}: turned back at a limit", event.detail);
    default:
      return fmt::format("unknown event {} (detail {})", event.kind, event.detail);
  }
}

}  // namespace thermorig::wire

// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/sent_commands.h"

#include <fmt/format.h>

#include "servo_link.h"
#include "thermorig/sensors/wire/servo_messages.h"

namespace thermorig::wire {

namespace {

constexpr std::uint8_t stop_byte_type = 0;

/// Length of the payload of a command.
std::size_t payload_size(std::uint8_t type) {
  switch (type) {
    case SERVO_HELLO:
      return SERVO_HELLO_SIZE;
    case SERVO_CONFIGURE:
      return SERVO_CONFIGURE_SIZE;
    case SERVO_ARM:
      return SERVO_ARM_SIZE;
    case SERVO_RUN:
      return SERVO_RUN_SIZE;
    case SERVO_GO_TO:
      return SERVO_GO_TO_SIZE;
    case SERVO_PING:
      return SERVO_PING_SIZE;
    default:
      return 0;
  }
}

/// A hello may be longer than this version knows.
bool has_known_size(std::uint8_t type, std::size_t size) {
  return type == SERVO_HELLO ? size >= SERVO_HELLO_SIZE : size == payload_size(type);
}

bool asks_for_shaft(const SentFrame& hello) {
  return hello.payload.size() >= SERVO_HELLO_ASKING_SIZE && (hello.payload[1] & SERVO_ASK_SHAFT) != 0;
}

double hundredths(const std::uint8_t* at) {
  return 0.01 * static_cast<std::int32_t>(servo_get_u32(at));
}

// Offsets are those of the structs in protocols/servo_link.h, field by field without padding.

std::string configure_text(const std::uint8_t* at) {
  const bool continuous = at[0] == SERVO_KIND_CONTINUOUS;
  return fmt::format("configure a {} servo, {} to {} us over {:.2f} {}, at most {:.2f} deg/s and {} deg/s^2",
                     continuous ? "continuous" : "positional", servo_get_u16(at + 1), servo_get_u16(at + 3),
                     hundredths(at + 5), continuous ? "deg/s" : "deg", hundredths(at + 9),
                     servo_get_u16(at + 13));
}

std::string run_text(const std::uint8_t* at) {
  return fmt::format("run leg {} at {:+.2f} deg/s, {} deg/s^2, for {:.2f} s{}", servo_get_u16(at),
                     hundredths(at + 3), servo_get_u16(at + 7), 1e-3 * servo_get_u32(at + 9),
                     (at[2] & SERVO_RUN_TURN_BACK) != 0 ? ", turning back at the limits" : "");
}

std::string go_to_text(const std::uint8_t* at) {
  return fmt::format("go to {:+.2f} deg at {:.2f} deg/s, {} deg/s^2", hundredths(at), hundredths(at + 4),
                     servo_get_u16(at + 8));
}

std::string payload_text(const SentFrame& frame) {
  const std::uint8_t* at = frame.payload.data();
  switch (frame.type) {
    case SERVO_HELLO:
      return fmt::format("hello of version {}{}", at[0],
                         asks_for_shaft(frame) ? ", asking for the shaft" : "");
    case SERVO_CONFIGURE:
      return configure_text(at);
    case SERVO_ARM:
      return fmt::format("arm at {:+.2f} deg", hundredths(at));
    case SERVO_RUN:
      return run_text(at);
    case SERVO_GO_TO:
      return go_to_text(at);
    default:
      return command_name(frame.type);
  }
}

}  // namespace

std::vector<SentFrame> read_sent(std::span<const std::uint8_t> bytes) {
  std::vector<SentFrame> frames;
  for_each_sent(bytes, [&frames](const SentFrame& frame) { frames.push_back(frame); });
  return frames;
}

void for_each_sent(std::span<const std::uint8_t> bytes, const std::function<void(const SentFrame&)>& take) {
  servo_decoder decoder{};
  std::uint64_t begin = 0;  // of the frame that is open
  for (std::uint64_t i = 0; i < bytes.size(); ++i) {
    const servo_decoded decoded = servo_decoder_push(&decoder, bytes[i]);
    if (decoded == SERVO_DECODED_STOP) take({stop_byte_type, 0, {}, {i, i + 1}});
    if (decoded == SERVO_DECODED_FRAME) {
      const std::span payload(decoder.body + 2, servo_decoder_payload_size(&decoder));
      if (has_known_size(decoder.body[0], payload.size()))
        take({decoder.body[0], decoder.body[1], {payload.begin(), payload.end()}, {begin, i + 1}});
    }
    if (bytes[i] == SERVO_LINK_FLAG) begin = decoded == SERVO_DECODED_FRAME ? i + 1 : i;
  }
}

bool is_command(const SentFrame& frame) {
  return frame.type != SERVO_REFRESH && frame.type != SERVO_PING;
}

std::string command_text(const SentFrame& frame) {
  if (frame.type == stop_byte_type) return "stop byte";
  return fmt::format("{} (sequence {})", payload_text(frame), frame.sequence);
}

}  // namespace thermorig::wire

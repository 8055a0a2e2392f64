// SPDX-License-Identifier: MIT
// protocols/servo_link.h against the golden vectors, which were made by other code.
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "bench.h"

namespace thermorig::firmware_test {
namespace {

struct Layout {
  std::uint8_t type = 0;
  std::string widths;  // one character a field: 1, 2, 4 bytes
};

const std::map<std::string, Layout>& layouts() {
  static const std::map<std::string, Layout> all{{"hello", {SERVO_HELLO, "1"}},
                                                 {"configure", {SERVO_CONFIGURE, "12244244"}},
                                                 {"arm", {SERVO_ARM, "4"}},
                                                 {"disarm", {SERVO_DISARM, ""}},
                                                 {"run", {SERVO_RUN, "21424"}},
                                                 {"go_to", {SERVO_GO_TO, "442"}},
                                                 {"halt", {SERVO_HALT, ""}},
                                                 {"refresh", {SERVO_REFRESH, ""}},
                                                 {"ping", {SERVO_PING, "42"}},
                                                 {"welcome", {SERVO_WELCOME, "111111422422"}},
                                                 {"ack", {SERVO_ACK, "14"}},
                                                 {"nack", {SERVO_NACK, "111"}},
                                                 {"telemetry", {SERVO_TELEMETRY, "4442112"}},
                                                 {"pong", {SERVO_PONG, "444"}},
                                                 {"event", {SERVO_EVENT, "124"}},
                                                 {"hello_asking", {SERVO_HELLO, "11"}},
                                                 {"shaft", {SERVO_SHAFT, "4211"}}};
  return all;
}

struct Vector {
  std::string name;
  Bytes bytes;
  std::string meaning;
};

Bytes from_hex(const std::string& text) {
  Bytes bytes;
  for (std::size_t i = 0; i + 1 < text.size(); i += 2)
    bytes.push_back(static_cast<std::uint8_t>(std::stoi(text.substr(i, 2), nullptr, 16)));
  return bytes;
}

std::vector<Vector> vectors() {
  std::ifstream file(std::string(THERMORIG_VECTORS) + "/servo_link.txt");
  std::vector<Vector> all;
  for (std::string line; std::getline(file, line);) {
    if (line.empty() || line[0] == '#') continue;
    const std::size_t first = line.find(" | "), second = line.find(" | ", first + 3);
    all.push_back({line.substr(0, first), from_hex(line.substr(first + 3, second - first - 3)),
                   line.substr(second + 3)});
  }
  return all;
}

/// "halt 8" or "arm 2 angle_cdeg=0" as the whole frame that says it.
Bytes encoded(const std::string& meaning) {
  std::istringstream words(meaning);
  std::string type, field;
  int sequence = 0;
  words >> type >> sequence;
  const Layout& layout = layouts().at(type);
  Bytes payload;
  for (const char width : layout.widths) {
    words >> field;
    const auto value = static_cast<std::uint64_t>(std::stoll(field.substr(field.find('=') + 1)));
    for (int i = 0; i < width - '0'; ++i) payload.push_back(static_cast<std::uint8_t>(value >> (8 * i)));
  }
  return frame(layout.type, static_cast<std::uint8_t>(sequence), payload);
}

std::vector<std::string> parts(const std::string& meaning) {
  std::vector<std::string> all;
  for (std::size_t begin = 0, end = 0; end != std::string::npos; begin = end + 3) {
    end = meaning.find(" ; ", begin);
    all.push_back(meaning.substr(begin, end == std::string::npos ? end : end - begin));
  }
  return all;
}

/// What the decoder makes of bytes: each good frame encoded anew, else "bad", "stop", "outside N".
std::vector<std::string> decoded(const Bytes& bytes) {
  servo_decoder decoder{};
  std::vector<std::string> found;
  int outside = 0;
  for (const std::uint8_t byte : bytes) {
    const servo_decoded result = servo_decoder_push(&decoder, byte);
    if (result == SERVO_DECODED_OUTSIDE) ++outside;
    if (result != SERVO_DECODED_OUTSIDE && outside > 0)
      found.push_back("outside " + std::to_string(std::exchange(outside, 0)));
    if (result == SERVO_DECODED_BAD) found.emplace_back("bad");
    if (result == SERVO_DECODED_STOP) found.emplace_back("stop");
    if (result != SERVO_DECODED_FRAME) continue;
    const Bytes payload(decoder.body + 2, decoder.body + 2 + servo_decoder_payload_size(&decoder));
    const Bytes again = frame(decoder.body[0], decoder.body[1], payload);
    found.emplace_back(again.begin(), again.end());
  }
  return found;
}

std::string expected(const std::string& part) {
  if (!layouts().contains(part.substr(0, part.find(' ')))) return part;
  const Bytes bytes = encoded(part);
  return {bytes.begin(), bytes.end()};
}

bool is_foreign(const std::string& part) {
  return part.starts_with("unknown") || part.starts_with("wrong_length");
}

TEST(ServoVectors, HaveOneOfEachMessage) {
  std::map<std::string, int> seen;
  for (const Vector& vector : vectors()) ++seen[vector.meaning.substr(0, vector.meaning.find(' '))];
  for (const auto& [name, layout] : layouts()) EXPECT_GT(seen[name], 0) << name;
}

TEST(ServoVectors, EncodeToExactlyTheirBytes) {
  for (const Vector& vector : vectors())
    if (!vector.name.starts_with("stream_")) {
      EXPECT_EQ(encoded(vector.meaning), vector.bytes) << vector.name;
    }
}

TEST(ServoVectors, DecodeToWhatTheySay) {
  for (const Vector& vector : vectors()) {
    const std::vector<std::string> found = decoded(vector.bytes);
    std::vector<std::string> meant = parts(vector.meaning);
    if (vector.meaning == "nothing") meant.clear();
    ASSERT_EQ(found.size(), meant.size()) << vector.name;
    for (std::size_t i = 0; i < meant.size(); ++i)
      if (!is_foreign(meant[i])) {
        EXPECT_EQ(found[i], expected(meant[i])) << vector.name;
      }
  }
}

TEST(ServoVectors, CrcIsCcittFalse) {
  std::uint16_t crc = 0xFFFF;
  for (const char digit : std::string("123456789")) crc = servo_crc16(crc, static_cast<std::uint8_t>(digit));
  EXPECT_EQ(crc, 0x29B1);
}

}  // namespace
}  // namespace thermorig::firmware_test

// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/dynamixel.h"

#include <algorithm>
#include <array>
#include <cassert>

namespace thermorig::wire::dynamixel {

namespace {

constexpr std::array<std::uint8_t, 4> packet_header{0xFF, 0xFF, 0xFD, 0x00};
constexpr std::size_t before_instruction = 7;  // header, ID, length
constexpr std::size_t crc_bytes = 2;
constexpr std::uint16_t crc_polynomial = 0x8005;

void put_u16(std::uint16_t value, std::vector<std::uint8_t>& out) {
  out.push_back(static_cast<std::uint8_t>(value & 0xFFU));
  out.push_back(static_cast<std::uint8_t>(value >> 8U));
}

std::uint16_t u16_in(Bytes bytes, std::size_t place) {
  return static_cast<std::uint16_t>(bytes[place] | bytes[place + 1] << 8U);
}

/// Whether these end as a header begins.
bool ends_like_header(Bytes bytes) {
  const std::size_t size = bytes.size();
  return size >= 3 && bytes[size - 3] == 0xFF && bytes[size - 2] == 0xFF && bytes[size - 1] == 0xFD;
}

}  // namespace

std::uint16_t crc16(Bytes bytes) {
  std::uint16_t crc = 0;
  for (const std::uint8_t byte : bytes) {
    crc = static_cast<std::uint16_t>(crc ^ byte << 8U);
    for (int bit = 0; bit < 8; ++bit)
      crc = static_cast<std::uint16_t>((crc & 0x8000U) != 0 ? crc << 1U ^ crc_polynomial : crc << 1U);
  }
  return crc;
}

std::vector<std::uint8_t> packet(std::uint8_t id, Instruction instruction, Bytes parameters) {
  std::vector<std::uint8_t> content{static_cast<std::uint8_t>(instruction)};
  for (const std::uint8_t byte : parameters) {
    content.push_back(byte);
    if (ends_like_header(content)) content.push_back(0xFD);
  }
  std::vector<std::uint8_t> whole(packet_header.begin(), packet_header.end());
  whole.push_back(id);
  put_u16(static_cast<std::uint16_t>(content.size() + crc_bytes), whole);
  whole.insert(whole.end(), content.begin(), content.end());
  put_u16(crc16(whole), whole);
  return whole;
}

std::vector<std::uint8_t> ping(std::uint8_t id) {
  return packet(id, Instruction::ping, {});
}

std::vector<std::uint8_t> read(std::uint8_t id, std::uint16_t address, std::uint16_t bytes) {
  std::vector<std::uint8_t> parameters;
  put_u16(address, parameters);
  put_u16(bytes, parameters);
  return packet(id, Instruction::read, parameters);
}

std::vector<std::uint8_t> write(std::uint8_t id, std::uint16_t address, Bytes data) {
  std::vector<std::uint8_t> parameters;
  put_u16(address, parameters);
  parameters.insert(parameters.end(), data.begin(), data.end());
  return packet(id, Instruction::write, parameters);
}

std::vector<std::uint8_t> note(std::uint16_t leg) {
  std::vector<std::uint8_t> parameters;
  put_u16(leg, parameters);
  return packet(nobodys_id, Instruction::ping, parameters);
}

std::optional<std::size_t> packet_size(Bytes rest) {
  const std::size_t seen = std::min(rest.size(), packet_header.size());
  if (!std::equal(packet_header.begin(), packet_header.begin() + static_cast<std::ptrdiff_t>(seen),
                  rest.begin()))
    return std::nullopt;
  if (rest.size() < before_instruction) return 0;
  const std::size_t size = before_instruction + u16_in(rest, 5);
  if (size < before_instruction + 1 + crc_bytes || size > longest_packet) return std::nullopt;
  return size;
}

std::optional<Packet> parse(Bytes whole) {
  const std::size_t checked = whole.size() - crc_bytes;
  if (crc16(whole.first(checked)) != u16_in(whole, checked)) return std::nullopt;
  Packet found{.id = whole[4], .instruction = Instruction{whole[before_instruction]}, .parameters = {}};
  std::vector<std::uint8_t> content;
  for (std::size_t i = before_instruction; i < checked; ++i) {
    content.push_back(whole[i]);
    if (ends_like_header(content) && i + 1 < checked && whole[i + 1] == 0xFD) ++i;
  }
  std::size_t first = 1;
  if (found.instruction == Instruction::status) {
    if (content.size() < 2) return std::nullopt;
    found.error = content[1];
    first = 2;
  }
  found.parameters.assign(content.begin() + static_cast<std::ptrdiff_t>(first), content.end());
  return found;
}

void put_i32(std::int32_t value, std::vector<std::uint8_t>& out) {
  const auto bits = static_cast<std::uint32_t>(value);
  for (unsigned shift = 0; shift < 32; shift += 8)
    out.push_back(static_cast<std::uint8_t>(bits >> shift & 0xFFU));
}

}  // namespace thermorig::wire::dynamixel

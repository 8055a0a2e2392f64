// SPDX-License-Identifier: MIT
#include "thermorig/sensors/wire/sts3215.h"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace thermorig::wire::sts3215 {

namespace {

constexpr std::uint8_t header = 0xFF;
constexpr std::size_t before_code = 4;        // header, ID, length
constexpr std::size_t beside_parameters = 2;  // code and check sum, which the length counts
constexpr std::uint32_t sign_bit = 0x8000;

/// Of all between header and check sum.
std::uint8_t check_sum(Bytes whole) {
  std::uint32_t sum = 0;
  for (const std::uint8_t byte : whole.subspan(2, whole.size() - 3)) sum += byte;
  return static_cast<std::uint8_t>(~sum & 0xFFU);
}

}  // namespace

std::vector<std::uint8_t> packet(std::uint8_t id, std::uint8_t instruction_or_error, Bytes parameters) {
  std::vector<std::uint8_t> whole;
  whole.reserve(around_parameters + parameters.size());
  for (const std::uint8_t byte :
       {header, header, id, static_cast<std::uint8_t>(parameters.size() + beside_parameters),
        instruction_or_error})
    whole.push_back(byte);
  for (const std::uint8_t byte : parameters) whole.push_back(byte);
  whole.push_back(0);
  whole.back() = check_sum(whole);
  return whole;
}

std::vector<std::uint8_t> ping(std::uint8_t id) {
  return packet(id, static_cast<std::uint8_t>(Instruction::ping), {});
}

std::vector<std::uint8_t> read(std::uint8_t id, std::uint16_t address, std::size_t bytes) {
  const std::array parameters{static_cast<std::uint8_t>(address), static_cast<std::uint8_t>(bytes)};
  return packet(id, static_cast<std::uint8_t>(Instruction::read), parameters);
}

std::vector<std::uint8_t> write(std::uint8_t id, std::uint16_t address, Bytes data) {
  std::vector<std::uint8_t> parameters{static_cast<std::uint8_t>(address)};
  parameters.insert(parameters.end(), data.begin(), data.end());
  return packet(id, static_cast<std::uint8_t>(Instruction::write), parameters);
}

std::vector<std::uint8_t> note(std::uint16_t leg) {
  const std::array parameters{static_cast<std::uint8_t>(leg & 0xFFU), static_cast<std::uint8_t>(leg >> 8U)};
  return packet(nobodys_id, static_cast<std::uint8_t>(Instruction::ping), parameters);
}

std::optional<std::size_t> packet_size(Bytes rest) {
  for (std::size_t i = 0; i < std::min<std::size_t>(rest.size(), 2); ++i)
    if (rest[i] != header) return std::nullopt;
  if (rest.size() > 2 && rest[2] == header) return std::nullopt;
  if (rest.size() < before_code) return 0;
  const std::size_t size = before_code + rest[3];
  if (rest[3] < beside_parameters || size > longest_packet) return std::nullopt;
  return size;
}

std::optional<Packet> parse(Bytes whole) {
  if (check_sum(whole) != whole.back()) return std::nullopt;
  return Packet{whole[2], whole[before_code], {whole.begin() + before_code + 1, whole.end() - 1}};
}

bool is_answer(const Packet& packet) {
  constexpr std::array<std::size_t, 6> asked_for{0,
                                                 1,  // of one register
                                                 position_bytes,
                                                 identity_bytes,
                                                 setting_bytes,
                                                 telemetry_bytes};
  return packet.id < nobodys_id &&
         std::find(asked_for.begin(), asked_for.end(), packet.parameters.size()) != asked_for.end();
}

std::int32_t signed_at(Bytes bytes, std::size_t place) {
  const std::uint32_t number = bytes[place] | static_cast<std::uint32_t>(bytes[place + 1]) << 8U;
  const auto size = static_cast<std::int32_t>(number & ~sign_bit);
  return (number & sign_bit) != 0 ? -size : size;
}

void put_signed(std::int32_t value, std::vector<std::uint8_t>& out) {
  const std::uint32_t number = static_cast<std::uint32_t>(std::abs(value)) | (value < 0 ? sign_bit : 0U);
  out.push_back(static_cast<std::uint8_t>(number & 0xFFU));
  out.push_back(static_cast<std::uint8_t>(number >> 8U & 0xFFU));
}

}  // namespace thermorig::wire::sts3215

// SPDX-License-Identifier: MIT
#include "token.h"

#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>

#include "thermorig/core/error.h"

namespace thermorig::web {

namespace {

constexpr std::string_view digits = "0123456789abcdef";
constexpr std::size_t token_bytes = 16;

}  // namespace

std::string make_token() {
  std::array<std::uint8_t, token_bytes> random{};
  // So few bytes come whole or not at all (getrandom(2)).
  ssize_t count = -1;
  do count = ::getrandom(random.data(), random.size(), 0);
  while (count < 0 && errno == EINTR);
  if (count != static_cast<ssize_t>(random.size()))
    throw Error(ExitCode::failed, std::string("the system gives no random numbers: ") + std::strerror(errno),
                "getrandom", "check the system");
  std::string token;
  for (const std::uint8_t byte : random) {
    token += digits[byte >> 4U];
    token += digits[byte & 15U];
  }
  return token;
}

bool is_token(std::string_view text) {
  return text.size() == 2 * token_bytes && text.find_first_not_of(digits) == std::string_view::npos;
}

bool same_token(std::string_view shown, std::string_view token) {
  // The length is no secret; the digits are.
  if (shown.size() != token.size() || token.empty()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < token.size(); ++i)
    difference |=
        static_cast<unsigned char>(shown[i]) ^ static_cast<unsigned>(static_cast<unsigned char>(token[i]));
  return difference == 0;
}

}  // namespace thermorig::web

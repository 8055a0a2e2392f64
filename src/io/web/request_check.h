// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "assets.h"
#include "thermorig/io/web/server.h"

namespace thermorig::web {

constexpr std::size_t request_line_bytes_max = 8 * 1024;
constexpr std::size_t header_bytes_max = 16 * 1024;
constexpr std::size_t body_bytes_max = 64 * 1024;
constexpr std::size_t client_message_bytes_max = 4 * 1024;
constexpr std::size_t note_characters_max = 200;

/// What the checks look at. A field that comes twice counts as "", which equals nothing.
struct RequestHead {
  std::string_view method, target;
  std::optional<std::string_view> host, origin, content_type, authorization;
  bool upgrade = false;  // asks for a WebSocket of version 13, and has a key
  bool body = false;     // bytes follow the headers
};

/// What a request is held against.
struct Gate {
  std::uint16_t port = 0;
  std::string token;
  bool control = false;
  bool data = false;  // a session that is over is shown: nothing comes, and nothing can be ordered
};

/// An answer that ends a request.
struct Refusal {
  unsigned status = 400;
  std::string sentence;
  std::string_view allow = {};  // of a 405
};

/// What a request asks for.
enum class Route : std::uint8_t { asset, data, stream, order };

/// The route of a target, which must match exactly: no query, no other spelling.
std::optional<Route> route(std::string_view target, const Gate& gate);

/// The file of a target, which is of the page that is shown; nothing for any other.
std::optional<Asset> file_of(std::string_view target, const Gate& gate);

/// What of the data a target of Route::data asks for: "images/12".
std::string_view data_name(std::string_view target);

/// The order of /stop, /mark or /start.
OrderKind order_kind(std::string_view target);

/// Everything that is checked before a body is read, in the order of decision 9: host, target, method,
/// origin, type of content, token, permission to start. Nothing if all is well.
std::optional<Refusal> check(const RequestHead& head, const Gate& gate);

/// 128 bits of the system's random numbers as 32 lower-case hexadecimal digits. Throws Error(failed).
std::string make_token();

bool is_token(std::string_view text);

/// Takes as long for a nearly right token as for a wholly wrong one.
bool same_token(std::string_view shown, std::string_view token);

/// The order of a POST's body, or why it is refused. Never throws on account of the body.
std::variant<Order, Refusal> parse_order(OrderKind kind, std::string_view body);

/// Is this a stream's first message, with the right token?
bool shows_token(std::string_view message, std::string_view token);

}  // namespace thermorig::web

// SPDX-License-Identifier: MIT
#include "request_check.h"

#include <fmt/format.h>
#include <sys/random.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>

#include "thermorig/core/code_point.h"
#include "thermorig/core/error.h"

namespace thermorig::web {

namespace {

using MaybeRefusal = std::optional<Refusal>;

constexpr std::string_view data_prefix = "/data/";
constexpr std::size_t data_name_bytes_max = 40;
constexpr std::string_view session_page = "/session";

bool is_data(std::string_view target) {
  const auto is_plain = [](char c) { return (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') || c == '/'; };
  return target.starts_with(data_prefix) && target.size() > data_prefix.size() &&
         target.size() <= data_prefix.size() + data_name_bytes_max &&
         std::all_of(target.begin(), target.end(), is_plain);
}

bool is_own_host(std::string_view host, std::uint16_t port) {
  for (const std::string_view name : {"localhost", "127.0.0.1", "[::1]"}) {
    if (host == fmt::format("{}:{}", name, port)) return true;
    if (port == 80 && host == name) return true;  // a browser leaves that port out
  }
  return false;
}

MaybeRefusal check_host(const RequestHead& head, const Gate& gate) {
  if (head.host && is_own_host(*head.host, gate.port)) return std::nullopt;
  return Refusal{
      403, fmt::format("this page answers to localhost:{0}, 127.0.0.1:{0} and [::1]:{0} alone; a tunnel "
                       "has to keep the port's number",
                       gate.port)};
}

MaybeRefusal check_method(const RequestHead& head, Route where) {
  const bool reads = head.method == "GET" || head.method == "HEAD";
  switch (where) {
    case Route::asset:
      if (reads) return std::nullopt;
      return Refusal{405, "a file of the page can only be read", "GET, HEAD"};
    case Route::data:
      if (head.method == "GET") return std::nullopt;
      return Refusal{405, "the session's data can only be read", "GET"};
    case Route::stream:
      if (head.method == "GET") return std::nullopt;
      return Refusal{405, "the stream can only be opened", "GET"};
    case Route::order:
      if (head.method == "POST") return std::nullopt;
      return Refusal{405, "an order is a POST request", "POST"};
  }
  return std::nullopt;
}

/// A page of another site may send requests here, but its browser says where they come from.
MaybeRefusal check_origin(const RequestHead& head) {
  if (head.origin && *head.origin == fmt::format("http://{}", *head.host)) return std::nullopt;
  return Refusal{403, head.origin ? "this request comes from another site"
                                  : "an order or a stream needs an Origin that equals its Host"};
}

MaybeRefusal check_content(const RequestHead& head) {
  constexpr std::string_view json = "application/json";
  const auto type = head.content_type.value_or("");
  if (type == json || (type.starts_with(json) && type[json.size()] == ';')) return std::nullopt;
  return Refusal{415, "an order's body is application/json"};
}

MaybeRefusal check_token(const RequestHead& head, const Gate& gate) {
  constexpr std::string_view scheme = "Bearer ";
  const auto shown = head.authorization.value_or("");
  if (shown.starts_with(scheme) && same_token(shown.substr(scheme.size()), gate.token)) return std::nullopt;
  return Refusal{401, "the token is missing or wrong; open the address that the program printed"};
}

MaybeRefusal check_order(const RequestHead& head, const Gate& gate) {
  if (auto refusal = check_origin(head)) return refusal;
  if (auto refusal = check_content(head)) return refusal;
  if (auto refusal = check_token(head, gate)) return refusal;
  if (order_kind(head.target) == OrderKind::start && !gate.control)
    return Refusal{403, "the page may not start motion; start the program with --control if it should"};
  return std::nullopt;
}

/// Browsers leave out where a page's own reading comes from; what comes with it must be right.
MaybeRefusal check_data(const RequestHead& head, const Gate& gate) {
  if (head.origin)
    if (auto refusal = check_origin(head)) return refusal;
  return check_token(head, gate);
}

MaybeRefusal check_stream(const RequestHead& head) {
  if (auto refusal = check_origin(head)) return refusal;
  if (!head.upgrade) return Refusal{426, "the stream is a WebSocket of version 13"};
  return std::nullopt;
}

}  // namespace

std::optional<Asset> file_of(std::string_view target, const Gate& gate) {
  const bool is_shared = target == "/icon.svg" || target == "/licences.txt";
  if (is_shared || gate.data == target.starts_with(session_page)) return asset(target);
  return gate.data && target == "/" ? asset(session_page) : std::nullopt;
}

std::string_view data_name(std::string_view target) {
  return target.substr(data_prefix.size());
}

std::optional<Route> route(std::string_view target, const Gate& gate) {
  if (file_of(target, gate)) return Route::asset;
  if (gate.data) return is_data(target) ? std::optional(Route::data) : std::nullopt;
  if (target == "/stream") return Route::stream;
  if (target == "/stop" || target == "/mark" || target == "/start") return Route::order;
  return std::nullopt;
}

OrderKind order_kind(std::string_view target) {
  if (target == "/mark") return OrderKind::mark;
  return target == "/start" ? OrderKind::start : OrderKind::stop;
}

std::optional<Refusal> check(const RequestHead& head, const Gate& gate) {
  if (auto refusal = check_host(head, gate)) return refusal;
  const auto where = route(head.target, gate);
  if (!where) return Refusal{404, "there is nothing here"};
  if (auto refusal = check_method(head, *where)) return refusal;
  if (head.body && *where != Route::order) return Refusal{400, "only an order has a body"};
  if (*where == Route::order) return check_order(head, gate);
  if (*where == Route::stream) return check_stream(head);
  if (*where == Route::data) return check_data(head, gate);
  return std::nullopt;
}

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

namespace {

/// Nothing that a client sends is deeper than one object; whatever is deeper is not even stored.
nlohmann::json parse_flat(std::string_view text) {
  using Event = nlohmann::json::parse_event_t;
  bool deep = false;
  const auto shallow = [&deep](int depth, Event event, const nlohmann::json&) {
    const bool opens = event == Event::object_start || event == Event::array_start;
    deep = deep || (opens && depth > 0);
    return !deep;
  };
  auto value = nlohmann::json::parse(text, shallow, false);
  return deep ? nlohmann::json(nlohmann::json::value_t::discarded) : value;
}

std::optional<Refusal> check_note(std::string_view note) {
  std::size_t characters = 0;
  for (; !note.empty(); ++characters) {
    const auto character = first_character(note);
    if (!character || !is_plain(character->code_point))
      return Refusal{400, "a note has visible characters only, in one line and one direction"};
    note.remove_prefix(character->bytes);
  }
  if (characters > note_characters_max)
    return Refusal{400, fmt::format("a note has at most {} characters", note_characters_max)};
  return std::nullopt;
}

}  // namespace

std::variant<Order, Refusal> parse_order(OrderKind kind, std::string_view body) {
  const nlohmann::json value = parse_flat(body);
  if (!value.is_object()) return Refusal{400, "an order's body is a JSON object with nothing nested in it"};
  Order order{kind, ""};
  if (kind != OrderKind::mark) return order;
  const auto note = value.find("note");
  if (note == value.end()) return order;
  if (!note->is_string()) return Refusal{400, "a note is a text"};
  order.note = note->get<std::string>();
  if (auto refusal = check_note(order.note)) return *std::move(refusal);
  return order;
}

bool shows_token(std::string_view message, std::string_view token) {
  const nlohmann::json value = parse_flat(message);
  if (!value.is_object()) return false;
  const auto shown = value.find("token");
  return shown != value.end() && shown->is_string() &&
         same_token(shown->get_ref<const std::string&>(), token);
}

}  // namespace thermorig::web

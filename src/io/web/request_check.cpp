// SPDX-License-Identifier: MIT
#include "request_check.h"

#include <fmt/format.h>

#include <algorithm>

#include "token.h"

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

}  // namespace thermorig::web

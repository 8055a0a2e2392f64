// SPDX-License-Identifier: MIT
#include "client_json.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "thermorig/core/code_point.h"
#include "token.h"

namespace thermorig::web {

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

// SPDX-License-Identifier: MIT
#pragma once

#include <string_view>
#include <variant>

#include "request_check.h"

namespace thermorig::web {

/// The order of a POST's body, or why it is refused. Never throws on account of the body.
std::variant<Order, Refusal> parse_order(OrderKind kind, std::string_view body);

/// Is this a stream's first message, with the right token?
bool shows_token(std::string_view message, std::string_view token);

}  // namespace thermorig::web

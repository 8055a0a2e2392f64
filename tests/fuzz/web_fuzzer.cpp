// SPDX-License-Identifier: MIT
// Any request to the page and any order: refused with a sentence, or one that was allowed.
#include <array>
#include <cstdint>
#include <string>

#include "fuzz_require.h"
#include "io/web/assets.h"
#include "io/web/request_check.h"

namespace thermorig::web {

/// The page's files are made by its bundler; here one stands for all.
std::optional<Asset> asset(std::string_view path) {
  if (path != "/") return std::nullopt;
  return Asset{"text/html; charset=utf-8", "\"1\"", "x", "x"};
}

}  // namespace thermorig::web

namespace {

using namespace thermorig;
using test::fuzz_require;

const web::Gate gate{.port = 8650, .token = "0123456789abcdef0123456789abcdef", .control = false};
const web::Gate of_a_session{.port = 8650, .token = gate.token, .control = false, .data = true};

void check_request(test::FuzzScript& script) {
  const std::array<std::string, 3> methods{"GET", "POST", script.text(8)};
  const std::array<std::string, 6> targets{"/", "/stop", "/mark", "/live", "/data/rows", script.text(24)};
  const std::array<std::string, 3> hosts{"127.0.0.1:8650", "localhost:8650", script.text(24)};
  const std::array<std::string, 3> origins{"http://127.0.0.1:8650", "http://localhost:8650", script.text(24)};
  const std::array<std::string, 2> types{"application/json", script.text(16)};
  const std::array<std::string, 2> shown{"Bearer " + gate.token, script.text(48)};
  const auto choose = [&script](const auto& words) {
    return std::string_view(words[script.byte() % words.size()]);
  };
  web::RequestHead head{.method = choose(methods), .target = choose(targets)};
  const std::uint8_t there = script.byte();
  if ((there & 1U) != 0) head.host = choose(hosts);
  if ((there & 2U) != 0) head.origin = choose(origins);
  if ((there & 4U) != 0) head.content_type = choose(types);
  if ((there & 8U) != 0) head.authorization = choose(shown);
  head.upgrade = (there & 16U) != 0;
  head.body = (there & 32U) != 0;
  const web::Gate& its_gate = (there & 64U) != 0 ? of_a_session : gate;
  const auto refusal = web::check(head, its_gate);
  if (refusal) return fuzz_require(refusal->status >= 400 && !refusal->sentence.empty());
  fuzz_require(head.host == hosts[0] || head.host == hosts[1] || head.host == "[::1]:8650");
  const auto route = web::route(head.target, its_gate);
  fuzz_require(route.has_value());
  if (route == web::Route::data)
    fuzz_require(its_gate.data && head.method == "GET" && head.authorization == shown[0]);
  if (route == web::Route::order)
    fuzz_require(head.method == "POST" && head.authorization == shown[0] && head.target != "/start");
}

void check_order(std::string_view body) {
  for (const auto kind : {web::OrderKind::stop, web::OrderKind::mark, web::OrderKind::start}) {
    const auto order = web::parse_order(kind, body);
    if (const auto* refusal = std::get_if<web::Refusal>(&order)) {
      fuzz_require(refusal->status >= 400 && !refusal->sentence.empty());
      continue;
    }
    for (const char c : std::get<web::Order>(order).note) fuzz_require(static_cast<unsigned char>(c) >= 0x20);
  }
  if (web::shows_token(body, gate.token))
    fuzz_require(body.find(gate.token.substr(0, 4)) != body.npos || body.find('\\') != body.npos);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  test::FuzzScript script(data, size);
  check_request(script);
  check_order({reinterpret_cast<const char*>(data), size});
  return 0;
}

// SPDX-License-Identifier: MIT
#include "answer.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace thermorig::web {

Fields protecting_fields(std::string_view host) {
  // Not every browser takes 'self' for a WebSocket to the same place, so that one is named.
  const std::string streams = host.empty() ? "" : fmt::format("connect-src 'self' ws://{}; ", host);
  return {{"Content-Security-Policy",
           fmt::format("default-src 'self'; {}frame-ancestors 'none'; base-uri 'none'; form-action 'none'",
                       streams)},
          {"X-Content-Type-Options", "nosniff"},
          {"Referrer-Policy", "no-referrer"},
          {"Cross-Origin-Resource-Policy", "same-origin"},
          {"Cross-Origin-Opener-Policy", "same-origin"},
          {"Cache-Control", "no-store"}};
}

Answer file_answer(const Asset& file, std::string_view accepted_encodings) {
  Answer answer{200, {}, ""};
  answer.fields = {{"Content-Type", std::string(file.type)},
                   {"ETag", std::string(file.etag)},
                   {"Vary", "Accept-Encoding"}};
  const bool zipped = !file.bytes.empty() && accepted_encodings.find("gzip") != std::string_view::npos;
  if (zipped) answer.fields.emplace_back("Content-Encoding", "gzip");
  answer.body = zipped ? file.bytes : file.plain;
  return answer;
}

Answer refusal_answer(const Refusal& refusal) {
  Answer answer{refusal.status, {{"Content-Type", "application/json"}}, ""};
  if (!refusal.allow.empty()) answer.fields.emplace_back("Allow", std::string(refusal.allow));
  if (refusal.status == 401) answer.fields.emplace_back("WWW-Authenticate", "Bearer");
  if (refusal.status == 426) {
    answer.fields.emplace_back("Upgrade", "websocket");
    answer.fields.emplace_back("Sec-WebSocket-Version", "13");
  }
  answer.body = nlohmann::json{{"error", refusal.sentence}}.dump() + "\n";
  return answer;
}

}  // namespace thermorig::web

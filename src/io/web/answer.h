// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "assets.h"
#include "request_check.h"

namespace thermorig::web {

using Fields = std::vector<std::pair<std::string_view, std::string>>;

/// An answer before it becomes bytes.
struct Answer {
  unsigned status = 204;
  Fields fields;
  std::string body;
};

/// What every answer has, whatever it is. `host`: as the client wrote it, once it has been checked; or "".
Fields protecting_fields(std::string_view host);

/// A file of the page, as gzip if the client takes that.
Answer file_answer(const Asset& file, std::string_view accepted_encodings);

/// The sentence as JSON, and what its status needs beside it.
Answer refusal_answer(const Refusal& refusal);

}  // namespace thermorig::web

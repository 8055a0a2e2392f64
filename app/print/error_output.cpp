// SPDX-License-Identifier: MIT
#include "error_output.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>
#include <string>

#include "output.h"

namespace thermorig::app {

int report(const Error& error, bool json) {
  flush_output();
  if (error.what_happened().empty()) {  // the reader of a pipe has enough
    if (!error.advice().empty()) print(stderr, "{}\n", printable(error.advice()));
    return static_cast<int>(error.code());
  }
  const bool colours = escapes_allowed(stderr);
  const std::string where = error.where().empty() ? "" : error.where() + ": ";
  constexpr std::string_view name = "thermorig:";
  const std::string text = folded(std::string(name) + " " + printable(where + error.what_happened()));
  print(stderr, "{}{}{}{}\n", colours ? "\x1b[31m" : "", name, colours ? "\x1b[0m" : "",
        std::string_view(text).substr(name.size()));
  if (!error.advice().empty()) print(stderr, "  try: {}\n", printable(error.advice()));
  const int code = static_cast<int>(error.code());
  if (json) {
    print_json({{"event", "error"},
                {"exit_code", code},
                {"what", error.what_happened()},
                {"where", error.where()},
                {"advice", error.advice()}});
  }
  flush_output();
  return code;
}

nlohmann::json refused_file_json(const std::filesystem::path& file, const Error& error) {
  return {{"file", file.string()},
          {"exit_code", static_cast<int>(error.code())},
          {"error", error.what_happened()},
          {"advice", error.advice()}};
}

}  // namespace thermorig::app

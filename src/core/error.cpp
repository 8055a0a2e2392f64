// SPDX-License-Identifier: MIT
#include "thermorig/core/error.h"

#include <utility>

namespace thermorig {

namespace {
std::string sentence(const std::string& what, const std::string& where, const std::string& advice) {
  std::string text = where.empty() ? what : where + ": " + what;
  if (!advice.empty()) text += "\n  try: " + advice;
  return text;
}
}  // namespace

Error::Error(ExitCode code, std::string what, std::string where, std::string advice)
    : std::runtime_error(sentence(what, where, advice)),
      code_(code),
      what_(std::move(what)),
      where_(std::move(where)),
      advice_(std::move(advice)) {}

}  // namespace thermorig

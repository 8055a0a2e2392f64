// SPDX-License-Identifier: MIT
#include "thermorig/storage/sandbox/refusal.h"

#include <optional>

#include "refusal_text.h"
#include "thermorig/core/printable.h"

namespace thermorig::sandbox {

namespace {

constexpr char separator = '\0';
constexpr char damaged = 'd', given_up = 'g';  // not_a_session; anything else

/// The next part, fit to be shown, which is taken away. None: no separator is left.
std::optional<std::string> take_part(std::string_view& text) {
  const std::size_t end = text.find(separator);
  if (end == std::string_view::npos) return std::nullopt;
  std::string part = printable(text.substr(0, end));
  text.remove_prefix(end + 1);
  return part;
}

/// A child's name for the file becomes the path.
std::string with_path(const std::string& where, const std::filesystem::path& path) {
  const std::string_view name = name_in_children;
  return where.starts_with(name) ? path.string() + where.substr(name.size()) : where;
}

}  // namespace

void refuse(const std::filesystem::path& path, const std::string& what) {
  throw Error(ExitCode::not_a_session, what, path.string(),
              "name a session that thermorig wrote; if this is one, it is damaged: take a copy of it from "
              "elsewhere, or its journal with thermorig recover");
}

void refuse_as_hostile(const std::filesystem::path& path) {
  refuse(path, "is damaged or hostile: the process that tried to read it first did not survive it");
}

std::string refusal_text(const Error& refusal) {
  std::string text(1, refusal.code() == ExitCode::not_a_session ? damaged : given_up);
  for (const std::string& part : {refusal.what_happened(), refusal.where(), refusal.advice()})
    text += part.substr(0, part.find(separator)) + separator;
  return text;
}

void refuse_as_told(std::string_view text, const std::filesystem::path& path) {
  if (text.empty() || (text.front() != damaged && text.front() != given_up)) refuse_as_hostile(path);
  const ExitCode code = text.front() == damaged ? ExitCode::not_a_session : ExitCode::failed;
  text.remove_prefix(1);
  const auto what = take_part(text), where = take_part(text), advice = take_part(text);
  if (!what || !where || !advice || !text.empty()) refuse_as_hostile(path);
  throw Error(code, *what, with_path(*where, path), *advice);
}

}  // namespace thermorig::sandbox

// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace thermorig::embedded {

/// A file to be written.
struct SourceFile {
  std::string name;
  std::string text;
};

/// Throws Error(bad_usage) if files and symbols of C cannot begin with it.
void require_name(const std::string& name);

/// C whose files and symbols begin with `prefix`, in capitals too, with `name` in its place.
std::string renamed(std::string_view text, std::string_view prefix, const std::string& name);

/// Text from outside, which anybody may have written, as a part of a comment of C: it can neither end the
/// comment nor begin a line, and is cut after 100 characters.
std::string comment_safe(std::string_view text);

}  // namespace thermorig::embedded

// SPDX-License-Identifier: MIT
#include "thermorig/rig/profile/toml_text.h"

#include <fmt/format.h>

#include <string_view>
#include <utility>

#include "thermorig/core/code_point.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/whole_file.h"

namespace thermorig::rig {

namespace {

constexpr std::size_t file_bytes_max = 1'000'000;
constexpr std::size_t depth_max = 32;
constexpr std::size_t line_bytes_max = 4096;
constexpr std::size_t list_line_bytes = 80;  // of a list: it goes on in the next line

/// As TOML has to be; the library reads beyond the end of keys that are not.
/// Goes through a text once. Where that is valid TOML, it knows what is a string or a comment; where it is
/// not, the parser stops at the latest where the two would differ.
class TomlPreparation {
 public:
  TomlPreparation(std::string_view text, const std::string& file_name) : left_(text), file_name_(file_name) {
    out_.text.reserve(text.size() + text.size() / list_line_bytes);
  }

  TomlText take() {
    out_.lines.push_back(line_);
    while (!left_.empty()) {
      const char next = left_.front();
      if (next == '#')
        pass_comment();
      else if (next == '"' || next == '\'')
        pass_string(next);
      else
        pass_sign(next);
    }
    return std::move(out_);
  }

 private:
  void pass(std::size_t bytes = 1) {
    for (; bytes > 0; --bytes) {
      const char passed = left_.front();
      left_.remove_prefix(1);
      out_.text += passed;
      ++line_bytes_;
      if (passed == '\n') begin_line(++line_);
    }
    if (line_bytes_ > line_bytes_max)
      refuse(fmt::format("the line has more than {} bytes", line_bytes_max), "break it into shorter ones");
  }

  void begin_line(std::size_t number) {
    out_.lines.push_back(number);
    line_bytes_ = 0;
    dots_ = 0;
  }

  void pass_comment() {
    while (!left_.empty() && left_.front() != '\n') pass();
  }

  void pass_string(char quote) {
    const std::string three(3, quote);
    const bool has_lines = left_.starts_with(three);
    pass(has_lines ? 3 : 1);
    while (!left_.empty()) {
      if (has_lines ? left_.starts_with(three) : left_.front() == quote) {
        pass(has_lines ? 3 : 1);
        if (has_lines) pass_last_quotes(quote);
        return;
      }
      if (!has_lines && left_.front() == '\n') return;
      const bool escapes = quote == '"' && left_.front() == '\\' && left_.size() > 1;
      pass(escapes ? 2 : 1);
    }
  }

  /// One or two may stand before the three that end a text of several lines.
  void pass_last_quotes(char quote) {
    for (int most = 2; most > 0 && !left_.empty() && left_.front() == quote; --most) pass();
  }

  void pass_sign(char sign) {
    if (sign == '[' || sign == '{') open_ += sign;
    if ((sign == ']' || sign == '}') && !open_.empty()) open_.pop_back();
    dots_ = sign == '.'                                                     ? dots_ + 1
            : std::string_view("[{,=").find(sign) == std::string_view::npos ? dots_
                                                                            : 0;
    if (open_.size() + dots_ > depth_max)
      refuse(fmt::format("it is nested more than {} levels deep", depth_max),
             "close the brackets: plans and profiles need two levels");
    pass();
    if (sign == ',' && open_.ends_with('[') && line_bytes_ >= list_line_bytes) {
      out_.text += '\n';
      begin_line(line_);
    }
  }

  [[noreturn]] void refuse(const std::string& what, const std::string& advice) const {
    throw Error(ExitCode::bad_usage, what, fmt::format("{}:{}", file_name_, line_), advice);
  }

  std::string_view left_;
  const std::string& file_name_;
  TomlText out_;
  std::size_t line_ = 1;  // in the file
  std::size_t line_bytes_ = 0;
  std::string open_;      // brackets
  std::size_t dots_ = 0;  // of the key that is being read
};

}  // namespace

TomlText prepared_toml(const std::string& text, const std::string& file_name) {
  if (!is_utf8(text))
    throw Error(ExitCode::bad_usage, "it is not UTF-8 text", file_name, "a file saved as UTF-8");
  return TomlPreparation(text, file_name).take();
}

std::string read_text_file(const std::string& path, const std::string& what) {
  try {
    const auto bytes = files::read_whole(path, file_bytes_max, "the " + what);
    return {bytes.begin(), bytes.end()};
  } catch (const Error& error) {
    if (error.code() == ExitCode::no_permission) throw;
    throw Error(ExitCode::bad_usage, error.what_happened(), error.where(),
                "name a TOML file that is there and may be read");
  }
}

}  // namespace thermorig::rig

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace thermorig::model {

// Text in a model file comes from anywhere and ends up on terminals and in pages.

inline constexpr std::size_t text_bytes_max = 1000;

/// UTF-8 of at most `text_bytes_max` bytes without control characters and without those that turn the
/// direction of writing.
bool is_plain_text(std::string_view text);

/// The text with '?' for each byte or character that `is_plain_text` would refuse, cut at `bytes_max`.
std::string plain_text(std::string_view text, std::size_t bytes_max = text_bytes_max);

/// 'text' in quotes, plain and short, for a sentence about a file.
std::string in_quotes(std::string_view text);

}  // namespace thermorig::model

// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <string_view>

namespace thermorig {

/// Text from outside (file names, attributes, what devices send) as one line for people. What could steer a
/// terminal, hide, or make the line read as another one is replaced by its name: "\n", "\t", "\r",
/// "\u{202E}", and "\xFF" for a byte that is not UTF-8. All else stays, so twice gives the same as once.
std::string printable(std::string_view text);

/// A word of a command that people are to type: quoted where a shell would take it for something else.
std::string shell_word(std::string_view word);

}  // namespace thermorig

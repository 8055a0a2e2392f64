// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

namespace CLI {
class App;
}

namespace thermorig::app {

/// What the last of `words` (behind "thermorig"; it may be empty) can become, a line each: the word, and
/// behind a tab what it means, where that is known. A folder ends in '/', an option that needs its value
/// joined in '='. Looks at /dev, at profiles, and at the folder that is being typed.
std::string completions(const CLI::App& root, const std::vector<std::string>& words);

}  // namespace thermorig::app

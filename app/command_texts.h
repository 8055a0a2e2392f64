// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <string>

namespace CLI {
class App;
}

namespace thermorig::app {

// What is made of the commands as the parser has them: man pages and the tables of docs/commands.md.

/// "thermorig.1", "thermorig-record.1", ... and their text. Their date is that of SOURCE_DATE_EPOCH (seconds
/// since 1970) where it is set, else today.
std::map<std::string, std::string> man_pages(const CLI::App& root);

/// The table of each command's options in Markdown, between the marks that docs/commands.md has.
std::string option_tables(const CLI::App& root);

}  // namespace thermorig::app

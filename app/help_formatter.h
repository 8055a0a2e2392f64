// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <string>

namespace thermorig::app {

/// How the help of a command names its options: "--npz[=WHAT]" and "--speeds V,V,..." in the left column;
/// choices, the default and what an option needs behind its meaning.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

/// An option takes one word, a list with commas: what follows is a file, or the next option.
void take_one_word_each(CLI::App& command);

/// The command that the first word names that is no option; null: none.
CLI::App* command_in(CLI::App& root, const std::vector<std::string>& words);

/// `--csv gyro session.h5` is `--csv=gyro session.h5`: CLI11 would take the value for the file. `words`: of
/// the command line.
void join_values(CLI::App& root, std::vector<std::string>& words);

}  // namespace thermorig::app

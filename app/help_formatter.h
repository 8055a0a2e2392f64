// SPDX-License-Identifier: MIT
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

namespace thermorig::app {

/// Where --help and --json stand in every help: last.
inline constexpr const char* last_group = "Other";

/// Puts the options that `add` gives the command into a group of its help.
void in_group(CLI::App& command, const std::string& group, const std::function<void()>& add);

struct OptionGroup {
  std::string name;
  std::vector<const CLI::Option*> options;  // not positional
};

/// The groups of a command's help in their order, those of nameless inner commands ("One of these") among
/// them.
std::vector<OptionGroup> option_groups(const CLI::App& command);

std::vector<const CLI::Option*> positionals(const CLI::App& command);

/// The commands below it that have a name, in their order.
std::vector<const CLI::App*> named_commands(const CLI::App& command);

/// The words that an option takes, where it takes no other: {"half", "full"}; empty: any.
std::vector<std::string> choices(const CLI::Option& option);

/// "WHAT" of `--npz[=WHAT]`; empty: the option takes no value.
std::string value_name(const CLI::Option& option);

/// How the help of a command names its options: "--npz[=WHAT]" and "--speeds V,V,..." in the left column;
/// choices, the default and what an option needs behind its meaning.
class HelpFormatter : public CLI::Formatter {
 public:
  std::string make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const override;
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;
};

/// The --help of a command and of all below it stands in the last group of its help.
void put_help_last(CLI::App& command);

/// An option takes one word, a list with commas: what follows is a file, or the next option.
void take_one_word_each(CLI::App& command);

/// The command that the first word names that is no option; null: none.
CLI::App* command_in(CLI::App& root, const std::vector<std::string>& words);

/// `--csv gyro session.h5` is `--csv=gyro session.h5`: CLI11 would take the value for the file. `words`: of
/// the command line.
void join_values(CLI::App& root, std::vector<std::string>& words);

}  // namespace thermorig::app

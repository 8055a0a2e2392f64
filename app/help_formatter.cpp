// SPDX-License-Identifier: MIT
#include "help_formatter.h"

#include <algorithm>
#include <vector>

namespace thermorig::app {

namespace {

/// "WHAT" of CLI11's "WHAT:{windows,rows}", and what stands behind the colon.
struct Value {
  std::string name, choices;
};

Value value_of(const CLI::Option& option) {
  const std::string type = option.get_type_name();
  const std::size_t end = std::min(type.find(':'), type.size());
  Value value{type.substr(0, end), type.substr(end)};
  value.choices.erase(0, 1);
  if (!value.choices.starts_with('{')) value.choices.clear();  // a range: "INT in [1 - 6]"
  return value;
}

/// A value that may be left out stands behind "=".
bool takes_value_if_joined(const CLI::Option& option) {
  return option.get_items_expected_max() == 0 && !value_of(option).name.empty();
}

/// Whether `word` is a value that `option` may be given behind "=".
bool is_value_of(CLI::Option& option, std::string word) {
  return takes_value_if_joined(option) && !word.starts_with('-') && (*option.get_validator(""))(word).empty();
}

/// ": half, full" where `text` does not name them.
std::string choices_text(const std::string& text, const std::vector<std::string>& names) {
  const bool named = std::all_of(names.begin(), names.end(), [&](const std::string& name) {
    return text.find(name) != std::string::npos;
  });
  return named ? "" : ": " + CLI::detail::join(names, ", ");
}

}  // namespace

void in_group(CLI::App& command, const std::string& group, const std::function<void()>& add) {
  const auto before = command.get_options();
  add();
  for (CLI::Option* option : command.get_options())
    if (std::find(before.begin(), before.end(), option) == before.end() && !option->get_positional())
      option->group(group);
}

std::vector<OptionGroup> option_groups(const CLI::App& command) {
  std::vector<OptionGroup> groups;
  OptionGroup last{last_group, {}};
  const auto place_of = [&](const std::string& name) -> OptionGroup& {
    if (name == last_group) return last;
    for (OptionGroup& group : groups)
      if (group.name == name) return group;
    return groups.emplace_back(OptionGroup{name, {}});
  };
  for (const CLI::Option* option : command.get_options())
    if (!option->get_positional()) place_of(option->get_group()).options.push_back(option);
  for (const CLI::App* inner : command.get_subcommands({}))
    if (inner->get_name().empty())
      for (const CLI::Option* option : inner->get_options())
        place_of(inner->get_group()).options.push_back(option);
  if (!last.options.empty()) groups.push_back(last);
  return groups;
}

std::vector<const CLI::Option*> positionals(const CLI::App& command) {
  return command.get_options([](const CLI::Option* option) { return option->get_positional(); });
}

std::vector<const CLI::App*> named_commands(const CLI::App& command) {
  return command.get_subcommands([](const CLI::App* inner) { return !inner->get_name().empty(); });
}

std::vector<std::string> choices(const CLI::Option& option) {
  const std::string listed = value_of(option).choices;
  if (listed.empty()) return {};
  return CLI::detail::split(listed.substr(1, listed.size() - 2), ',');
}

std::string value_name(const CLI::Option& option) {
  if (option.get_items_expected_max() == 0 && !takes_value_if_joined(option)) return "";
  const std::string name = value_of(option).name;
  return name.empty() ? "VALUE" : name;
}

std::string HelpFormatter::make_help(const CLI::App* app, std::string name, CLI::AppFormatMode mode) const {
  const std::vector<OptionGroup> groups = option_groups(*app);
  for (const OptionGroup& group : groups)
    for (const CLI::Option* option : group.options)
      if (option->get_required()) name += " " + option->get_name() + " " + value_name(*option);
  std::string text = make_description(app) + make_usage(app, std::move(name)) + make_positionals(app);
  if (!named_commands(*app).empty()) text += make_subcommands(app, mode);
  for (const OptionGroup& group : groups) text += make_group(group.name, false, group.options);
  return text + "\n" + make_footer(app);
}

std::string HelpFormatter::make_option_name(const CLI::Option* option, bool is_positional) const {
  std::string name = CLI::Formatter::make_option_name(option, is_positional);
  for (std::size_t at = name.find('{'); at != std::string::npos; at = name.find('{'))
    name.erase(at, name.find('}', at) + 1 - at);
  return takes_value_if_joined(*option) ? name + "[=" + value_of(*option).name + "]" : name;
}

std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  std::string more = option->get_allow_extra_args() ? "..." : "";
  if (option->get_positional()) return more;
  if (option->get_items_expected_max() == 0) return "";
  const std::string name = value_of(*option).name;
  return (name.empty() ? "" : " " + name) + more + (option->get_required() ? " (required)" : "");
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  std::string text = option->get_description();
  text += choices_text(text, choices(*option));
  const auto add = [&text](const std::string& more) {  // into brackets that are there
    if (text.ends_with(')'))
      text.replace(text.size() - 1, 1, "; " + more + ")");
    else
      text += " (" + more + ")";
  };
  const std::string usual = option->get_default_str();
  if (!usual.empty() && text.find("default") == std::string::npos) add("default " + usual);
  for (const CLI::Option* needed : option->get_needs()) add("with " + needed->get_name());
  return text;
}

void put_help_last(CLI::App& command) {
  for (CLI::App* inner : command.get_subcommands(nullptr)) put_help_last(*inner);
  command.set_help_flag(command.get_name().empty() ? "" : "-h,--help", "Print this help");
  if (command.get_help_ptr() != nullptr) command.get_help_ptr()->group(last_group);
}

void take_one_word_each(CLI::App& command) {
  for (CLI::Option* option : command.get_options())
    if (!option->get_positional()) option->allow_extra_args(false);
  for (CLI::App* inner : command.get_subcommands(nullptr)) take_one_word_each(*inner);
}

CLI::App* command_in(CLI::App& root, const std::vector<std::string>& words) {
  const auto name = std::find_if(words.begin(), words.end(),
                                 [](const std::string& word) { return !word.starts_with('-'); });
  if (name == words.end()) return nullptr;
  const auto named = root.get_subcommands([&](CLI::App* app) { return app->get_name() == *name; });
  return named.empty() ? nullptr : named.front();
}

void join_values(CLI::App& root, std::vector<std::string>& words) {
  CLI::App* command = command_in(root, words);
  for (std::size_t i = 0; command != nullptr && i + 1 < words.size(); ++i) {
    CLI::Option* option = command->get_option_no_throw(words[i]);
    if (option == nullptr || !is_value_of(*option, words[i + 1])) continue;
    words[i] += "=" + words[i + 1];
    words.erase(words.begin() + static_cast<std::ptrdiff_t>(i) + 1);
  }
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include "command_texts.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <array>
#include <cctype>
#include <cstdlib>
#include <ctime>
#include <fstream>
#include <set>
#include <sstream>
#include <string_view>

#include "build_information.h"
#include "commands.h"
#include "help_formatter.h"
#include "rig_options.h"
#include "thermorig/core/error.h"

namespace thermorig::app {

namespace {

constexpr std::array<std::string_view, 11> exit_codes{
    "0\nDone.",
    "1\nIt failed for another reason.",
    "2\nAn argument, plan or profile is wrong, or a file is not there.",
    "3\nDone, but data were lost or too many frames are not valid.",
    "4\nA device is missing, silent, or another device.",
    "5\nA device failed during the run; what was recorded is kept.",
    "6\nNo permission for a port or file, or another program holds it.",
    "7\nThe disk is full, read-only or fails, or the file exists already.",
    "8\nThe file is damaged, or not of the kind that is asked for.",
    "9\nA check failed.",
    "130\nStopped by Ctrl-C after a clean close."};

/// Text that roff prints as it is.
std::string roff(std::string_view text) {
  std::string escaped;
  for (const char c : text) {
    switch (c) {
      case '\\':
        escaped += "\\e";
        break;
      case '-':
        escaped += "\\-";
        break;
      case '\'':
        escaped += "\\(aq";
        break;
      case '`':
        escaped += "\\(ga";
        break;
      case '^':
        escaped += "\\(ha";
        break;
      case '~':
        escaped += "\\(ti";
        break;
      default:
        escaped += c;
    }
  }
  return escaped.starts_with('.') ? "\\&" + escaped : escaped;
}

/// What the left column of help says of an option: "-o,--output" and " DIR (required)".
struct OptionName {
  std::string names, value;
};

OptionName name_of(const CLI::Option& option) {
  const HelpFormatter formatter;
  const std::string names = formatter.make_option_name(&option, option.get_positional());
  return {CLI::detail::find_and_replace(names, ",-", ", -"), formatter.make_option_opts(&option)};
}

/// "-o, --output" bold, " DIR" as it is.
std::string term_of(const CLI::Option& option) {
  const OptionName name = name_of(option);
  return (option.get_positional() ? "\\fI" : "\\fB") + roff(name.names) + "\\fR" + roff(name.value);
}

std::string meaning_of(const CLI::Option& option) {
  return HelpFormatter().make_option_desc(&option);
}

std::string full_name(const CLI::App& command) {
  return command.get_parent() == nullptr ? command.get_name()
                                         : full_name(*command.get_parent()) + " " + command.get_name();
}

void add_item(std::string& page, const std::string& term, const std::string& meaning) {
  page += ".TP\n" + term + "\n" + roff(meaning) + "\n";
}

void add_options(std::string& page, const CLI::App& command) {
  for (const CLI::Option* option : positionals(command))
    add_item(page, term_of(*option), meaning_of(*option));
  for (const OptionGroup& group : option_groups(command)) {
    if (group.name != "Options" && command.get_parent()->get_parent() == nullptr)
      page += ".SS " + roff(group.name) + "\n";
    for (const CLI::Option* option : group.options) add_item(page, term_of(*option), meaning_of(*option));
  }
}

/// Sentences of a footer as they are, its examples (indented) as they are typed.
std::string examples(const std::string& footer) {
  std::string page;
  std::istringstream lines(footer);
  bool typed = false;
  for (std::string line; std::getline(lines, line);) {
    const bool is_typed = line.starts_with("  ");
    if (!is_typed && (line == "Examples:" || line == "Example:")) continue;
    if (is_typed != typed)
      page += std::string(page.empty() || !is_typed ? "" : ".PP\n") + (is_typed ? ".EX\n" : ".EE\n.PP\n");
    typed = is_typed;
    page += roff(is_typed ? line.substr(2) : line) + "\n";
  }
  return page + (typed ? ".EE\n" : "");
}

std::string upper(std::string text) {
  std::transform(text.begin(), text.end(), text.begin(), [](unsigned char c) { return std::toupper(c); });
  return text;
}

std::string head(const std::string& name, const std::string& summary, const std::string& date) {
  return ".\\\" Made by thermorig " + std::string(build_information::version) +
         " of its own commands\n.TH \"" + upper(roff(name)) + "\" \"1\" \"" + date + "\" \"thermorig " +
         build_information::version + "\" \"User Commands\"\n.SH NAME\n" + roff(name) + " \\- " +
         roff(summary) + "\n";
}

std::string usage(const CLI::App& command) {
  std::string page = ".B " + roff(full_name(command)) + "\n";
  for (const OptionGroup& group : option_groups(command))
    for (const CLI::Option* option : group.options)
      if (option->get_required())
        page += ".BI " + roff(option->get_name()) + " \" " + roff(value_name(*option)) + "\"\n";
  page += ".RI [ OPTIONS ]\n";
  for (const CLI::Option* option : positionals(command)) {
    const OptionName name = name_of(*option);
    page += option->get_required() ? ".I " + roff(name.names) + roff(name.value) + "\n"
                                   : ".RI [ " + roff(name.names) + " ]" + roff(name.value) + "\n";
  }
  return page;
}

std::string command_page(const CLI::App& command, const std::string& date) {
  std::string page =
      head("thermorig-" + command.get_name(), command.get_description(), date) + ".SH SYNOPSIS\n";
  const auto inner = named_commands(command);
  if (inner.empty()) page += usage(command);
  for (const CLI::App* one : inner) page += (one == inner.front() ? "" : ".br\n") + usage(*one);
  if (inner.empty()) {
    page += ".SH OPTIONS\n";
    add_options(page, command);
  } else {
    page += ".SH COMMANDS\n";
  }
  for (const CLI::App* one : inner) {
    page += ".SS " + roff(full_name(*one)) + "\n" + roff(one->get_description()) + ".\n";
    add_options(page, *one);
  }
  page += ".SH EXAMPLES\n" + examples(command.get_footer());
  return page +
         ".SH SEE ALSO\n.BR thermorig (1),\nwhich names the exit codes;\n/usr/share/doc/thermorig/docs\n";
}

std::string program_page(const CLI::App& root, const std::string& date) {
  std::string page = head("thermorig", "record, look at and learn from a thermal camera and gyro rig", date);
  page += ".SH SYNOPSIS\n.B thermorig\n.I COMMAND\n.RI [ OPTIONS ]\n.SH DESCRIPTION\n" +
          roff(root.get_description()) + "\n.SH COMMANDS\n";
  for (const CLI::App* command : named_commands(root))
    page +=
        ".TP\n.BR thermorig\\-" + command->get_name() + " (1)\n" + roff(command->get_description()) + "\n";
  page += ".SH OPTIONS\n";
  for (const OptionGroup& group : option_groups(root))
    for (const CLI::Option* option : group.options) add_item(page, term_of(*option), meaning_of(*option));
  page += ".SH EXIT STATUS\n";
  for (const std::string_view code : exit_codes) page += ".TP\n" + std::string(code) + "\n";
  page +=
      ".SH FILES\n.TP\n\\(ti/.config/thermorig/NAME.toml\nThe profile of a rig, which \\fB\\-\\-rig\\fR "
      "\\fINAME\\fR "
      "takes.\n";
  return page + ".SH EXAMPLES\n" + examples(root.get_footer()) + ".SH SEE ALSO\n/usr/share/doc/thermorig\n";
}

std::string page_date() {
  const char* set = std::getenv("SOURCE_DATE_EPOCH");
  const std::time_t seconds = set != nullptr ? std::strtoll(set, nullptr, 10) : std::time(nullptr);
  std::tm parts{};
  gmtime_r(&seconds, &parts);
  std::array<char, 16> text{};
  std::strftime(text.data(), text.size(), "%Y-%m-%d", &parts);
  return text.data();
}

std::string cell(std::string text) {
  text = CLI::detail::find_and_replace(std::move(text), "|", "\\|");
  return CLI::detail::find_and_replace(std::move(text), "<", "&lt;");
}

std::string row(const CLI::Option& option) {
  const OptionName name = name_of(option);
  return "| `" + cell(name.names) + cell(name.value) + "` | " + cell(meaning_of(option)) + " |\n";
}

/// A group's rows. Several that `record` has word by word are names in one row.
std::string group_rows(const OptionGroup& group, const std::set<std::string>& rows_of_record) {
  const auto is_of_record = [&](const CLI::Option* option) { return rows_of_record.contains(row(*option)); };
  const bool refers = std::ranges::count_if(group.options, is_of_record) > 1;
  std::string own, shared;
  for (const CLI::Option* option : group.options) {
    if (refers && is_of_record(option))
      shared += (shared.empty() ? "`" : ", `") + cell(name_of(*option).names) + "`";
    else
      own += row(*option);
  }
  const std::string reference = " | As in [record](#record) |\n";
  if (own.empty() && (group.name == rig_group || group.name == simulated_rig_group))
    return "| **" + group.name + "**" + reference;
  return (group.name == "Options" ? "" : "| **" + group.name + "** | |\n") + own +
         (refers ? "| " + shared + reference : "");
}

std::string table(const CLI::App& command, const CLI::App& record) {
  std::set<std::string> rows_of_record;
  if (&command != &record)
    for (const CLI::Option* option : record.get_options()) rows_of_record.insert(row(*option));
  std::string rows = "| option | meaning |\n| --- | --- |\n";
  for (const CLI::Option* option : positionals(command)) rows += row(*option);
  for (const OptionGroup& group : option_groups(command))
    if (group.name != last_group) rows += group_rows(group, rows_of_record);  // every command has those
  return rows;
}

void add_tables(std::string& text, const CLI::App& command, const CLI::App& record) {
  const auto inner = named_commands(command);
  for (const CLI::App* one : inner) add_tables(text, *one, record);
  if (!inner.empty()) return;
  const std::string name = full_name(command).substr(std::string("thermorig ").size());
  text += "<!-- options: " + name + " -->\n" + table(command, record) + "<!-- end of options -->\n";
}

}  // namespace

std::map<std::string, std::string> man_pages(const CLI::App& root) {
  const std::string date = page_date();
  std::map<std::string, std::string> pages{{"thermorig.1", program_page(root, date)}};
  for (const CLI::App* command : named_commands(root))
    pages["thermorig-" + command->get_name() + ".1"] = command_page(*command, date);
  return pages;
}

std::string option_tables(const CLI::App& root) {
  std::string text;
  add_tables(text, root, *root.get_subcommand("record"));
  return text;
}

ExitCode run(const ManPagesOptions& options) {
  std::error_code failure;
  std::filesystem::create_directories(options.folder, failure);
  for (const auto& [name, text] : options.pages) {
    std::ofstream file(options.folder / name, std::ios::binary);
    if (!(file << text << std::flush))
      throw Error(ExitCode::storage, "the man page could not be written", (options.folder / name).string(),
                  "a folder that can be written");
  }
  return ExitCode::ok;
}

}  // namespace thermorig::app

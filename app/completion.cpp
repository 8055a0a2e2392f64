// SPDX-License-Identifier: MIT
#include "completion.h"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <filesystem>
#include <initializer_list>

#include "help_formatter.h"
#include "record/profile_path.h"
#include "thermorig/core/error.h"
#include "thermorig/simulation/panorama.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

/// Candidates for a word that begins with `begun`.
class Candidates {
 public:
  explicit Candidates(std::string begun) : begun_(std::move(begun)) {}

  void add(const std::string& word, const std::string& meaning = "") {
    if (word.starts_with(begun_)) lines_.push_back(word + (meaning.empty() ? "" : "\t" + meaning));
  }
  void add_all(const std::vector<std::string>& words) {
    for (const std::string& word : words) add(word);
  }

  /// Folders and the files with one of these endings (none: all files) of the folder that is typed so far.
  void add_files(std::initializer_list<std::string_view> endings) {
    const std::size_t slash = begun_.rfind('/');
    const std::string folder = slash == std::string::npos ? "" : begun_.substr(0, slash + 1);
    each_entry(folder, [&](const fs::directory_entry& entry) {
      const std::string name = entry.path().filename();
      std::error_code unknown;
      if (name.starts_with('.') && begun_.size() == folder.size()) return;
      if (entry.is_directory(unknown)) return add(folder + name + "/");
      const bool fits = std::any_of(endings.begin(), endings.end(),
                                    [&](std::string_view ending) { return name.ends_with(ending); });
      if (fits || endings.size() == 0) add(folder + name);
    });
  }
  void add_folders() { add_files({"/"}); }  // which no name ends with

  /// Names of the entries of a folder whose names begin and end so, without the ending.
  void add_names(const fs::path& folder, std::string_view begin, std::string_view end,
                 const std::string& before) {
    each_entry(folder, [&](const fs::directory_entry& entry) {
      const std::string name = entry.path().filename();
      if (name.starts_with(begin) && name.ends_with(end))
        add(before + name.substr(0, name.size() - end.size()));
    });
  }
  void add_subfolders(const fs::path& folder) {
    each_entry(folder, [&](const fs::directory_entry& entry) {
      std::error_code unknown;
      if (entry.is_directory(unknown)) add(entry.path().filename());
    });
  }

  /// Each with `before` before it, as the shell has it.
  std::string text(const std::string& before) {
    std::sort(lines_.begin(), lines_.end());
    lines_.erase(std::unique(lines_.begin(), lines_.end()), lines_.end());
    std::string text;
    for (const std::string& line : lines_) text += before + line + "\n";
    return text;
  }

 private:
  template <class Take>
  static void each_entry(const fs::path& folder, const Take& take) {
    std::error_code missing;
    std::string place = folder.empty() ? "." : folder.string();
    const char* home = std::getenv("HOME");
    if (place.starts_with("~/") && home != nullptr) place.replace(0, 1, home);
    for (fs::directory_iterator entry(place, missing), end; !missing && entry != end;
         entry.increment(missing))
      take(*entry);
  }

  std::string begun_;
  std::vector<std::string> lines_;
};

void add_ports(Candidates& candidates) {
  for (const char* begin : {"ttyUSB", "ttyACM", "ttyS"}) candidates.add_names("/dev", begin, "", "/dev/");
  candidates.add_names("/dev/thermorig", "", "", "/dev/thermorig/");
}

void add_profiles(Candidates& candidates) {
  try {
    candidates.add_names(profile_path("name").parent_path(), "", ".toml", "");
  } catch (const Error&) {
    // no home, no names
  }
  candidates.add_files({".toml"});
}

/// What is known of a value by the word that help shows for it, and by its command or option.
void add_values(Candidates& candidates, const CLI::App& command, const CLI::Option& option) {
  const std::vector<std::string> listed = choices(option);
  if (!listed.empty()) return candidates.add_all(listed);
  const std::string kind = option.get_positional() ? option.get_name() : value_name(option);
  const std::string name = option.get_lnames().empty() ? "" : option.get_lnames().front();
  if (kind == "PORT") return add_ports(candidates);
  if (kind == "PROFILE") return add_profiles(candidates);
  if (kind == "DIR" || kind == "FOLDER") return candidates.add_folders();
  if (name == "environment") {
    candidates.add_all(simulation::scene_names());
    return candidates.add_subfolders("recordings");
  }
  if (name == "plan") {
    candidates.add_all({"paper", "quick", "table-one"});
    return candidates.add_files({".toml"});
  }
  if (name == "world") return candidates.add_all({"honest", "typical", "hard"});
  if (name == "model" || name == "from") {
    candidates.add_all({"general", "none"});
    return candidates.add_files({".onnx"});
  }
  if (name == "map") return candidates.add_files({".map"});
  if (kind == "SESSION" || (kind == "PATH" && !option.get_positional())) return candidates.add_files({".h5"});
  if (kind == "PATH") return candidates.add_files({".h5", ".journal", ".map", ".onnx"});
  if (kind == "FILE" && command.get_name() == "export")
    return candidates.add_files({".h5", ".onnx", ".toml"});
  if (kind == "FILE") return candidates.add_files({});
}

void add_options(Candidates& candidates, const CLI::App& command) {
  for (const OptionGroup& group : option_groups(command))
    for (const CLI::Option* option : group.options)
      for (const std::string& name : option->get_lnames())
        candidates.add("--" + name, option->get_description());
}

void add_commands(Candidates& candidates, const CLI::App& command) {
  for (const CLI::App* one : named_commands(command)) candidates.add(one->get_name(), one->get_description());
}

const CLI::App* named_in(const CLI::App& command, const std::string& name) {
  for (const CLI::App* one : named_commands(command))
    if (one->get_name() == name) return one;
  return nullptr;
}

/// The option that `word` names, nameless inner commands' among them; null: none.
const CLI::Option* option_named(const CLI::App& command, const std::string& word) {
  if (!word.starts_with('-')) return nullptr;
  for (const OptionGroup& group : option_groups(command))
    for (const CLI::Option* option : group.options)
      if (option->check_name(word)) return option;
  return nullptr;
}

bool waits_for_value(const CLI::Option* option) {
  return option != nullptr && option->get_items_expected_max() > 0;
}

}  // namespace

std::string completions(const CLI::App& root, const std::vector<std::string>& words) {
  if (words.empty()) return "";
  const std::string& last = words.back();
  const CLI::App* command = &root;
  const CLI::Option* waiting = nullptr;  // for a value
  for (std::size_t i = 0; i + 1 < words.size(); ++i) {
    const CLI::App* inner = waiting == nullptr ? named_in(*command, words[i]) : nullptr;
    const CLI::Option* option = waiting == nullptr ? option_named(*command, words[i]) : nullptr;
    waiting = waits_for_value(option) ? option : nullptr;
    if (inner != nullptr) command = inner;
  }
  const std::size_t equals = last.starts_with('-') ? last.find('=') : std::string::npos;
  if (equals != std::string::npos) {
    Candidates candidates(last.substr(equals + 1));
    const CLI::Option* option = option_named(*command, last.substr(0, equals));
    if (option != nullptr) add_values(candidates, *command, *option);
    return candidates.text(last.substr(0, equals + 1));
  }
  Candidates candidates(last);
  const auto words_of_their_own = positionals(*command);
  if (waiting != nullptr) {
    add_values(candidates, *command, *waiting);
  } else if (last.starts_with('-')) {
    add_options(candidates, *command);
  } else if (!named_commands(*command).empty()) {
    add_commands(candidates, *command);
    if (words.size() == 1) candidates.add("help", "Help on a command");
  } else {
    for (const CLI::Option* option : words_of_their_own) add_values(candidates, *command, *option);
    if (words_of_their_own.empty()) add_options(candidates, *command);
  }
  return candidates.text("");
}

}  // namespace thermorig::app

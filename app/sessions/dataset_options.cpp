// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>
#include <string>

#include "rig_options.h"
#include "session_options.h"

namespace thermorig::app {

namespace {

CLI::App& add_action(CLI::App& command, DatasetOptions& options, const std::string& name,
                     DatasetAction action, const std::string& meaning) {
  CLI::App& added = *command.add_subcommand(name, meaning);
  added.group("Commands");
  added.add_option("FOLDER", options.folder, "Folder of the data set")->required();
  added.parse_complete_callback([&options, action] { options.action = action; });
  add_json(added, options.json);
  return added;
}

void add_build(CLI::App& command, DatasetOptions& options) {
  CLI::App& build = add_action(command, options, "build", DatasetAction::build,
                               "Describe a folder of sessions: manifest, checksums, data card, citation");
  build.add_option("--title", options.title, "Title of the data set")->required()->type_name("TEXT");
  build.add_option("--description", options.description, "What the data are for, in a sentence")
      ->type_name("TEXT");
  build.add_option("--author", options.authors, "An author; may be repeated")->type_name("NAME");
  build.add_option("--licence", options.licence, "Licence of the data (default: that of all sessions)")
      ->type_name("TEXT");
  build.add_option("--data-version", options.version, "Version of the data set")
      ->type_name("TEXT")
      ->capture_default_str();
  build.add_option("--url", options.url, "Where it will be published")->type_name("URL");
  build.add_option("--date", options.date, "Date of publication, e.g. 2026-11-23 (default: today, UTC)")
      ->type_name("DATE");
  build.add_flag("--accept-bad", options.accept_bad,
                 "Include sessions with the verdict bad; the data card names them");
  build.add_flag("--replace", options.replace, "Replace descriptions that are there");
  build.footer(
      "Example:\n"
      "  thermorig dataset build recordings --title Kitchen --licence CC-BY-4.0");
}

void add_split(CLI::App& command, DatasetOptions& options) {
  CLI::App& split = add_action(command, options, "split", DatasetAction::split,
                               "Print training and test sessions, leaving out one environment at a time");
  CLI::Option* environment = split
                                 .add_option("-e,--environment", options.environment,
                                             "Only the split that leaves this environment out")
                                 ->type_name("NAME");
  split.add_option("--part", options.part, "Only the paths of one part, a line each: training or test")
      ->check(one_of({"training", "test"}))
      ->type_name("WORD")
      ->needs(environment);
  split.add_flag("--accept-bad", options.accept_bad, "Include sessions with the verdict bad");
  split.footer(
      "Example:\n"
      "  thermorig dataset split recordings --environment garden --part training");
}

}  // namespace

void add_dataset(CLI::App& root, DatasetOptions& options) {
  CLI::App& command = *root.add_subcommand("dataset", "Prepare a folder of sessions for publication");
  command.require_subcommand(1);
  add_build(command, options);
  CLI::App& verify = add_action(command, options, "verify", DatasetAction::verify,
                                "Check that no file has changed since the data set was built");
  verify.footer("Exit code 9 if one is not.\nExample:\n  thermorig dataset verify recordings");
  add_split(command, options);
  command.footer(
      "Examples:\n"
      "  thermorig dataset build recordings --title Kitchen --licence CC-BY-4.0\n"
      "  thermorig dataset verify recordings");
}

}  // namespace thermorig::app

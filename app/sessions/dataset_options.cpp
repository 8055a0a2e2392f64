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
  added.add_option("FOLDER", options.folder, "Folder of the data set")->required();
  added.parse_complete_callback([&options, action] { options.action = action; });
  add_json(added, options.json);
  return added;
}

void add_build(CLI::App& command, DatasetOptions& options) {
  CLI::App& build = add_action(command, options, "build", DatasetAction::build,
                               "Describe a folder of sessions: manifest, sums, card, citation, Croissant");
  build.add_option("--title", options.title, "Title of the data set")->required()->type_name("TEXT");
  build.add_option("--description", options.description, "What it is for, a sentence")->type_name("TEXT");
  build.add_option("--author", options.authors, "An author; may be repeated")->type_name("NAME");
  build.add_option("--licence", options.licence, "Licence of the data (default: what all sessions say)")
      ->type_name("TEXT");
  build.add_option("--data-version", options.version, "Version of the data set")
      ->type_name("TEXT")
      ->capture_default_str();
  build.add_option("--url", options.url, "Where it will be found")->type_name("URL");
  build.add_option("--date", options.date, "Date of its publication, 2026-11-23 (default: today, UTC)")
      ->type_name("DATE");
  build.add_flag("--accept-bad", options.accept_bad,
                 "Take sessions whose verdict is bad; the card names them");
  build.add_flag("--replace", options.replace, "Write over the descriptions that are there");
  build.footer(
      "Example:\n  thermorig dataset build recordings --title 'Rotations of a kitchen' --author 'A. Person' "
      "--licence CC-BY-4.0");
}

void add_split(CLI::App& command, DatasetOptions& options) {
  CLI::App& split = add_action(command, options, "split", DatasetAction::split,
                               "Leave one environment out at a time: what to train on, what to test on");
  CLI::Option* environment =
      split.add_option("-e,--environment", options.environment, "Only the split that leaves this one out")
          ->type_name("NAME");
  split.add_option("--part", options.part, "Only the paths of one part, a line each: training or test")
      ->check(CLI::IsMember({"training", "test"}))
      ->type_name("WORD")
      ->needs(environment);
  split.add_flag("--accept-bad", options.accept_bad, "Take sessions whose verdict is bad");
  split.footer(
      "Example:\n  thermorig train $(thermorig dataset split recordings --environment garden --part "
      "training)");
}

}  // namespace

void add_dataset(CLI::App& root, DatasetOptions& options) {
  CLI::App& command =
      *root.add_subcommand("dataset", "Make a folder of sessions a data set that can be published");
  command.require_subcommand(1);
  add_build(command, options);
  CLI::App& verify = add_action(command, options, "verify", DatasetAction::verify,
                                "Say whether every file is as it was when the data set was built");
  verify.footer("Exit code 9 if one is not.\nExample:\n  thermorig dataset verify recordings");
  add_split(command, options);
  command.footer(
      "Examples:\n"
      "  thermorig dataset build recordings --title 'Rotations of a kitchen' --licence CC-BY-4.0\n"
      "  thermorig dataset verify recordings");
}

}  // namespace thermorig::app

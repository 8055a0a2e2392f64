// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "rig_options.h"
#include "session_options.h"

namespace thermorig::app {

void add_annotate(CLI::App& root, AnnotateOptions& options) {
  CLI::App& command = *root.add_subcommand("annotate", "Say afterwards what is to be known of a session");
  command.add_option("SESSION", options.file, "Session file (.h5); it is rewritten whole")->required();
  CLI::Option_group& kinds = *command.add_option_group("One of these");
  kinds.add_option("--note", options.note, "A sentence that stays with it")->type_name("TEXT");
  kinds
      .add_option("--environment", options.environment,
                  "It belongs there: it moves, and takes the next free number")
      ->type_name("NAME");
  CLI::Option* exclude =
      kinds
          .add_option("--exclude", options.exclude,
                      "Do not trust frames exposed from A to B, in seconds since its start; or all")
          ->type_name("A..B");
  kinds.add_flag("--undo", options.undo, "Take the last annotation back");
  kinds.require_option(1);
  command.add_option("--reason", options.reason, "Why they are excluded")->type_name("TEXT")->needs(exclude);
  add_json(command, options.json);
  command.footer(
      "Examples:\n"
      "  thermorig annotate session.h5 --note 'the window was open'\n"
      "  thermorig annotate session.h5 --exclude 12.5..14.0 --reason 'a hand in the image'\n"
      "  thermorig annotate session.h5 --undo");
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "rig_options.h"
#include "session_options.h"

namespace thermorig::app {

void add_list(CLI::App& root, ListOptions& options) {
  CLI::App& command = *root.add_subcommand("list", "List sessions");
  command.add_option("FOLDER", options.paths, "Session files (.h5), or folders to search")
      ->default_str("recordings");
  command.add_option("-e,--environment", options.environments, "Only this environment; may be repeated")
      ->type_name("NAME");
  command.add_option("--plan", options.plans, "Only this plan; may be repeated")->type_name("NAME");
  command.add_option("--verdict", options.verdicts, "Only this verdict: good, usable, bad; may be repeated")
      ->check(one_of({"good", "usable", "bad"}))
      ->type_name("WORD");
  CLI::Option* simulated =
      command.add_flag("--simulated", options.simulated, "Only sessions of the simulated rig");
  command.add_flag("--real", options.real, "Only sessions of real rigs")->excludes(simulated);
  command
      .add_option(
          "--sort", options.sort,
          "Order: environment (and number, default), date, verdict (worst first), valid (fewest first)")
      ->check(one_of({"environment", "date", "verdict", "valid"}))
      ->type_name("WORD");
  command.add_flag("--reverse", options.reverse, "Reverse the order");
  add_json(command, options.json);
  command.footer(
      "Examples:\n"
      "  thermorig list\n"
      "  thermorig list recordings/ --environment garden --verdict good --sort date");
}

}  // namespace thermorig::app

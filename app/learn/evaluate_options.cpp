// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "help_formatter.h"
#include "learning_options.h"
#include "rig_options.h"
#include "thermorig/core/label.h"

namespace thermorig::app {

namespace {

/// What is trained, and how.
void add_study_words(CLI::App& command, EvaluateOptions& options) {
  command.add_flag("--study", options.study,
                   "Run the study: leave out each acquisition of an environment once, train on all others "
                   "and test on it, for "
                   "several Nf and Nr");
  command
      .add_option("--environment", options.environment,
                  "Environment whose acquisitions are left out (default garden)")
      ->type_name("NAME");
  command.add_option("--nf", options.frames, "Frames per window to try (default 2,3,4,5,6)")
      ->delimiter(',')
      ->type_name("LIST");
  command.add_option("--nr", options.reductions, "Pixel averaging to try (default 1,2,3)")
      ->delimiter(',')
      ->type_name("LIST");
  command.add_option("--seeds", options.seeds, "Random seeds of every setting (default 1)")
      ->check(not_negative())
      ->delimiter(',')
      ->type_name("LIST");
  command
      .add_option("--reference-seeds", options.reference_seeds,
                  "Random seeds of Nf 3 with Nr 1 (default 1,2,3)")
      ->check(not_negative())
      ->delimiter(',')
      ->type_name("LIST");
  command.add_option("--preset", options.preset, "How to train: paper (as published, default), best")
      ->check(one_of({"paper", "best"}))
      ->type_name("NAME");
  command
      .add_option("--label", options.label,
                  "Speed to learn and test against: commanded (default), corrected, shaft, measured")
      ->check(one_of({label_names.begin(), label_names.end()}))
      ->type_name("NAME");
  command.add_option("--epochs", options.epochs, "Epochs of each training (default 40)")
      ->check(within(1, 10'000))
      ->type_name("N");
  command
      .add_option("--history", options.history,
                  "Valid frames in a row before a window ends, for all Nf (default: the largest Nf)")
      ->check(within(2, 1'000))
      ->type_name("N");
}

/// Which of its jobs this program does, and what it draws.
void add_job_words(CLI::App& command, EvaluateOptions& options) {
  command.add_option("--jobs", options.workers, "Trainings at the same time (default: one per core)")
      ->check(within(1, 1'024))
      ->type_name("N");
  command.add_option("--draw", options.draw, "Only write the report again from the results in this folder")
      ->type_name("DIR");
  command.add_flag("--require-complete", options.require_complete,
                   "With --study and --draw: fail unless every job has its result");
  command.add_flag("--list-jobs", options.list_jobs,
                   "With --study: only list the jobs: id, and done or open");
  command
      .add_option("--shard", options.shard,
                  "With --study: only run part I of N of the jobs, without a report")
      ->type_name("I/N");
  command.add_flag("--baselines", options.baselines,
                   "With --study: only compute the rows that need no training again, from the sessions");
}

/// Without --study and --live the first word is the model.
void take_model(EvaluateOptions& options) {
  if (options.study || options.live || options.draw || options.paths.empty()) return;
  options.model = options.paths.front();
  options.paths.erase(options.paths.begin());
}

}  // namespace

void add_evaluate(CLI::App& root, EvaluateOptions& options) {
  CLI::App& command =
      *root.add_subcommand("evaluate", "Evaluate a model on sessions, or run the paper's study");
  command.add_option("PATH", options.paths,
                     "A model (.onnx, or general), then sessions (.h5, or folders of them); with --study and "
                     "--live only sessions");
  command.add_option("-o,--output", options.output, "Folder for reports, and for the results of a study")
      ->type_name("DIR");
  command
      .add_option("--plots", options.plots,
                  "Write figures (SVG, PDF, PNG) and tables (LaTeX, CSV) to this empty folder")
      ->type_name("DIR");
  command.add_flag("--live", options.live, "Evaluate what a live run showed, from its session");
  command.add_flag("--bound", options.bound,
                   "Also compute the best accuracy the images allow (Cramer-Rao bound)");
  command
      .add_option("--turned", options.turned,
                  "Windows to average: 1 (default), or 8 (all symmetries of the window)")
      ->check(CLI::IsMember({1, 8}))
      ->type_name("N");
  command.add_flag("--accept-bad", options.accept_bad,
                   "Include sessions with the verdict bad (default: those in folders are skipped)");
  add_json(command, options.json);
  add_frame_memory(command, options.frame_memory);
  in_group(command, "The paper's study", [&] {
    add_study_words(command, options);
    add_job_words(command, options);
  });
  command.footer(
      "Examples:\n"
      "  thermorig evaluate model.onnx recordings/garden -o report\n"
      "  thermorig evaluate --live recordings/garden\n"
      "  thermorig evaluate --study recordings -o study\n"
      "  thermorig evaluate --study recordings -o study --shard 1/8\n"
      "  thermorig evaluate --draw study --plots plots");
  command.callback([&options] { take_model(options); });
}

}  // namespace thermorig::app

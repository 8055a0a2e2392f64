// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "learning_options.h"
#include "rig_options.h"

namespace thermorig::app {

namespace {

constexpr const char* study_group = "The study of the paper";

/// What is trained, and how.
void add_study_words(CLI::App& command, EvaluateOptions& options) {
  command
      .add_flag("--study", options.study,
                "Leave each acquisition of an environment out once, train on all others, test on it; for "
                "several Nf and Nr")
      ->group(study_group);
  command
      .add_option("--environment", options.environment, "Whose acquisitions are left out (default garden)")
      ->type_name("NAME")
      ->group(study_group);
  command.add_option("--nf", options.frames, "Frames a window, at the reference Nr (default 2,3,4,5,6)")
      ->delimiter(',')
      ->type_name("LIST")
      ->group(study_group);
  command.add_option("--nr", options.reductions, "Averaging, at the reference Nf (default 1,2,3)")
      ->delimiter(',')
      ->type_name("LIST")
      ->group(study_group);
  command.add_option("--seeds", options.seeds, "Seeds of every setting (default 1)")
      ->check(not_negative())
      ->delimiter(',')
      ->type_name("LIST")
      ->group(study_group);
  command
      .add_option("--reference-seeds", options.reference_seeds,
                  "Seeds at the reference, Nf 3 and Nr 1 (default 1,2,3)")
      ->check(not_negative())
      ->delimiter(',')
      ->type_name("LIST")
      ->group(study_group);
  command.add_option("--preset", options.preset, "How to train: paper (default), best")
      ->check(CLI::IsMember({"paper", "best"}))
      ->type_name("NAME")
      ->group(study_group);
  command
      .add_option("--label", options.label,
                  "Speed to learn and to test against: commanded (default), corrected, shaft")
      ->type_name("NAME")
      ->group(study_group);
  command.add_option("--epochs", options.epochs, "Epochs a training (default 40)")
      ->check(CLI::Range(1, 10'000))
      ->type_name("N")
      ->group(study_group);
  command
      .add_option(
          "--history", options.history,
          "Valid frames in a row before a window's end, the same for all Nf (default: the largest Nf)")
      ->check(CLI::Range(2, 1'000))
      ->type_name("N")
      ->group(study_group);
}

/// Which of its jobs this program does, and what it draws.
void add_job_words(CLI::App& command, EvaluateOptions& options) {
  command.add_option("--jobs", options.workers, "Trainings side by side (default: one a core)")
      ->check(CLI::Range(1, 1'024))
      ->type_name("N")
      ->group(study_group);
  command
      .add_option("--draw", options.draw,
                  "Draw the report of this folder's results again, without training anything")
      ->type_name("DIR")
      ->group(study_group);
  command
      .add_flag("--require-complete", options.require_complete,
                "With --study and --draw DIR: refuse to draw unless each job of the study has its result")
      ->group(study_group);
  command
      .add_flag("--list-jobs", options.list_jobs,
                "With --study: only list the jobs, a line each: its id, and done or open")
      ->group(study_group);
  command.add_option("--job", options.job, "With --study: only run this job, and draw no report")
      ->type_name("ID")
      ->group(study_group);
  command
      .add_option(
          "--shard", options.shard,
          "With --study: only run every N-th job from the I-th on (I from 1 to N), and draw no report")
      ->type_name("I/N")
      ->group(study_group);
  command
      .add_flag("--baselines", options.baselines,
                "With --study: compute the rows that need no training in the results in DIR again, from "
                "the sessions that they are of")
      ->group(study_group);
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
      *root.add_subcommand("evaluate", "Evaluate a model on sessions, or run the study of the paper");
  command.add_option(
      "PATH", options.paths,
      "Model file, then session files (.h5) or folders that hold them; with --study and --live only these");
  command.add_option("-o,--output", options.output, "Folder of reports, and of a study's results")
      ->type_name("DIR");
  command.add_flag("--live", options.live,
                   "The figures of a live run's screen from its session, and with the finalised labels");
  command.add_flag(
      "--bound", options.bound,
      "Beside the errors of a model and of all estimators what the images of each window tell at "
      "best (Cramer-Rao bound)");
  command
      .add_option("--turned", options.turned,
                  "8: the model's mean over each window's eight turns; 1 (default): the window alone")
      ->check(CLI::IsMember({1, 8}))
      ->type_name("N");
  command.add_flag("--accept-bad", options.accept_bad,
                   "Take bad sessions; without it those of a folder are left out");
  add_json(command, options.json);
  add_frame_memory(command, options.frame_memory, "Options");
  add_study_words(command, options);
  add_job_words(command, options);
  command.footer(
      "Examples:\n"
      "  thermorig evaluate model.onnx recordings/garden -o report\n"
      "  thermorig evaluate --live recordings/garden\n"
      "  thermorig evaluate --study recordings -o study\n"
      "  thermorig evaluate --study recordings -o study --shard 1/8\n"
      "  thermorig evaluate --draw study");
  command.callback([&options] { take_model(options); });
}

}  // namespace thermorig::app

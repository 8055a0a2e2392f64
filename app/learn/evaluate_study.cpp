// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <thread>

#include "evaluate_parts.h"
#include "evaluate_study_text.h"
#include "interrupts.h"
#include "print/output.h"
#include "report_files.h"
#include "session_data.h"
#include "study_progress.h"
#include "thermorig/learning/report/report.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

/// The paper's reference setting where it is part of the study, else the first that is.
int reference_of(const std::vector<int>& values, int usual) {
  const bool there = std::find(values.begin(), values.end(), usual) != values.end();
  return there || values.empty() ? usual : values.front();
}

study::StudyConfig config_of(const EvaluateOptions& options) {
  study::StudyConfig config;
  config.environment = options.environment;
  config.frames = options.frames;
  config.reductions = options.reductions;
  config.reference_frames = reference_of(options.frames, config.reference_frames);
  config.reference_reduction = reference_of(options.reductions, config.reference_reduction);
  config.seeds = options.seeds;
  config.reference_seeds = options.reference_seeds;
  config.preset = options.preset;
  config.epochs = options.epochs;
  config.history = options.history.value_or(0);
  return config;
}

int workers_of(const EvaluateOptions& options) {
  return options.workers.value_or(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
}

void announce(const EvaluateOptions& options, const std::vector<study::Job>& jobs,
              const dataset::Acquisitions& data, int workers) {
  const bool simulated = any_simulated(data.acquisitions);
  if (options.json) {
    nlohmann::json start{{"event", "start"},
                         {"jobs", jobs.size()},
                         {"epochs", options.epochs},
                         {"preset", options.preset},
                         {"label", name_of(jobs.front().label)},
                         {"history", jobs.front().history},
                         {"acquisitions", data.acquisitions.size()},
                         {"data_hash", jobs.front().data_hash},
                         {"workers", workers},
                         {"simulated", simulated}};
    add_choice_to(start, data);
    print_json(start);
    return;
  }
  print("study over {}: {} trainings of {} epoch{}, preset {}, label {}, {} acquisitions{}, {} at a time\n",
        printable(options.environment), jobs.size(), options.epochs, options.epochs == 1 ? "" : "s",
        options.preset, column_of(jobs.front().label), data.acquisitions.size(),
        simulated ? " of the SIMULATED rig" : "", workers);
  flush_output();
}

bool any_simulated(const std::vector<study::JobResult>& results) {
  return std::any_of(results.begin(), results.end(),
                     [](const study::JobResult& result) { return result.simulated; });
}

void write_study_report(const fs::path& folder, const std::vector<study::JobResult>& results) {
  write_report(folder, {.markdown = report::study_markdown(results),
                        .json = report::study_json(results),
                        .html = report::study_html(results)});
}

void conclude(const fs::path& folder, const std::vector<study::JobResult>& results, bool json) {
  write_study_report(folder, results);
  if (json)
    print_json({{"event", "summary"},
                {"exit_code", 0},
                {"results", results.size()},
                {"simulated", any_simulated(results)},
                {"report", (folder / "report.html").string()}});
  else
    print("{}\nreport: {}\n", study_text(results), printable((folder / "report.html").string()));
}

ExitCode tell_interrupted(const fs::path& folder, std::size_t done, std::size_t all, bool json) {
  if (json)
    print_json({{"event", "summary"},
                {"exit_code", static_cast<int>(ExitCode::interrupted)},
                {"results", done},
                {"jobs", all}});
  else
    print(
        "stopped: {} of {} jobs are done. The same command goes on; thermorig evaluate --draw {} draws "
        "what there is.\n",
        done, all, printable(folder.string()));
  return ExitCode::interrupted;
}

void require_results_folder(const EvaluateOptions& options) {
  if (options.output.empty())
    throw Error(ExitCode::bad_usage, "a study needs a folder for its results", "", "-o study");
}

}  // namespace

ExitCode run_study(const EvaluateOptions& options) {
  require_results_folder(options);
  const dataset::Acquisitions data = read_data(session_options(options));
  const std::vector<network::Acquisition>& acquisitions = data.acquisitions;
  const std::vector<study::Job> jobs = study::jobs_of(config_of(options), acquisitions);
  const fs::path folder = options.output / "results";
  const int workers = workers_of(options);
  announce(options, jobs, data, workers);
  watch_interrupts();
  StudyProgress progress(options.json);
  const bool finished = study::run_jobs(jobs, acquisitions, folder, workers, progress.observer(interrupted));
  progress.end();
  const std::vector<study::JobResult> results = study::results_of(jobs, folder);
  if (!finished) return tell_interrupted(options.output, results.size(), jobs.size(), options.json);
  conclude(options.output, results, options.json);
  return ExitCode::ok;
}

ExitCode draw_study(const EvaluateOptions& options) {
  const bool nested = fs::is_directory(*options.draw / "results");
  const std::vector<study::JobResult> results =
      study::read_results(nested ? *options.draw / "results" : *options.draw);
  conclude(options.output.empty() ? *options.draw : options.output, results, options.json);
  return ExitCode::ok;
}

ExitCode renew_baselines(const EvaluateOptions& options) {
  require_results_folder(options);
  const fs::path folder = options.output / "results";
  const dataset::Acquisitions data = read_data(session_options(options));
  const study::RenewedBaselines renewed = study::renew_baselines(folder, data.acquisitions);
  if (options.json)
    print_json({{"event", "baselines"}, {"results", renewed.results}, {"changed", renewed.changed}});
  else
    print("baselines of {} results computed again, {} differ from before\n\n", renewed.results,
          renewed.changed);
  conclude(options.output, study::read_results(folder), options.json);
  return ExitCode::ok;
}

}  // namespace thermorig::app

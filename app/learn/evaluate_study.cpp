// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <string>
#include <thread>
#include <vector>

#include "evaluate_numbers.h"
#include "evaluate_parts.h"
#include "frame_memory.h"
#include "interrupts.h"
#include "plot_files.h"
#include "print/output.h"
#include "report_files.h"
#include "session_data.h"
#include "study_jobs.h"
#include "study_progress.h"
#include "thermorig/core/frame.h"
#include "thermorig/learning/report/report.h"
#include "thermorig/learning/study/shard.h"
#include "thermorig/learning/study/study.h"

namespace thermorig::app {

namespace {

using study::SettingSummary;

void add_network(Table& table, const SettingSummary& summary) {
  const std::string_view own = summary.fusion ? study::fusion_name : study::thermal_name;
  table.add({std::to_string(summary.frames), std::to_string(summary.reduction), std::string(own),
             summary.preset, std::to_string(summary.seed), std::to_string(summary.folds),
             mse_text(summary.mse[own].median), mse_text(summary.mse[own].iqr),
             rate_text(summary.rmse_dps[own]), summary.fusion ? gain_text(summary.gain.mean) : "-"});
}

/// What needs no training, on the windows of one setting.
void add_baselines(Table& table, const SettingSummary& summary) {
  for (const std::string& name : study::baselines())
    table.add({std::to_string(summary.frames), "-", name, "-", "-", std::to_string(summary.folds),
               mse_text(summary.mse[name].median), mse_text(summary.mse[name].iqr),
               rate_text(summary.rmse_dps[name]), "-"});
}

bool has_simulated(const std::vector<study::JobResult>& results) {
  return std::any_of(results.begin(), results.end(),
                     [](const study::JobResult& result) { return result.simulated; });
}

/// The study's medians for the terminal.
std::string study_text(const std::vector<study::JobResult>& results) {
  Table table({">Nf", ">Nr", "estimator", "preset", ">seed", ">folds", ">MSE", ">IQR", ">RMSE", ">Kg"});
  const std::vector<SettingSummary> summaries = study::summarise(results);
  for (std::size_t i = 0; i < summaries.size(); ++i) {
    add_network(table, summaries[i]);
    const bool ends_frames = i + 1 == summaries.size() || summaries[i + 1].frames != summaries[i].frames;
    if (ends_frames) add_baselines(table, summaries[i]);
  }
  std::string text = table.text() + "MSE: median of the folds; RMSE: its root, deg/s\n";
  if (study::mixes_instruction_sets(results))
    text += fmt::format("computed with {}, which round differently\n",
                        printable(study::instruction_sets_of(results)));
  if (has_simulated(results)) text += "SIMULATED rig: trends only; do not compare with real recordings.\n";
  return text;
}

namespace fs = std::filesystem;

int workers_of(const EvaluateOptions& options) {
  return options.workers.value_or(static_cast<int>(std::max(1U, std::thread::hardware_concurrency())));
}

/// Each job that runs has a copy of the pixels, and at most as much again of frames that are prepared.
std::uint64_t bytes_beside_a_frame(int workers) {
  return static_cast<std::uint64_t>(workers) * 2 * frame_pixels * sizeof(float);
}

/// All jobs of a study, and those of them that are to be run now.
struct StudyJobs {
  std::vector<study::Job> all, chosen;
  bool is_part() const { return chosen.size() < all.size(); }
};

StudyJobs study_jobs(const EvaluateOptions& options, const std::vector<network::Acquisition>& acquisitions) {
  StudyJobs jobs{.all = jobs_of_study(options, acquisitions)};
  if (options.job)
    jobs.chosen = {study::job_of_id(jobs.all, *options.job)};
  else if (options.shard)
    jobs.chosen = study::jobs_of(study::shard_from(*options.shard), jobs.all);
  else
    jobs.chosen = jobs.all;
  return jobs;
}

/// What these jobs are tested on.
dataset::IsWanted tested_by(std::vector<study::Job> jobs) {
  return [jobs = std::move(jobs)](const network::Acquisition& acquisition) {
    return std::ranges::any_of(jobs, [&](const study::Job& job) { return is_test_of(job, acquisition); });
  };
}

std::vector<study::Job> with_result(const fs::path& folder) {
  std::vector<study::Job> jobs;
  for (const study::JobResult& result : study::read_results(folder)) jobs.push_back(result.job);
  return jobs;
}

void announce(const EvaluateOptions& options, const StudyJobs& jobs, const dataset::Acquisitions& data,
              const FrameMemory& memory, int workers) {
  const bool simulated = any_simulated(data.acquisitions);
  if (options.json) {
    nlohmann::json start{{"event", "start"},
                         {"jobs", jobs.chosen.size()},
                         {"jobs_of_study", jobs.all.size()},
                         {"epochs", options.epochs},
                         {"preset", options.preset},
                         {"label", name_of(jobs.all.front().label)},
                         {"history", jobs.all.front().history},
                         {"acquisitions", data.acquisitions.size()},
                         {"data_hash", jobs.all.front().data_hash},
                         {"workers", workers},
                         {"simulated", simulated}};
    memory.add_to(start);
    add_choice_to(start, data);
    print_json(start);
    return;
  }
  print("study over {}: {}{} trainings of {} epoch{}, preset {}, label {}, {} acquisitions{}, {} at a time\n",
        printable(options.environment), jobs.is_part() ? fmt::format("{} of ", jobs.chosen.size()) : "",
        jobs.all.size(), options.epochs, options.epochs == 1 ? "" : "s", options.preset,
        column_of(jobs.all.front().label), data.acquisitions.size(), simulated ? " of the SIMULATED rig" : "",
        workers);
  print("{}\n", memory.text());
  flush_output();
}

void write_study_report(const fs::path& folder, const std::vector<study::JobResult>& results) {
  write_report(folder, {.markdown = report::study_markdown(results),
                        .json = report::study_json(results),
                        .html = report::study_html(results)});
}

void conclude(const EvaluateOptions& options, const fs::path& folder,
              const std::vector<study::JobResult>& results) {
  write_study_report(folder, results);
  if (!options.plots.empty()) write_plots(options.plots, report::study_plots(results));
  if (options.json)
    print_json({{"event", "summary"},
                {"exit_code", 0},
                {"results", results.size()},
                {"simulated", has_simulated(results)},
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
        done, all, printable(shell_word(folder.string())));
  return ExitCode::interrupted;
}

/// A part of a study draws nothing: other parts may still run.
ExitCode conclude_part(const EvaluateOptions& options, std::size_t done) {
  if (options.json)
    print_json({{"event", "summary"}, {"exit_code", 0}, {"results", done}, {"jobs", done}});
  else
    print("{} of {} jobs are done. When all parts are: thermorig evaluate --draw {}\n", done, done,
          printable(shell_word(options.output.string())));
  return ExitCode::ok;
}

/// A folder of a study keeps its results in one of its own.
fs::path results_folder_of(const fs::path& drawn) {
  return fs::is_directory(drawn / "results") ? drawn / "results" : drawn;
}

const fs::path& report_folder_of(const EvaluateOptions& options) {
  return options.output.empty() ? *options.draw : options.output;
}

}  // namespace

ExitCode run_study(const EvaluateOptions& options) {
  require_results_folder(options);
  const fs::path folder = options.output / "results";
  if (options.shard) study::shard_from(*options.shard);  // both refuse before sessions are read
  study::require_label(session_options(options).label, folder);
  const int workers = workers_of(options);
  FrameMemory memory(options.frame_memory, options.output);
  dataset::Acquisitions data = memory.read(session_options(options), bytes_beside_a_frame(workers));
  const StudyJobs jobs = study_jobs(options, data.acquisitions);
  announce(options, jobs, data, memory, workers);
  memory.run_estimators(data, options.json, tested_by(study::without_result(jobs.chosen, folder)));
  watch_interrupts();
  StudyProgress progress(options.json);
  const bool finished =
      study::run_jobs(jobs.chosen, data.acquisitions, folder, workers, progress.observer(interrupted));
  progress.end();
  const std::vector<study::JobResult> results = study::results_of(jobs.chosen, folder);
  if (!finished) return tell_interrupted(options.output, results.size(), jobs.chosen.size(), options.json);
  if (options.job || options.shard) return conclude_part(options, results.size());
  conclude(options, options.output, results);
  return ExitCode::ok;
}

ExitCode draw_study(const EvaluateOptions& options) {
  conclude(options, report_folder_of(options), study::read_results(results_folder_of(*options.draw)));
  return ExitCode::ok;
}

ExitCode draw_complete_study(const EvaluateOptions& options) {
  const std::vector<study::Job> jobs =
      jobs_of_study(options, read_data(session_options(options)).acquisitions);
  const fs::path folder = results_folder_of(*options.draw);
  require_complete(jobs, folder, options.json);
  conclude(options, report_folder_of(options), study::results_of(jobs, folder));
  return ExitCode::ok;
}

ExitCode renew_baselines(const EvaluateOptions& options) {
  require_results_folder(options);
  const fs::path folder = options.output / "results";
  const std::vector<study::Job> jobs = with_result(folder);  // both refuse before sessions are read
  study::require_label(session_options(options).label, folder);
  dataset::Acquisitions data = read_data(session_options(options));
  run_estimators(data, options.json, tested_by(jobs));
  const study::RenewedBaselines renewed = study::renew_baselines(folder, data.acquisitions);
  if (options.json)
    print_json({{"event", "baselines"}, {"results", renewed.results}, {"changed", renewed.changed}});
  else
    print("baselines of {} results computed again, {} differ from before\n\n", renewed.results,
          renewed.changed);
  conclude(options, options.output, study::read_results(folder));
  return ExitCode::ok;
}

}  // namespace thermorig::app

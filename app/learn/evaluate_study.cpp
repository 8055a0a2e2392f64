// SPDX-License-Identifier: MIT
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <functional>
#include <set>
#include <string>
#include <thread>
#include <vector>

#include "evaluate_numbers.h"
#include "evaluate_parts.h"
#include "frame_memory.h"
#include "interrupts.h"
#include "options.h"
#include "plot_files.h"
#include "print/output.h"
#include "print/terminal_width.h"
#include "report_files.h"
#include "session_data.h"
#include "thermorig/core/frame.h"
#include "thermorig/learning/report/report.h"
#include "thermorig/learning/study/shard.h"
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

void print_state(const study::Job& job, bool done, bool json) {
  const char* const state = done ? "done" : "open";
  if (json)
    print_json({{"event", "listed"},
                {"id", study::id_of(job)},
                {"job", study::description_of(job)},
                {"state", state}});
  else
    write_to(stdout, fmt::format("{}  {}\n", study::id_of(job), state));  // for programs, too: never folded
}

/// The jobs of the study that the options describe. Throws Error(bad_usage) as study::jobs_of() does.
std::vector<study::Job> jobs_of_study(const EvaluateOptions& options,
                                      const std::vector<network::Acquisition>& acquisitions) {
  return study::jobs_of(config_of(options), acquisitions);
}

/// Throws Error(bad_usage) where no folder is named that a study keeps its results in.
void require_results_folder(const EvaluateOptions& options) {
  if (options.output.empty())
    throw Error(ExitCode::bad_usage, "a study needs a folder for its results", "", "-o study");
}

/// Lists the jobs that have no result. Throws Error(check_failed) if there are any.
void require_complete(const std::vector<study::Job>& jobs, const fs::path& folder, bool json) {
  const std::vector<study::Job> open = study::without_result(jobs, folder);
  if (open.empty()) return;
  for (const study::Job& job : open) print_state(job, false, json);
  flush_output();
  throw Error(ExitCode::check_failed,
              fmt::format("{} of the study's {} results are missing", open.size(), jobs.size()),
              folder.string(), "run the study again: it goes on with what is missing");
}

/// Shows a study while it runs: on a terminal one line that is drawn over after every epoch, elsewhere a line
/// a finished job, with `json` an object a finished job.
class StudyProgress {
 public:
  explicit StudyProgress(bool json);

  /// Must not outlive this. `stop` is handed on.
  study::RunObserver observer(std::function<bool()> stop);

  /// Clears the line that is drawn over.
  void end();

 private:
  void started(const study::Progress& progress);
  void epoch_done(const study::Progress& progress);
  void job_done(const study::Progress& progress);

  bool json_;
  bool line_;
};

std::string eta_text(const study::Progress& progress) {
  return std::isnan(progress.eta_s) ? "" : ", " + duration_text(progress.eta_s) + " left";
}

std::string standing_text(const study::Progress& progress) {
  return fmt::format("{} of {} jobs, {:.0f} %, {}{}", progress.done, progress.all,
                     std::floor(100.0 * progress.share), duration_text(progress.elapsed_s),
                     eta_text(progress));
}

StudyProgress::StudyProgress(bool json) : json_(json), line_(!json && escapes_allowed(stdout)) {}

study::RunObserver StudyProgress::observer(std::function<bool()> stop) {
  study::RunObserver observer;
  observer.started = [this](const study::Progress& progress) { started(progress); };
  observer.epoch_done = [this](const study::Progress& progress) { epoch_done(progress); };
  observer.job_done = [this](const study::Progress& progress) { job_done(progress); };
  observer.stop = std::move(stop);
  return observer;
}

void StudyProgress::started(const study::Progress& progress) {
  if (progress.reused == 0) return;
  if (json_)
    print_json({{"event", "reused"}, {"jobs", progress.reused}});
  else
    print("{} of {} jobs were done before\n", progress.reused, progress.all);
  flush_output();
}

void StudyProgress::epoch_done(const study::Progress& progress) {
  if (!line_) return;
  write_to(stdout, drawn_over(standing_text(progress) + "; " + printable(progress.last)));
  flush_output();
}

void StudyProgress::job_done(const study::Progress& progress) {
  if (line_) return epoch_done(progress);
  if (json_)
    print_json({{"event", "job"},
                {"job", progress.last},
                {"done", progress.done},
                {"jobs", progress.all},
                {"share", progress.share},
                {"elapsed_s", progress.elapsed_s},
                {"eta_s", progress.eta_s}});
  else
    print("{}; {}\n", standing_text(progress), printable(progress.last));
  flush_output();
}

void StudyProgress::end() {
  if (line_) write_to(stdout, drawn_over(""));
}

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
  jobs.chosen = options.shard ? study::jobs_of(study::shard_from(*options.shard), jobs.all) : jobs.all;
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
  if (options.shard) return conclude_part(options, results.size());
  conclude(options, options.output, results);
  return ExitCode::ok;
}

ExitCode list_jobs(const EvaluateOptions& options) {
  require_results_folder(options);
  SessionOptions sessions = session_options(options);
  sessions.json = true;  // lines are for programs, and for nothing but jobs
  const std::vector<study::Job> jobs = jobs_of_study(options, read_data(sessions).acquisitions);
  const std::vector<study::Job> open = study::without_result(jobs, options.output / "results");
  const std::set<study::Job> left(open.begin(), open.end());
  for (const study::Job& job : jobs) print_state(job, !left.contains(job), options.json);
  if (options.json)
    print_json(
        {{"event", "summary"}, {"exit_code", 0}, {"done", jobs.size() - left.size()}, {"open", left.size()}});
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

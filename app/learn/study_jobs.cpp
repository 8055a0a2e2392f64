// SPDX-License-Identifier: MIT
#include "study_jobs.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <nlohmann/json.hpp>

#include "evaluate_parts.h"
#include "print/output.h"
#include "session_data.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;
using study::JobState;

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

const char* name_of(JobState state) {
  constexpr std::array<const char*, 3> names{"open", "claimed", "done"};
  return names[static_cast<std::size_t>(state)];
}

nlohmann::json json_of(const study::Job& job, const study::JobStanding& standing) {
  nlohmann::json line{{"event", "listed"},
                      {"id", study::id_of(job)},
                      {"job", study::description_of(job)},
                      {"state", name_of(standing.state)}};
  if (const auto& holder = standing.claim.holder)
    line["holder"] = {
        {"host", holder->host}, {"process", holder->number}, {"since", standing.claim.since_utc}};
  return line;
}

void print_standing(const study::Job& job, const study::JobStanding& standing, bool json) {
  if (json) return print_json(json_of(job, standing));
  const bool claimed = standing.state == JobState::claimed;
  print("{}  {}{}\n", study::id_of(job), name_of(standing.state),
        claimed ? "  " + printable(files::text_of(standing.claim)) : "");
}

std::size_t count_of(const std::vector<study::JobStanding>& standings, JobState state) {
  return static_cast<std::size_t>(std::ranges::count(
      standings, state, [](const study::JobStanding& standing) { return standing.state; }));
}

}  // namespace

std::vector<study::Job> jobs_of_study(const EvaluateOptions& options,
                                      const std::vector<network::Acquisition>& acquisitions) {
  return study::jobs_of(config_of(options), acquisitions);
}

void require_results_folder(const EvaluateOptions& options) {
  if (options.output.empty())
    throw Error(ExitCode::bad_usage, "a study needs a folder for its results", "", "-o study");
}

void require_complete(const std::vector<study::Job>& jobs, const fs::path& folder, bool json) {
  const std::vector<study::JobStanding> standings = study::standings_of(jobs, folder);
  const std::size_t done = count_of(standings, JobState::done);
  if (done == jobs.size()) return;
  for (std::size_t i = 0; i < jobs.size(); ++i)
    if (standings[i].state != JobState::done) print_standing(jobs[i], standings[i], json);
  flush_output();
  throw Error(ExitCode::check_failed,
              fmt::format("{} of the study's {} results are missing, {} of them claimed", jobs.size() - done,
                          jobs.size(), count_of(standings, JobState::claimed)),
              folder.string(), "run the study again: it goes on with what is missing");
}

ExitCode list_jobs(const EvaluateOptions& options) {
  require_results_folder(options);
  SessionOptions sessions = session_options(options);
  sessions.json = true;  // lines are for programs, and for nothing but jobs
  const std::vector<study::Job> jobs = jobs_of_study(options, read_data(sessions).acquisitions);
  const std::vector<study::JobStanding> standings = study::standings_of(jobs, options.output / "results");
  for (std::size_t i = 0; i < jobs.size(); ++i) print_standing(jobs[i], standings[i], options.json);
  if (options.json)
    print_json({{"event", "summary"},
                {"exit_code", 0},
                {"done", count_of(standings, JobState::done)},
                {"claimed", count_of(standings, JobState::claimed)},
                {"open", count_of(standings, JobState::open)}});
  return ExitCode::ok;
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include "study_progress.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "print/output.h"
#include "print/terminal_width.h"

namespace thermorig::app {

namespace {

std::string eta_text(const study::Progress& progress) {
  return std::isnan(progress.eta_s) ? "" : ", " + duration_text(progress.eta_s) + " left";
}

std::string standing_text(const study::Progress& progress) {
  return fmt::format("{} of {} jobs, {:.0f} %, {}{}", progress.done, progress.all,
                     std::floor(100.0 * progress.share), duration_text(progress.elapsed_s),
                     eta_text(progress));
}

}  // namespace

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

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include "recorder.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <memory>
#include <vector>

#include "live/live_facts.h"
#include "live/live_page.h"
#include "live/live_run.h"
#include "live/page_address.h"
#include "options.h"
#include "print/output.h"
#include "print/simulation_text.h"
#include "progress_output.h"
#include "recording_setup.h"
#include "run_recording.h"
#include "thermorig/io/host.h"
#include "thermorig/io/port.h"
#include "thermorig/rig/recording/recording.h"
#include "thermorig/rig/recording/session_file.h"
#include "thermorig/simulation/simulated_ports/simulated_ports.h"
#include "thermorig/storage/recording_header/header_json.h"

namespace thermorig::app {

namespace {

/// The page of `record`: the same as that of `live`, gyro against servo, and nothing of it is kept.
class RecordPage {
 public:
  /// Starts the server, says where it is, and watches `recording`.
  RecordPage(const RecordOptions& options, rig::RecordingOptions& recording);

  void progress(const rig::RecordingProgress& progress) { run_.progress(progress); }
  std::vector<rig::Order> take_orders() { return orders_of(run_, &page_); }
  void ended(const LiveEnd& end) { run_.ended(end); }

 private:
  LivePage page_;
  LiveRun run_;
};

RecordPage::RecordPage(const RecordOptions& options, rig::RecordingOptions& recording)
    : page_(options.page),
      run_(live_facts(LiveMode::record, options, recording), ChosenModel{},
           estimators::Bank({}, {}, recording.profile)) {
  run_.add(page_);
  tell_page(page_.server(), options.json);
  recording.wait_for_start = options.page.control;
  recording.begun = [this](const RecordingHeader& header) { run_.begun(header); };
  recording.observe = [this](const Measurement& measurement, HostTime arrived) {
    run_.observe(measurement, arrived);
    return std::optional<EstimateRow>();
  };
}

void announce(const rig::RecordingOptions& recording, bool json) {
  const rig::SweepPlan& plan = recording.plan;
  const double duration_s =
      rig::plan_duration_s(plan, recording.profile.servo, recording.profile.camera.output_rate_hz);
  if (json) {
    print_json({{"event", "start"},
                {"environment", recording.environment},
                {"plan", plan.name},
                {"legs", plan.leg_rates_dps.size()},
                {"frames_per_leg", plan.frames_per_leg},
                {"expected_s", duration_s},
                {"simulated", recording.simulated},
                {"simulation", recording.simulation}});
    return;
  }
  const std::string legs =
      !recording.profile.servo.is_there() ? std::string("turned by hand")
      : plan.leg_rates_dps.empty()
          ? std::string("a rest")
          : fmt::format("{} legs of {} frames", plan.leg_rates_dps.size(), plan.frames_per_leg);
  print("recording {}, plan {}: {}, {}\n", recording.environment, printable(plan.name), legs,
        plan.ends_by_stop() ? "until Ctrl-C" : "about " + duration_text(duration_s));
  if (recording.simulated) print("{}", simulated_line(recording.simulation_seed, recording.simulation));
  flush_output();
}

/// Share of one core that the recording thread used between the first and the last look at it: without
/// opening and without finalising.
class CpuShare {
 public:
  void look() {
    const HostTime now = io::now();
    const double cpu_s = io::thread_cpu_s();
    if (!begin_) begin_ = {now, cpu_s};
    end_ = {now, cpu_s};
  }
  std::optional<double> share() const {
    if (!begin_ || end_.time <= begin_->time) return std::nullopt;
    return (end_.cpu_s - begin_->cpu_s) / to_s(end_.time - begin_->time);
  }

 private:
  struct Look {
    HostTime time{};
    double cpu_s = 0;
  };
  std::optional<Look> begin_;
  Look end_;
};

void require_line(const char* option, const std::string& text, const char* advice) {
  if (text.empty() || recording_header::is_line(text)) return;
  throw Error(ExitCode::bad_usage, fmt::format("{} is not a line of up to 1000 bytes of UTF-8", option), "",
              advice);
}

}  // namespace

void check_recording_words(const RecordOptions& options) {
  rig::check_environment(options.environment);
  require_line("--licence", options.licence, "name the licence: --licence CC-BY-4.0");
  require_line("--operator", options.operator_name, "a name is enough");
  require_line("--place", options.place, "where the rig stands, e.g. --place 'room 2.11, window'");
  require_line("--note", options.note, "one sentence; more with thermorig annotate");
  if (options.fast && !options.rig.simulated_seed)
    throw Error(ExitCode::bad_usage, "--fast is virtual time, which only the simulated rig has", "",
                "--simulated=4 --fast, or leave --fast out");
  if (options.fast && options.page.serve)
    throw Error(ExitCode::bad_usage, "virtual time is too fast for a page", "",
                "leave --fast out, or --page");
  if (options.page.control && !options.page.serve)
    throw Error(ExitCode::bad_usage, "--control lets a page start motion, and no page is served", "",
                "--page --control, or leave --control out");
}

RecordSummary record_session(const RecordOptions& options, const ChosenRig& rig, const rig::SweepPlan& plan) {
  rig::RecordingOptions recording = recording_options(options, rig, plan);
  RecordSummary summary;
  summary.plan = plan;
  const HostTime begin = io::now();
  const auto ports = switch_on(options, rig, recording);  // outlives the recording
  announce(recording, options.json);
  const ProgressStyle style = progress_style(options.json);
  OutputWriter output(progress_output_options(style, options.fast));
  {
    const std::unique_ptr<ProgressOutput> shown = make_progress_output(output, style);
    CpuShare cpu;
    const std::unique_ptr<RecordPage> page =
        options.page.serve ? std::make_unique<RecordPage>(options, recording) : nullptr;
    rig::PortOptions run;
    run.recording = std::move(recording);
    run.progress = [&](const rig::RecordingProgress& progress) {
      cpu.look();
      shown->show(progress);
      if (page) page->progress(progress);
    };
    if (options.fast) run.progress_period = std::chrono::seconds(1);
    if (page) run.orders = [&] { return page->take_orders(); };
    run.notice = [&](const std::string& sentence) { shown->note(sentence); };
    const auto drive = [&] { return run_recording(rig, options.fast, run); };
    summary.result = page ? told(*page, drive) : drive();
    if (!options.fast) summary.cpu_share = cpu.share();
  }
  output.finish();
  summary.unwritten = output.failure(summary.result.exit);
  summary.wall_s = to_s(io::now() - begin);
  return summary;
}

}  // namespace thermorig::app

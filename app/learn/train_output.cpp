// SPDX-License-Identifier: MIT
#include "train_output.h"

#include <fmt/format.h>

#include <cstdio>
#include <nlohmann/json.hpp>

#include "print/number_json.h"
#include "print/output.h"
#include "print/terminal_width.h"
#include "session_data.h"
#include "train_text.h"

namespace thermorig::app {

namespace {

using training::TrainingConfig;

/// Lines that stay; what is drawn over is for terminals.
class PlainTrainOutput : public TrainOutput {
 public:
  explicit PlainTrainOutput(const TrainingConfig& config) : config_(config) {}

  void start(const TrainStart& start) override { print(start_text(start)); }
  void step(const TrainStanding&) override {}
  void epoch(const training::EpochReport& report, const TrainStanding& standing) override {
    print(epoch_text(report, config_,
                     report.epoch < config_.epochs ? duration_text(seconds_left(standing, config_)) : ""));
  }
  void end(const TrainEnd& end) override { print(end_text(end)); }

 protected:
  const TrainingConfig& config() const { return config_; }
  static void print(const std::string& text) {
    write_to(stdout, folded(text));
    flush_output();
  }

 private:
  const TrainingConfig& config_;
};

class TerminalTrainOutput final : public PlainTrainOutput {
 public:
  using PlainTrainOutput::PlainTrainOutput;
  ~TerminalTrainOutput() override { print(drawn_over("")); }
  TerminalTrainOutput(const TerminalTrainOutput&) = delete;
  TerminalTrainOutput& operator=(const TerminalTrainOutput&) = delete;

  void step(const TrainStanding& standing) override { print(drawn_over(standing_text(standing, config()))); }
  void epoch(const training::EpochReport& report, const TrainStanding&) override {
    print(drawn_over("") + epoch_text(report, config()));
  }
  void end(const TrainEnd& end) override { print(drawn_over("") + end_text(end)); }
};

nlohmann::json json_of(const WindowCounts::Row& row) {
  return {{"acquisitions", row.acquisitions},
          {"simulated", row.simulated},
          {"frames", row.frames},
          {"windows", row.windows}};
}

nlohmann::json json_of(const training::Fit& fit, const TrainingConfig& config) {
  nlohmann::json object{{"windows", fit.windows},
                        {"network_mse", fit.network_mse},
                        {"network_rmse_dps", training::rmse_dps(fit.network_mse, config)},
                        {"thermal_mse", fit.thermal_mse},
                        {"thermal_rmse_dps", training::rmse_dps(fit.thermal_mse, config)},
                        {"gyro_mse", fit.gyro_mse},
                        {"gyro_rmse_dps", training::rmse_dps(fit.gyro_mse, config)}};
  if (!config.shape.fusion) return object;
  object["gain_mean"] = fit.gain_mean;
  object["gain_below_002"] = fit.gain_below_002;
  object["gain_above_098"] = fit.gain_above_098;
  object["gate_collapsed"] = training::gate_collapsed(fit.gain_mean);
  return object;
}

class JsonTrainOutput final : public TrainOutput {
 public:
  explicit JsonTrainOutput(const TrainingConfig& config) : config_(config) {}

  void start(const TrainStart& start) override {
    const WindowCounts counts = count_windows(start);
    nlohmann::json environments = nlohmann::json::object();
    for (const auto& [name, row] : counts.environments) environments[name] = json_of(row);
    nlohmann::json object{{"event", "start"},
                          {"data", json_of(counts.all)},
                          {"environments", environments},
                          {"preset", config_.preset},
                          {"label", name_of(start.label)},
                          {"frames", config_.shape.frames},
                          {"reduction", config_.shape.reduction},
                          {"fusion", config_.shape.fusion},
                          {"weights", network::weight_count(config_.shape)},
                          {"epochs", config_.epochs},
                          {"epochs_done", start.epochs_done},
                          {"batch", config_.batch},
                          {"rate", config_.adam.rate},
                          {"auxiliary_thermal", config_.loss.auxiliary_thermal},
                          {"symmetries", config_.symmetries},
                          {"window_scaling", config_.window_scaling},
                          {"likelihood", config_.loss.likelihood},
                          {"made_windows", config_.made.windows},
                          {"from", config_.from ? config_.from->name : "none"},
                          {"choose_epoch", config_.choose_epoch},
                          {"label_scale_dps", config_.label_scale_dps},
                          {"seed", config_.seed},
                          {"threads", start.threads},
                          {"instruction_set", start.instruction_set},
                          {"run_folder", start.run_folder}};
    start.memory.add_to(object);
    add_choice_to(object, start.data);
    print_json(object);
  }

  void step(const TrainStanding&) override {}

  void epoch(const training::EpochReport& report, const TrainStanding& standing) override {
    nlohmann::json object{{"event", "epoch"},
                          {"epoch", report.epoch},
                          {"loss", report.loss},
                          {"training_mse", report.training_mse},
                          {"training_rmse_dps", training::rmse_dps(report.training_mse, config_)},
                          {"held_out_mse", report.held_out_mse},
                          {"held_out_rmse_dps", training::rmse_dps(report.held_out_mse, config_)},
                          {"held_out_thermal_mse", report.held_out_thermal_mse},
                          {"kept", report.kept},
                          {"elapsed_s", standing.elapsed_s},
                          {"eta_s", seconds_left(standing, config_)}};
    object["gain_mean"] = config_.shape.fusion ? nlohmann::json(report.gain_mean) : nlohmann::json();
    print_json(object);
  }

  void end(const TrainEnd& end) override {
    nlohmann::json object{{"event", "summary"},
                          {"exit_code", static_cast<int>(end.exit)},
                          {"stopped", end.result.stopped},
                          {"epochs", end.result.epochs.size()},
                          {"epoch_kept", end.result.model.provenance.epoch_kept},
                          {"simulated", end.result.model.provenance.simulated},
                          {"seconds", end.seconds},
                          {"warnings", warnings_of(end)}};
    object["model"] = text_json(end.model);
    if (end.fits != nullptr) object["training"] = json_of(end.fits->training, config_);
    if (end.fits != nullptr && end.fits->held_out) object["held_out"] = json_of(*end.fits->held_out, config_);
    print_json(object);
  }

 private:
  const TrainingConfig& config_;
};

}  // namespace

std::unique_ptr<TrainOutput> make_train_output(const TrainingConfig& config, bool json) {
  if (json) return std::make_unique<JsonTrainOutput>(config);
  if (escapes_allowed(stdout)) return std::make_unique<TerminalTrainOutput>(config);
  return std::make_unique<PlainTrainOutput>(config);
}

}  // namespace thermorig::app

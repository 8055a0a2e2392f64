// SPDX-License-Identifier: MIT
#include "thermorig/learning/training/training.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <set>
#include <vector>

#include "batch_stream.h"
#include "epoch_plan.h"
#include "estimates.h"
#include "held_out.h"
#include "thermorig/core/error.h"
#include "thermorig/core/statistics.h"

namespace thermorig::training {

namespace {

using network::Acquisition;

constexpr std::size_t steps_between_reports = 50;

constexpr double most_rising_steps = 2000.0;
constexpr double rising_part = 0.1;     // of a short training
constexpr double share_of_begun = 0.4;  // of the rate, for weights that have learnt already
constexpr std::size_t settling_steps = 256;
constexpr double one_sigma_share = 0.683;
// Made-up rooms are harder than others: where 0.683 of the errors there lie within one sigma, 0.74 to 0.80 of
// those in simulated rooms did that the network had not seen (seeds 1301 to 1308).
constexpr double one_sigma_share_of_made_rooms = 0.62;
constexpr float first_gate_bias = -4.0F;  // sigma of 74 deg/s: the gate knows nothing yet

/// Of the rate, in the step of this number (from 0) of so many: a linear rise times half a cosine.
double rate_share(const TrainingConfig& config, double step, double steps) {
  if (!config.cosine) return 1.0;
  const double rise = std::max(1.0, std::min(most_rising_steps, rising_part * steps));
  return (config.from ? share_of_begun : 1.0) * std::min(1.0, (step + 1.0) / rise) * 0.5 *
         (1.0 + std::cos(std::numbers::pi * step / steps));
}

network::TrainerConfig trainer_config(const TrainingConfig& config) {
  network::TrainerConfig trainer{.loss = config.loss, .adam = config.adam};
  if (!config.shape.fusion) trainer.loss.auxiliary_thermal = 0.0F;  // y_th is all there is: nothing to help
  return trainer;
}

/// Licences of the data, each once.
std::string licence_of(std::span<const Acquisition> acquisitions) {
  if (acquisitions.empty()) return "none: made-up rooms";
  std::set<std::string> licences;
  for (const Acquisition& acquisition : acquisitions) licences.insert(acquisition.licence);
  return fmt::format("{}", fmt::join(licences, "; "));
}

/// Of all of them; none: they differ, or one does not know it.
std::optional<network::CameraView> view_of(std::span<const Acquisition> acquisitions) {
  std::optional<network::CameraView> view = acquisitions.front().view;
  for (const Acquisition& acquisition : acquisitions)
    if (!view || !acquisition.view || !view->fits(*acquisition.view)) return std::nullopt;
  return view;
}

network::Scaling scaling_for(const TrainingConfig& config, std::span<const Acquisition> acquisitions,
                             const Division& division) {
  if (!config.window_scaling)
    return network::scaling_of(acquisitions, config.label_scale_dps, division.held_out_acquisition);
  network::Scaling scaling = network::scaling_by_window(config.label_scale_dps);
  scaling.gate_states_sigma = config.loss.likelihood && config.shape.fusion;
  return scaling;
}

/// Means over the windows of an epoch, step by step.
struct EpochSums {
  double windows = 0.0, loss = 0.0, squared_error = 0.0, gain = 0.0;

  void add(const network::StepLoss& step, std::size_t size) {
    const auto share = static_cast<double>(size);
    windows += share;
    loss += share * step.loss;
    squared_error += share * step.squared_error;
    gain += share * step.gain_mean;
  }
};

class Training {
 public:
  Training(const TrainingConfig& config, std::span<const Acquisition> acquisitions, network::Workers& workers,
           const Observer& observer, const std::optional<Checkpoint>& from)
      : config_(config),
        acquisitions_(acquisitions),
        workers_(workers),
        observer_(observer),
        division_(divide(config, acquisitions)),
        scaling_(scaling_for(config, acquisitions, division_)),
        training_(acquisitions, division_.training, config.shape, scaling_),
        held_out_(acquisitions, division_.held_out, config.shape, scaling_),
        done_(from ? *from : beginning(config)),
        trainer_(done_.weights, trainer_config(config), workers) {
    if (from) trainer_.restore(from->weights, from->optimiser);
    if (config.made.windows > 0)
      made_.emplace(config.made, config.shape, config.seed, done_.optimiser.steps, workers);
  }

  TrainingResult run() {
    while (done_.epoch < config_.epochs && !stopped_) run_epoch(done_.epoch + 1);
    if (scaling_.gate_states_sigma && !stopped_) settle_gate();
    return {.model = model(), .epochs = done_.epochs, .stopped = stopped_, .windows = training_.size()};
  }

 private:
  /// The likelihood's sigma is that of normal errors, and a few windows are far off: it is too large for all
  /// the others. The gate's bias is set so that `share` of the windows of one more epoch lies within it.
  void settle_gate() {
    const EpochPlan plan = epoch_plan(training_.size(), config_.seed, config_.epochs + 1, config_.symmetries);
    BatchStream batches(training_, plan, recorded_a_batch(), workers_);
    add_made(batches);
    network::BatchEstimator estimator(done_.kept);
    std::array<network::Output, network::max_batch> outputs;
    std::vector<double> sigmas;  // that the errors are
    for (std::size_t step = 0; step < std::min(batches.batches(), settling_steps); ++step) {
      const network::Batch batch = batches.next().batch();
      estimator.estimate(batch, std::span(outputs).first(batch.label.size()));
      for (std::size_t i = 0; i < batch.label.size(); ++i)
        sigmas.push_back(std::abs(outputs[i].thermal - batch.label[i]) /
                         network::gate_sigma(outputs[i].gain, network::gate_gyro_sigma));
    }
    const double share = recorded_a_batch() == 0 ? one_sigma_share_of_made_rooms : one_sigma_share;
    const double within_one = std::clamp(upper_quantile(sigmas, share), 0.5, 2.0);
    done_.kept.tensor("gain2.bias")[0] -= static_cast<float>(2.0 * std::log(within_one));
  }

  std::size_t recorded_a_batch() const {
    return static_cast<std::size_t>(config_.batch - config_.made.windows);
  }
  void add_made(BatchStream& batches) {
    if (made_)
      batches.add_made(*made_, static_cast<std::size_t>(config_.made.windows),
                       static_cast<std::size_t>(config_.made.steps_an_epoch));
  }

  static Checkpoint beginning(const TrainingConfig& config) {
    Checkpoint start;
    if (config.from) {
      start.weights = config.from->weights;
    } else {
      start.weights = network::initial_weights(config.shape, config.seed);
      if (config.loss.likelihood && config.shape.fusion)
        start.weights.tensor("gain2.bias")[0] = first_gate_bias;
    }
    start.kept = start.weights;
    return start;
  }

  void run_epoch(int epoch) {
    const EpochPlan plan = epoch_plan(training_.size(), config_.seed, epoch, config_.symmetries);
    BatchStream batches(training_, plan, recorded_a_batch(), workers_);
    add_made(batches);
    const std::size_t steps = batches.batches();
    const auto all_steps = static_cast<double>(steps) * config_.epochs;
    const auto steps_before = static_cast<double>(steps) * (epoch - 1);
    EpochSums sums;
    for (std::size_t step = 0; step < steps; ++step) {
      const BatchBuffer& batch = batches.next();
      const network::StepLoss loss = trainer_.step(
          batch.batch(), rate_share(config_, steps_before + static_cast<double>(step), all_steps));
      require_finite(loss.loss, step + 1, epoch);
      sums.add(loss, batch.size());
      if (observer_.step && ((step + 1) % steps_between_reports == 0 || step + 1 == steps))
        observer_.step(step + 1, steps, epoch, sums.loss / sums.windows);
      stopped_ = observer_.stop && observer_.stop();
      if (stopped_) return;
    }
    end_epoch(epoch, sums);
  }

  void end_epoch(int epoch, const EpochSums& sums) {
    done_.epoch = epoch;
    done_.weights = trainer_.weights();
    done_.optimiser = trainer_.optimiser();
    require_finite_weights(epoch);
    const SquaredErrors held_out = squared_errors(done_.weights, held_out_);
    EpochReport report{.epoch = epoch,
                       .loss = sums.loss / sums.windows,
                       .training_mse = sums.squared_error / sums.windows,
                       .held_out_mse = held_out.fusion,
                       .held_out_thermal_mse = held_out.thermal,
                       .gain_mean = sums.gain / sums.windows};
    report.kept = !config_.choose_epoch || held_out_score(report, config_) < kept_score();
    done_.epochs.push_back(report);
    if (report.kept) {
      done_.kept = done_.weights;
      done_.epoch_kept = epoch;
    }
    if (observer_.epoch) observer_.epoch(report, done_);
  }

  double kept_score() const {
    if (done_.epoch_kept == 0) return std::numeric_limits<double>::infinity();
    return held_out_score(done_.epochs[static_cast<std::size_t>(done_.epoch_kept) - 1], config_);
  }

  void require_finite(double loss, std::size_t step, int epoch) const {
    if (std::isfinite(loss)) return;
    throw Error(ExitCode::failed,
                fmt::format("the loss is not a number any more, at step {} of epoch {}", step, epoch),
                "training", fmt::format("a smaller learning rate: --rate {:.2g}", config_.adam.rate / 10));
  }

  void require_finite_weights(int epoch) const {
    const bool good = std::all_of(done_.weights.values.begin(), done_.weights.values.end(),
                                  [](float value) { return std::isfinite(value); });
    if (!good) require_finite(std::numeric_limits<double>::quiet_NaN(), training_.size(), epoch);
  }

  model::Model model() const {
    model::Provenance provenance{.preset = config_.preset,
                                 .seed = config_.seed,
                                 .epochs = done_.epoch,
                                 .epoch_kept = done_.epoch_kept,
                                 .data_licence = licence_of(acquisitions_),
                                 .label = Label::shaft};
    if (config_.made.windows > 0) {
      provenance.view = config_.made.view;
      provenance.simulated = true;
      provenance.made_windows = trainer_.optimiser().steps * static_cast<std::uint64_t>(config_.made.windows);
    }
    if (config_.from) provenance.begun_from = config_.from->name;
    if (!acquisitions_.empty()) {
      provenance.label = acquisitions_.front().label;
      provenance.view = view_of(acquisitions_);
    }
    for (std::size_t index = 0; index < acquisitions_.size(); ++index) {
      const Acquisition& acquisition = acquisitions_[index];
      const bool chooses = division_.held_out_acquisition == static_cast<std::uint32_t>(index);
      (chooses ? provenance.held_out : provenance.training).push_back({acquisition.name, acquisition.hash});
      provenance.simulated = provenance.simulated || acquisition.simulated;
    }
    return {.weights = done_.kept, .scaling = scaling_, .provenance = provenance};
  }

  const TrainingConfig& config_;
  std::span<const Acquisition> acquisitions_;
  network::Workers& workers_;
  const Observer& observer_;
  Division division_;
  network::Scaling scaling_;
  WindowSet training_, held_out_;
  Checkpoint done_;
  network::Trainer trainer_;
  std::optional<MadeWindows> made_;
  bool stopped_ = false;
};

}  // namespace

double held_out_score(const EpochReport& report, const TrainingConfig& config) {
  const double weight = trainer_config(config).loss.auxiliary_thermal;
  return report.held_out_mse + weight * report.held_out_thermal_mse;
}

void check_data(const TrainingConfig& config, std::span<const Acquisition> acquisitions) {
  divide(config, acquisitions);
}

TrainingResult train(const TrainingConfig& config, std::span<const Acquisition> acquisitions,
                     network::Workers& workers, const Observer& observer,
                     const std::optional<Checkpoint>& from) {
  check(config);
  assert(!from || (from->weights.shape == config.shape && from->kept.shape == config.shape));
  return Training(config, acquisitions, workers, observer, from).run();
}

}  // namespace thermorig::training

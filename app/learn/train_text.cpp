// SPDX-License-Identifier: MIT
#include "train_text.h"

#include <fmt/format.h>

#include <cmath>

#include "evaluate_numbers.h"
#include "print/output.h"
#include "thermorig/network/window_index.h"

namespace thermorig::app {

namespace {

using training::Fit;
using training::TrainingConfig;

/// "0.00512 (RMSE 14.30 deg/s)"
std::string error_text(double mse, const TrainingConfig& config) {
  return fmt::format("{} (RMSE {} deg/s)", mse_text(mse), rate_text(training::rmse_dps(mse, config)));
}

std::string symmetries_text(const TrainingConfig& config) {
  if (config.symmetries == 1) return "no mirror";
  return config.symmetries == 2 ? "mirror" : "8 symmetries";
}

std::string settings_text(const TrainingConfig& config, Label label) {
  const std::string auxiliary =
      config.loss.likelihood && config.shape.fusion ? "likelihood"
      : config.loss.auxiliary_thermal > 0 && config.shape.fusion
          ? fmt::format("auxiliary thermal loss {:g}", config.loss.auxiliary_thermal)
          : "no auxiliary loss";
  return fmt::format("{}: label {}, {} epoch{}, batch {}, rate {:g}, {}, {}, {}, {}, seed {}", config.preset,
                     column_of(label), config.epochs, config.epochs == 1 ? "" : "s", config.batch,
                     config.adam.rate, auxiliary, symmetries_text(config),
                     config.window_scaling ? "scaled by the window" : "scaled by the data set",
                     config.choose_epoch ? "epoch chosen on a held-out acquisition" : "last epoch kept",
                     config.seed);
}

std::string network_text(const TrainStart& start) {
  const network::Shape& shape = start.config.shape;
  return fmt::format("{}, Nf {}, Nr {}: {} weights; {}, {} thread{}",
                     shape.fusion ? "fusion" : "thermal-only", shape.frames, shape.reduction,
                     count_text(network::weight_count(shape)), start.instruction_set, start.threads,
                     start.threads == 1 ? "" : "s");
}

std::string simulated_text(const TrainStart& start) {
  const WindowCounts counts = count_windows(start);
  if (counts.all.simulated == 0) return "";
  if (counts.all.simulated == counts.all.acquisitions)
    return "SIMULATED data: all of it is from a simulated rig\n";
  return fmt::format("SIMULATED data: {} of {} acquisitions are from a simulated rig\n", counts.all.simulated,
                     counts.all.acquisitions);
}

std::string data_text(const TrainStart& start) {
  const WindowCounts counts = count_windows(start);
  Table table({"environment", ">acquisitions", ">frames", ">windows"});
  const auto add = [&](const std::string& name, const WindowCounts::Row& row) {
    table.add({name, count_text(row.acquisitions), count_text(row.frames), count_text(row.windows)});
  };
  for (const auto& [environment, row] : counts.environments) add(environment, row);
  if (counts.environments.size() > 1) add("all", counts.all);
  std::string text = table.text();
  if (!counts.without.empty())
    text += fmt::format("no window of {} valid frames in a row: {}\n", start.config.shape.frames,
                        printable(fmt::format("{}", fmt::join(counts.without, ", "))));
  return text;
}

std::string made_rooms_text(const TrainingConfig& config) {
  const training::MadeRooms& made = config.made;
  if (made.windows == 0) return "";
  return fmt::format("MADE-UP rooms: {} of {} windows a step, seen through {:g} degrees, {} frames\n",
                     made.windows, config.batch, made.view.width_deg,
                     made.view.half_frames ? "half" : "full");
}

std::string fit_row(const char* name, double mse, const TrainingConfig& config) {
  return fmt::format("  {:<18} MSE {}\n", name, error_text(mse, config));
}

std::string fit_text(const std::string& heading, const Fit& fit, const TrainEnd& end) {
  const TrainingConfig& config = end.config;
  std::string text = fmt::format("{} ({} windows)\n", heading, count_text(fit.windows));
  text += fit_row(config.shape.fusion ? "fusion" : "thermal-only", fit.network_mse, config);
  if (config.shape.fusion) text += fit_row("its thermal part", fit.thermal_mse, config);
  if (!end.labelled_by_gyro) text += fit_row("gyro alone", fit.gyro_mse, config);
  if (config.shape.fusion)
    text += fmt::format("  {:<18} mean {}, below 0.02 in {}, above 0.98 in {}\n", "gate Kg",
                        gain_text(fit.gain_mean), percent_text(fit.gain_below_002),
                        percent_text(fit.gain_above_098));
  return text;
}

/// The error, and where it is not all that chooses the epoch, the sum that does.
std::string held_out_text(const training::EpochReport& report, const TrainingConfig& config) {
  std::string text = "  held-out MSE " + error_text(report.held_out_mse, config);
  if (!config.shape.fusion || config.loss.auxiliary_thermal == 0) return text;
  return text + fmt::format(" + {:g} x {} of the images = {}", config.loss.auxiliary_thermal,
                            mse_text(report.held_out_thermal_mse),
                            mse_text(training::held_out_score(report, config)));
}

/// What this training has not done yet.
std::string against_collapse(const TrainingConfig& config) {
  if (config.window_scaling) return "; try: more acquisitions, or --made-rooms";
  if (config.loss.auxiliary_thermal <= 0) return "; try: --preset best, or --auxiliary-thermal 1";
  return fmt::format("; try: more acquisitions, or --auxiliary-thermal {:g}",
                     2.0 * config.loss.auxiliary_thermal);
}

/// Of a network that is worse than the gyro, or the same as far as one can tell.
std::string gyro_text(const Fit& fit) {
  const std::string gyro = mse_text(fit.gyro_mse), network = mse_text(fit.network_mse);
  if (gyro == network)
    return fmt::format("this network is as good as the gyro alone, MSE {}: try: more acquisitions", gyro);
  return fmt::format(
      "the gyro alone is better than this network: MSE {} against {}; try: more acquisitions, or use the "
      "gyro",
      gyro, network);
}

/// On which windows the network is judged: those that it did not train on, if there are any.
const Fit& judging(const training::Fits& fits) {
  return fits.held_out ? *fits.held_out : fits.training;
}

}  // namespace

WindowCounts count_windows(const TrainStart& start) {
  WindowCounts counts;
  for (const network::Acquisition& acquisition : start.data.acquisitions) {
    const std::size_t windows =
        network::find_windows({&acquisition, 1}, start.config.shape.frames, start.config.history).size();
    if (windows == 0) counts.without.push_back(acquisition.name);
    for (WindowCounts::Row* row : {&counts.environments[acquisition.environment], &counts.all}) {
      ++row->acquisitions;
      row->frames += acquisition.frames();
      row->windows += windows;
      row->simulated += acquisition.simulated ? 1 : 0;
    }
  }
  return counts;
}

std::string start_text(const TrainStart& start) {
  std::string text = start.data.acquisitions.empty() ? "" : data_text(start) + simulated_text(start);
  text += made_rooms_text(start.config);
  text += start.config.from ? fmt::format("begins with {}\n", printable(start.config.from->name))
          : start.config.window_scaling
              ? "starts from random weights: no general model fits this camera and its frames\n"
              : "";
  text += network_text(start) + "\n" + settings_text(start.config, start.label) + "\n";
  text += start.memory.text() + "\n";
  text += fmt::format("run folder {}\n", printable(start.run_folder));
  if (start.epochs_done > 0)
    text += fmt::format("going on after epoch {} of {}\n", start.epochs_done, start.config.epochs);
  return text;
}

std::string epoch_text(const training::EpochReport& report, const TrainingConfig& config,
                       const std::string& left) {
  std::string text = fmt::format("epoch {:>{}} of {}  loss {:.4f}  RMSE {} deg/s", report.epoch,
                                 fmt::formatted_size("{}", config.epochs), config.epochs, report.loss,
                                 rate_text(training::rmse_dps(report.training_mse, config)));
  if (config.shape.fusion) text += "  Kg " + gain_text(report.gain_mean);
  if (!left.empty()) text += "  " + left + " left";
  text += "\n";
  if (config.choose_epoch)
    text += held_out_text(report, config) + (report.kept ? "  lowest so far" : "") + "\n";
  return text;
}

double seconds_left(const TrainStanding& standing, const TrainingConfig& config) {
  const auto steps = static_cast<double>(standing.steps);
  const double done =
      steps * (standing.epoch - 1 - standing.epochs_before) + static_cast<double>(standing.step);
  const double all = steps * (config.epochs - standing.epochs_before);
  return standing.elapsed_s * (all - done) / done;
}

std::string standing_text(const TrainStanding& standing, const TrainingConfig& config) {
  return fmt::format(
      "epoch {} of {}, {:.0f} %, loss {:.4f}, {} left", standing.epoch, config.epochs,
      std::floor(100.0 * static_cast<double>(standing.step) / static_cast<double>(standing.steps)),
      standing.loss, duration_text(seconds_left(standing, config)));
}

std::vector<std::string> warnings_of(const TrainEnd& end) {
  std::vector<std::string> warnings;
  if (end.fits == nullptr) return warnings;
  const Fit& fit = judging(*end.fits);
  if (end.config.shape.fusion && training::gate_collapsed(fit.gain_mean))
    warnings.push_back(collapsed_text(fit.gain_mean) + against_collapse(end.config));
  if (!end.labelled_by_gyro && fit.gyro_mse < fit.network_mse) warnings.push_back(gyro_text(fit));
  return warnings;
}

std::string end_text(const TrainEnd& end) {
  std::string text;
  if (end.fits != nullptr) {
    text += fit_text("on the windows that it was trained on", end.fits->training, end);
    if (end.fits->held_out)
      text += fit_text("on the held-out acquisition, which chose the epoch", *end.fits->held_out, end);
  }
  for (const std::string& warning : warnings_of(end)) text += "warning: " + warning + "\n";
  if (end.result.stopped)
    text += fmt::format("stopped after {} of {} epochs; the same command with --resume goes on\n",
                        end.result.epochs.size(), end.config.epochs);
  if (end.model.empty()) return text + "no epoch was finished, so no model was written\n";
  return text + fmt::format("model {}, epoch {} of {}, after {}\n\nnext  thermorig evaluate {} SESSIONS\n",
                            printable(end.model), end.result.model.provenance.epoch_kept, end.config.epochs,
                            duration_text(end.seconds), printable(shell_word(end.model)));
}

}  // namespace thermorig::app

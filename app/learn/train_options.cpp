// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "learning_options.h"
#include "rig_options.h"

namespace thermorig::app {

namespace {

void add_network(CLI::App& command, TrainOptions& options) {
  add_window_shape(command, options.frames, options.reduction);
  command.add_flag("--fusion,!--thermal-only", options.fusion,
                   "With the gyro and its gate (default), or from the images alone");
}

/// A word and its opposite; nothing is set where neither is given, so that the preset decides.
void add_choice(CLI::App& command, const std::string& name, std::optional<bool>& choice,
                const std::string& meaning) {
  command.add_flag_function(
      "--" + name + ",!--no-" + name, [&choice](std::int64_t count) { choice = count > 0; }, meaning);
}

void add_settings(CLI::App& command, TrainOptions& options) {
  command
      .add_option(
          "--preset", options.preset,
          "best (default): likelihood, 8 symmetries, each window scaled by itself; paper: to the letter")
      ->check(CLI::IsMember({"best", "paper"}))
      ->type_name("NAME");
  command
      .add_option("--label", options.label,
                  "Speed to learn: commanded (default, the paper's), corrected, shaft")
      ->type_name("NAME");
  command.add_option("--epochs", options.epochs, "Times that all windows are gone through (default 40)")
      ->type_name("N");
  command.add_option("--batch", options.batch, "Windows a step, 1 to 32 (default 32)")
      ->check(CLI::Range(1, 32))
      ->type_name("N");
  command.add_option("--rate", options.rate, "Learning rate of Adam (default: the preset's)")->type_name("R");
  command
      .add_option("--auxiliary-thermal", options.auxiliary_thermal,
                  "Weight of the loss on the thermal estimate alone; 0: none, as in the paper")
      ->type_name("W");
  command
      .add_option(
          "--symmetries", options.symmetries,
          "1: windows as they are; 2: half of them flipped, speed negated; 8: also upside down and backwards")
      ->check(CLI::IsMember({1, 2, 8}))
      ->type_name("N");
  add_choice(command, "choose-epoch", options.choose_epoch,
             "Keep the epoch that is best on one held-out acquisition, or the last one");
  command
      .add_option("--label-scale", options.label_scale_dps, "Speeds are divided by it (default 200 deg/s)")
      ->type_name("DPS");
  command.add_option("--seed", options.seed, "Of first weights, order, symmetries, made-up rooms")
      ->check(not_negative())
      ->type_name("SEED")
      ->capture_default_str();
}

}  // namespace

void add_window_shape(CLI::App& command, std::optional<int>& frames, std::optional<int>& reduction) {
  command.add_option("--nf", frames, "Frames of a window, 2 to 6 (default 3)")
      ->check(CLI::Range(2, 6))
      ->type_name("N");
  command.add_option("--nr", reduction, "Pixels are averaged N x N, 1 to 3 (default 1)")
      ->check(CLI::Range(1, 3))
      ->type_name("N");
}

void add_frame_memory(CLI::App& command, FrameOptions& options, const std::string& group) {
  command
      .add_option("--memory", options.memory_mb,
                  "Memory for frames; those that do not fit lie on a disk (default: half of the machine's)")
      ->check(CLI::Range(std::uint64_t{0}, std::uint64_t{1'000'000'000}))
      ->type_name("MB")
      ->group(group);
  command
      .add_option("--cache", options.cache,
                  "Folder on that disk, which stays empty (default: beside what is written)")
      ->type_name("FOLDER")
      ->group(group);
}

void add_train(CLI::App& root, TrainOptions& options) {
  CLI::App& command = *root.add_subcommand("train", "Train the fusion network on sessions");
  command.add_option("PATH", options.paths, "Session files (.h5), or folders that hold them");
  command.add_option("-o,--output", options.output, "Model file (ONNX) to write")
      ->type_name("FILE")
      ->default_str("model.onnx");
  command.add_flag("--made-rooms", options.made_rooms,
                   "Learn from rooms that are made up meanwhile; beside sessions, half of each batch");
  command
      .add_option("--lens", options.lens_deg,
                  "Field of view that sees them (default: the sessions', else 55)")
      ->check(CLI::Range(20.0, 180.0))
      ->type_name("DEG");
  command
      .add_option(
          "--from", options.from,
          "Model to begin with: a file, general, or none (default: general, where lens and frames fit)")
      ->type_name("FILE");
  add_network(command, options);
  add_settings(command, options);
  command
      .add_option("--threads", options.threads, "Threads; the model does not depend on it (default: cores)")
      ->check(CLI::Range(1, 64))
      ->type_name("N");
  command
      .add_option("--run-folder", options.run_folder,
                  "Folder for settings, metrics and checkpoint (default: FILE's name with .run)")
      ->type_name("DIR");
  add_frame_memory(command, options.frame_memory, "Options");
  command.add_flag("--resume", options.resume, "Go on with the run in that folder");
  command.add_flag("--accept-bad", options.accept_bad,
                   "Take bad sessions; without it those of a folder are left out");
  add_json(command, options.json);
  command.footer(
      "Examples:\n"
      "  thermorig train recordings/ -o model.onnx\n"
      "  thermorig train --made-rooms -o general.onnx\n"
      "  thermorig train recordings/ -o paper.onnx --preset paper --nf 3 --nr 1\n"
      "  thermorig train recordings/ -o model.onnx --resume");
}

}  // namespace thermorig::app

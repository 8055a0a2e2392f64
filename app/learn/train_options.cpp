// SPDX-License-Identifier: MIT
#include <CLI/CLI.hpp>

#include "help_formatter.h"
#include "learning_options.h"
#include "rig_options.h"
#include "thermorig/core/label.h"

namespace thermorig::app {

namespace {

void add_network(CLI::App& command, TrainOptions& options) {
  add_window_shape(command, options.frames, options.reduction);
  command.add_flag("--fusion,!--thermal-only", options.fusion, "Use the gyro too (default), or images only");
}

/// A word and its opposite; nothing is set where neither is given, so that the preset decides.
void add_choice(CLI::App& command, const std::string& name, std::optional<bool>& choice,
                const std::string& meaning) {
  command.add_flag_function(
      "--" + name + ",!--no-" + name, [&choice](std::int64_t count) { choice = count > 0; }, meaning);
}

void add_settings(CLI::App& command, TrainOptions& options) {
  command
      .add_option("--preset", options.preset,
                  "best (default: likelihood loss, 8 symmetries, scaled windows), or paper (as published)")
      ->check(one_of({"best", "paper"}))
      ->type_name("NAME");
  command
      .add_option(
          "--label", options.label,
          "Speed to learn: commanded (default, as in the paper), corrected (by the servo's measured scale), "
          "shaft (measured, else by the servo model), measured (by a sensor on the shaft)")
      ->check(one_of({label_names.begin(), label_names.end()}))
      ->type_name("NAME");
  command.add_option("--epochs", options.epochs, "Passes over all windows (default 40)")->type_name("N");
  command.add_option("--batch", options.batch, "Windows per step, 1 to 32 (default 32)")
      ->check(within(1, 32))
      ->type_name("N");
  command.add_option("--rate", options.rate, "Learning rate of Adam (default: the preset's)")->type_name("R");
  command
      .add_option("--auxiliary-thermal", options.auxiliary_thermal,
                  "Weight of the loss on the thermal estimate alone (0: none; default: the preset's)")
      ->type_name("W");
  command
      .add_option(
          "--symmetries", options.symmetries,
          "Augmentation: 1 (none), 2 (mirrored, speed negated), 8 (also upside down and backwards; default: "
          "the preset's)")
      ->check(CLI::IsMember({1, 2, 8}))
      ->type_name("N");
  add_choice(command, "choose-epoch", options.choose_epoch,
             "Keep the best epoch on a held-out acquisition, or the last epoch (default: the preset's)");
  command.add_option("--label-scale", options.label_scale_dps, "Divide speeds by this, deg/s (default 200)")
      ->type_name("DPS");
  command.add_option("--seed", options.seed, "Random seed")
      ->check(not_negative())
      ->type_name("SEED")
      ->capture_default_str();
}

}  // namespace

void add_window_shape(CLI::App& command, std::optional<int>& frames, std::optional<int>& reduction) {
  command.add_option("--nf", frames, "Frames per window, 2 to 6 (default 3)")
      ->check(within(2, 6))
      ->type_name("N");
  command.add_option("--nr", reduction, "Average pixels N x N, 1 to 3 (default 1)")
      ->check(within(1, 3))
      ->type_name("N");
}

void add_frame_memory(CLI::App& command, FrameOptions& options) {
  command
      .add_option(
          "--memory", options.memory_mb,
          "Memory limit for frames; beyond it they are packed, then on disk (default: half of the memory)")
      ->check(within(0, 1e9))
      ->type_name("MB");
}

void add_train(CLI::App& root, TrainOptions& options) {
  CLI::App& command = *root.add_subcommand("train", "Train the fusion network on sessions");
  command.add_option("PATH", options.paths, "Session files (.h5), or folders of them");
  command.add_option("-o,--output", options.output, "Model file (ONNX) to write")
      ->type_name("FILE")
      ->default_str("model.onnx");
  command.add_flag("--accept-bad", options.accept_bad,
                   "Include sessions with the verdict bad (default: those in folders are skipped)");
  in_group(command, "Network", [&] {
    command
        .add_option(
            "--from", options.from,
            "Model to start from: a file, general (built in), or none (default: general, if lens and frames "
            "fit)")
        ->type_name("FILE");
    add_network(command, options);
  });
  in_group(command, "Training", [&] {
    add_settings(command, options);
    command.add_flag("--made-rooms", options.made_rooms,
                     "Learn from generated rooms; together with sessions, half of each batch");
    command
        .add_option("--lens", options.lens_deg,
                    "Field of view in generated rooms (default: the sessions', else 55)")
        ->check(within(20.0, 180.0))
        ->type_name("DEG");
  });
  in_group(command, "Run", [&] {
    command.add_flag("--resume", options.resume, "Continue the run in its folder");
    command
        .add_option("--run-folder", options.run_folder,
                    "Folder for settings, metrics and checkpoint (default: FILE with .run)")
        ->type_name("DIR");
    command
        .add_option("--threads", options.threads, "Threads (default: cores); the model does not depend on it")
        ->check(within(1, 64))
        ->type_name("N");
    add_frame_memory(command, options.frame_memory);
  });
  add_json(command, options.json);
  command.footer(
      "Examples:\n"
      "  thermorig train recordings/ -o model.onnx\n"
      "  thermorig train --made-rooms -o general.onnx\n"
      "  thermorig train recordings/ -o paper.onnx --preset paper --nf 3 --nr 1\n"
      "  thermorig train recordings/ -o model.onnx --resume");
}

}  // namespace thermorig::app

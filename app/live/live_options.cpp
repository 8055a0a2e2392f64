// SPDX-License-Identifier: MIT
#include "live_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>

#include "help_formatter.h"
#include "rig_options.h"
#include "thermorig/core/error.h"
#include "thermorig/estimators/table.h"

namespace thermorig::app {

namespace {

constexpr double lowest_speed = 0.001;  // a second takes a quarter of an hour

void add_source(CLI::App& command, LiveCommandLine& words) {
  LiveOptions& live = words.options;
  add_environment(command, live.record.environment).capture_default_str();
  command.add_flag("--fast", live.record.fast,
                   "As fast as the computer can; with --simulated, and without a page");
  command.add_option("--replay", live.replay, "Replay this session (.h5) instead of driving a rig")
      ->type_name("SESSION");
  command
      .add_option("--speed", words.speed,
                  "Speed of the replay: 1 (default), 10 (ten times as fast), max (as fast as possible)")
      ->type_name("N");
  command.add_flag("--tui", live.tui, "Draw the image and the rates in the terminal");
  add_replug(command, live.record.replug_patience_s);
  in_group(command, "Sweep plan", [&] {
    add_plan(command, live.record);
    add_legs(command, live.record, "0 without --record");
    add_seconds(command, live.record);
    command.add_flag("--loop", live.loop, "Repeat the plan until Ctrl-C");
  });
}

void add_result(CLI::App& command, LiveCommandLine& words) {
  LiveOptions& live = words.options;
  in_group(command, "Session", [&] {
    command.add_flag("--record", live.keep, "Save a session, with the estimates in it");
    add_folder(command, live.record.output, "Folder of the recordings (with --record)");
    command
        .add_option("--licence", live.record.licence, "Licence of the data, e.g. CC-BY-4.0 (with --record)")
        ->type_name("TEXT");
    command.add_flag("!--no-preflight", live.record.preflight,
                     "Record despite failed checks: warn only (with --record)");
    add_sync(command, live.record.sync_ms);
  });
  add_json(command, live.record.json);
}

double speed_of(const std::string& text) {
  if (text == "max") return 0.0;
  double speed = 0.0;
  const char* end = text.data() + text.size();
  const auto [at, error] = std::from_chars(text.data(), end, speed);
  if (error == std::errc() && at == end && std::isfinite(speed) && speed >= lowest_speed) return speed;
  throw Error(ExitCode::bad_usage, "'" + text + "' is not a speed", "--speed",
              fmt::format("--speed 1, --speed 10 or --speed max; {} at least", lowest_speed));
}

[[noreturn]] void refuse_option(const std::string& what, const std::string& advice) {
  throw Error(ExitCode::bad_usage, what, "", advice);
}

/// Refuses each of `names` that was said, because of `why`.
void refuse_said(const LiveCommandLine& words, std::initializer_list<const char*> names,
                 const std::string& why) {
  for (const char* name : names)
    if (words.command->count(name) > 0)
      refuse_option(fmt::format("{} {}", name, why), fmt::format("leave {} out", name));
}

/// A word that would do nothing is a misunderstanding.
void check_words_without_effect(const LiveCommandLine& words) {
  const LiveOptions& live = words.options;
  if (live.replay)
    refuse_said(words,
                {"--environment",
                 "--plan",
                 "--frames-per-leg",
                 "--valid-per-leg",
                 "--speeds",
                 "--fast",
                 "--output",
                 "--camera",
                 "--gyro",
                 "--servo",
                 "--camera-baud",
                 "--gyro-baud",
                 "--servo-baud",
                 "--camera-rate",
                 "--simulated-servo",
                 "--simulated-camera",
                 "--simulated-gyro",
                 "--gyro-protocol",
                 "--simulated-gyro-protocol",
                 "--simulated-encoder",
                 "--world",
                 "--no-preflight",
                 "--replug-patience",
                 "--sync",
                 "--licence",
                 "--seconds",
                 "--no-servo"},
                "is for a rig; a replay takes all that from its session");
  if (!live.keep)
    refuse_said(words, {"--output", "--licence"}, "is for a session, and none is kept without --record");
  if (words.no_page)
    refuse_said(words, {"--page-port", "--new-token"}, "is for the page, and --no-page serves none");
  if (live.record.fast)
    refuse_said(words, {"--page-port", "--new-token"}, "is for the page, and --fast serves none");
  if (live.model == "none")
    refuse_said(words, {"--precision", "--turned"}, "is for a network, and --model none runs none");
}

/// A map is that of the odometer.
void check_map(const LiveOptions& live) {
  const auto keeps_map = [](const std::string& name) { return estimators::entry(name).keeps_map; };
  const bool is_kept =
      live.estimators.empty() || std::any_of(live.estimators.begin(), live.estimators.end(), keeps_map);
  if (!live.map.empty() && !is_kept)
    refuse_option("--map is for the odometer, and that is not among --estimators",
                  "--estimators odometer, or leave --map out");
}

void check(const LiveCommandLine& words) {
  const LiveOptions& live = words.options;
  check_map(live);
  const bool names_rig = live.record.rig.simulated_seed || !live.record.rig.profile.empty();
  if (live.replay && names_rig)
    refuse_option("--replay and a rig exclude each other", "--replay SESSION alone");
  if (live.replay && live.keep)
    refuse_option("a replay is recorded already",
                  "leave --record out; `thermorig evaluate` works on the session");
  if (live.replay && live.loop) refuse_option("--loop is for a rig, not for a replay", "leave --loop out");
  if (live.replay && live.record.page.control) refuse_option("a replay moves nothing", "leave --control out");
  if (!live.replay && !words.speed.empty())
    refuse_option("--speed is for --replay", "--replay SESSION --speed 10");
  if (live.tui && live.record.json) refuse_option("--tui and --json exclude each other", "one of the two");
  if (words.page && words.no_page) refuse_option("--page and --no-page exclude each other", "one of the two");
  if (words.no_page && live.record.page.control)
    refuse_option("--control lets the page start motion, and --no-page serves none",
                  "leave one of the two out");
  if (live.record.fast && (words.page || live.record.page.control))
    refuse_option("virtual time is too fast for a page", "leave --fast out, or --page");
  if (live.record.fast && live.loop)
    refuse_option("--loop has no end in virtual time", "leave --fast or --loop out");
  check_words_without_effect(words);
}

}  // namespace

void add_page(CLI::App& command, PageOptions& page) {
  command.add_option("--page-port", page.port, "Port of the page on this computer (0: any free one)")
      ->check(within(0, 65535))
      ->type_name("N")
      ->capture_default_str();
  command.add_flag("--new-token", page.new_token, "Make a new token: open pages must be opened again");
  command.add_flag("--control", page.control, "Start motion from the page: nothing moves before its Start");
}

void add_live(CLI::App& root, LiveCommandLine& words) {
  LiveOptions& live = words.options;
  live.record.environment = "laboratory";
  live.record.plan = "quick";
  CLI::App& command = *root.add_subcommand("live", "Show estimates against the servo while the rig moves");
  words.command = &command;
  add_source(command, words);
  in_group(command, "Estimators", [&] {
    command
        .add_option(
            "-m,--model", live.model,
            "Model (.onnx) from `thermorig train`, general or none (default: general, where it has learnt "
            "the lens)")
        ->type_name("FILE");
    command
        .add_option("--turned", live.turned,
                    "Windows to average: 8 (all symmetries, default, where the model has learnt them), or 1")
        ->check(CLI::IsMember({1, 8}))
        ->type_name("N");
    command.add_option("--precision", live.precision, "Weight precision: fp32, or fp16 for half the memory")
        ->check(one_of({"fp32", "fp16"}))
        ->type_name("KIND")
        ->capture_default_str();
    command
        .add_option("--estimators", live.estimators,
                    "Estimators to run, in this order (default: all that can)")
        ->check(one_of(estimators::names()))
        ->delimiter(',')
        ->type_name("NAME,...");
    command
        .add_option("--map", live.map,
                    "Map of the odometer: read if the file is there, and written at the end")
        ->type_name("FILE");
  });
  add_rig(command, live.record.rig);
  add_result(command, words);
  in_group(command, "Page", [&] {
    command.add_flag("--page", words.page, "Serve the page for a browser (default, except with --fast)");
    command.add_flag("--no-page", words.no_page, "Serve no page");
    add_page(command, live.record.page);
  });
  command.footer(
      "Examples:\n"
      "  thermorig live --simulated=4\n"
      "  thermorig live --rig bench --model model.onnx --environment garden --record\n"
      "  thermorig live --rig bench -e kitchen --plan paper --map kitchen.map\n"
      "  thermorig live --replay session.h5 --model model.onnx --speed 10");
}

LiveOptions chosen_live(const LiveCommandLine& words) {
  check(words);
  LiveOptions live = words.options;
  if (!words.speed.empty()) live.speed = speed_of(words.speed);
  if (!live.record.valid_per_leg)
    live.record.valid_per_leg = live.keep ? std::nullopt : std::optional<int>(0);
  live.record.page.serve = !words.no_page && !live.record.fast;
  return live;
}

}  // namespace thermorig::app

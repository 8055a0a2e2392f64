// SPDX-License-Identifier: MIT
#include "live_options.h"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <charconv>
#include <cmath>
#include <initializer_list>

#include "rig_options.h"
#include "thermorig/core/error.h"
#include "thermorig/estimators/table.h"

namespace thermorig::app {

namespace {

constexpr double lowest_speed = 0.001;  // a second takes a quarter of an hour

void add_source(CLI::App& command, LiveCommandLine& words) {
  LiveOptions& live = words.options;
  add_environment(command, live.record.environment).capture_default_str();
  add_plan(command, live.record, "Sweep plan: quick, paper, table-one or a TOML file");
  add_legs(command, live.record, " (0: no quota, the default)");
  add_seconds(command, live.record);
  command.add_flag("--loop", live.loop, "The plan again and again, until it is stopped");
  command.add_option("--replay", live.replay, "Replay this session (.h5) instead of driving a rig")
      ->type_name("SESSION");
  command.add_option("--speed", words.speed, "Of a replay: 1 as it was, 10 ten times as fast, max")
      ->type_name("N");
  command.add_flag("--fast", live.record.fast,
                   "Virtual time: as fast as the machine can (simulated rig only)");
}

void add_result(CLI::App& command, LiveCommandLine& words) {
  LiveOptions& live = words.options;
  command.add_flag("--record", live.keep, "Keep a session, with the estimates in it");
  add_folder(command, live.record.output, "Folder that holds the recordings (with --record)");
  command
      .add_option("--licence", live.record.licence,
                  "Licence of the data, kept in the session (with --record)")
      ->type_name("TEXT");
  command.add_flag("!--no-preflight", live.record.preflight,
                   "With --record: keep a session of a rig that is not fit for it");
  command.add_flag("--tui", live.tui, "Draw the image and the rates on the terminal");
  add_sync(command, live.record.sync);
  add_replug(command, live.record.replug_patience_s);
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
    refuse_said(words, {"--environment",    "--plan",        "--frames-per-leg",  "--valid-per-leg",
                        "--speeds",         "--fast",        "--output",          "--camera",
                        "--gyro",           "--servo",       "--camera-baud",     "--gyro-baud",
                        "--servo-baud",     "--camera-rate", "--simulated-servo", "--simulated-camera",
                        "--simulated-gyro", "--world",       "--no-preflight",    "--replug-patience",
                        "--sync",           "--licence",     "--seconds",         "--no-servo"},
                "is for a rig; a replay takes all that from its session");
  if (!live.keep)
    refuse_said(words, {"--output", "--licence"}, "is for a session, and none is kept without --record");
  if (words.no_page)
    refuse_said(words, {"--page-port", "--new-token"}, "is for the page, and --no-page serves none");
  if (live.record.fast)
    refuse_said(words, {"--page-port", "--new-token"}, "is for the page, and --fast serves none");
  if (live.model.empty())
    refuse_said(words, {"--precision"}, "is that of a network, and there is no --model");
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
  command.add_option("--page-port", page.port, "Port of the page on this machine (0: any that is free)")
      ->check(CLI::Range(0, 65535))
      ->type_name("N")
      ->capture_default_str();
  command.add_flag("--new-token", page.new_token, "A new token: pages that are open must be opened anew");
  command.add_flag("--control", page.control, "The page may start motion, and motion waits for its Start");
}

void add_live(CLI::App& root, LiveCommandLine& words) {
  LiveOptions& live = words.options;
  live.record.environment = "laboratory";
  live.record.plan = "quick";
  CLI::App& command =
      *root.add_subcommand("live", "Show the network's estimate against the servo while the rig moves");
  command
      .add_option(
          "-m,--model", live.model,
          "Model (.onnx) that `thermorig train` wrote; without it the estimators that need no network run")
      ->type_name("FILE");
  command
      .add_option("--precision", live.precision, "Of the network's weights: fp32, or fp16, half the memory")
      ->check(CLI::IsMember({"fp32", "fp16"}))
      ->type_name("KIND")
      ->capture_default_str();
  command.add_option("--estimators", live.estimators, "Those to run, by name (default: all that can)")
      ->check(one_of(estimators::names()))
      ->delimiter(',')
      ->type_name("NAME,...");
  command
      .add_option("--map", live.map,
                  "The odometer's map: begun with if it is there, so that headings are since its origin, and "
                  "written at the end")
      ->type_name("FILE");
  words.command = &command;
  add_source(command, words);
  add_result(command, words);
  command.add_flag("--page", words.page, "Serve the page for a browser (default, but with --fast)");
  command.add_flag("--no-page", words.no_page, "Serve no page");
  add_page(command, live.record.page);
  add_rig(command, live.record.rig);
  command.footer(
      "Examples:\n"
      "  thermorig live --simulated=4 --model model.onnx\n"
      "  thermorig live --rig bench --model model.onnx --environment garden --record\n"
      "  thermorig live --rig bench --environment kitchen --plan paper --map kitchen.map\n"
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

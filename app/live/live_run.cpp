// SPDX-License-Identifier: MIT
#include "live_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <numeric>
#include <utility>

#include "print/output.h"
#include "print/rows_text.h"
#include "thermorig/io/port.h"

namespace thermorig::app {

namespace {

constexpr std::uint64_t scene_frame = 16;  // the camera has settled a little
constexpr double scene_deviations = 4.0;
constexpr HostDuration surroundings_period = std::chrono::seconds(1);

std::optional<std::uint64_t> free_bytes(const std::filesystem::path& folder) {
  std::error_code unknown;
  const auto space = std::filesystem::space(folder, unknown);
  return unknown ? std::nullopt : std::optional<std::uint64_t>(space.available);
}

double label_scale_dps(const std::optional<model::Model>& model) {
  return model ? double{model->scaling.label_scale_dps} : 200.0;
}

}  // namespace

LiveRun::LiveRun(const LiveFacts& facts, const ChosenModel& model, estimators::Bank bank, LiveMap* map)
    : facts_(facts),
      columns_(live::columns_of(bank)),
      estimates_(std::move(bank)),
      scorer_(columns_, label_scale_dps(model.model)),
      map_(map) {
  if (!model.model) return;
  scaling_ = model.model->scaling;
  learnt_ = model.model->provenance.view;
}

bool LiveRun::wanted(web::Topic topic) const {
  return std::any_of(sinks_.begin(), sinks_.end(),
                     [topic](const MessageSink* sink) { return sink->wants(topic); });
}

void LiveRun::publish(web::Topic topic, const nlohmann::json& message) {
  if (!wanted(topic)) return;
  std::string text = json_line(message);
  text.pop_back();  // the line's end
  for (MessageSink* sink : sinks_)
    if (sink->wants(topic)) sink->take(topic, text);
}

void LiveRun::begun(const RecordingHeader& header) {
  facts_.header = header;
  facts_.header.estimators = columns_;
  begin_ = now_ = header.time_reference;
  publish(web::Topic::hello, hello_message(facts_));
  for (LiveScreen* screen : screens_) screen->hello(facts_);
  tell_of_map();
}

EstimateRow LiveRun::observe(const Measurement& measurement, HostTime arrived) {
  const HostTime before = io::now();
  const EstimateRow row = estimates_.add(measurement, arrived);
  const double took_us = std::round(1e7 * to_s(io::now() - before)) / 10.0;
  scorer_.add(row);
  const live::LiveScores scores = scorer_.scores();
  now_ = arrived;
  const LiveFrame seen{measurement.frame, measurement.sample, columns_, row, scores, took_us};
  if (wanted(web::Topic::frame)) publish(web::Topic::frame, frame_message(seen, begin_));
  if (wanted(web::Topic::image))
    publish(web::Topic::image, image_message(seen, begin_, facts_.header.profile.camera.mirrored));
  publish_surroundings();
  for (LiveScreen* screen : screens_) screen->frame(seen);
  if (++frames_ == scene_frame) warn_of_scene(measurement.frame.frame);
  warn_of_full_frames(measurement.frame);
  warn_of_gate(scores);
  warn_of_ignored();
  tell_of_map();
  tell_of_rows();
  return row;
}

/// They change slowly.
void LiveRun::publish_surroundings() {
  if (!wanted(web::Topic::surroundings)) return;
  if (surroundings_shown_ && now_ - *surroundings_shown_ < surroundings_period) return;
  surroundings_shown_ = now_;
  const odometer::Odometer* odometer = estimates_.bank().odometer();
  const std::vector<float> image_c = odometer != nullptr ? odometer->map_image_c() : std::vector<float>();
  if (image_c.empty()) return;
  publish(web::Topic::surroundings,
          surroundings_message(image_c, to_s(now_ - begin_), facts_.header.profile.camera.lens_width_deg()));
}

void LiveRun::warn_of_scene(const ThermalFrame& frame) {
  if (!scaling_ || scaling_->by_window) return;
  const double sum = std::accumulate(frame.temp_c.begin(), frame.temp_c.end(), 0.0);
  const double mean_c = sum / static_cast<double>(frame_pixels);
  const double off = (mean_c - double{scaling_->temp_mean_c}) / double{scaling_->temp_deviation_c};
  if (!(std::abs(off) > scene_deviations)) return;
  warn(
      fmt::format("the scene is {:.1f} degC on average, the model was trained around {:.1f} degC: {:.0f} of "
                  "its deviations away, so its estimates mean little here; train it with sessions from here",
                  mean_c, scaling_->temp_mean_c, std::abs(off)));
}

/// Half-frames renew every other pixel, full frames all.
void LiveRun::warn_of_full_frames(const TimedFrame& frame) {
  constexpr std::uint64_t judged = 64;
  if (!learnt_ || frames_ > judged) return;
  constexpr int few_pixels = 20;
  if (std::min(frame.fresh_even, frame.fresh_odd) > few_pixels) ++full_frames_;
  if (frames_ < judged || (full_frames_ > judged / 2) != learnt_->half_frames) return;
  warn(learnt_->half_frames
           ? "the camera sends full frames, and the model has learnt half-frames: its rates are worse here"
           : "the camera sends half-frames, and the model has learnt full frames: its rates are worse here");
}

void LiveRun::warn_of_gate(const live::LiveScores& scores) {
  if (!scores.gate_collapsed || std::exchange(gate_told_, true)) return;
  const std::string sentence = fmt::format(
      "the network's gate has collapsed: Kg stays {} (train on more speeds, or with another "
      "--auxiliary-thermal)",
      scores.gain_mean < 0.5 ? "below 0.02" : "above 0.98");
  orders_.push_back({rig::OrderKind::gate, sentence});
}

void LiveRun::warn_of_ignored() {
  if (estimates_.bank().ignored() == 0 || std::exchange(ignored_told_, true)) return;
  warn("a device sent NaN or infinity: estimators skip these values");
}

void LiveRun::tell_of_map() {
  const odometer::Odometer* odometer = estimates_.bank().odometer();
  if (map_ == nullptr || odometer == nullptr) return;
  if (auto news = map_->news(odometer->map_use()))
    orders_.push_back({rig::OrderKind::info, *std::move(news)});
}

/// When a start has compared them; a start after a lost one tells anew.
void LiveRun::tell_of_rows() {
  const odometer::Odometer* odometer = estimates_.bank().odometer();
  if (odometer == nullptr || !(odometer->rows().margin > 0.0) || odometer->rows() == rows_told_) return;
  rows_told_ = odometer->rows();
  orders_.push_back({rig::OrderKind::info, rows_text(*rows_told_)});
}

void LiveRun::write_map(const std::filesystem::path& session) {
  const odometer::Odometer* odometer = estimates_.bank().odometer();
  if (map_ == nullptr || odometer == nullptr) return;
  const auto told = map_->write(odometer->map(), odometer->map_use(), facts_.header, session);
  if (told) tell({now_, EventKind::info, std::nullopt, *told});
}

void LiveRun::progress(const rig::RecordingProgress& progress) {
  now_ = progress.time;
  for (const RecordingEvent& event : progress.events) tell(event);
  if (wanted(web::Topic::state)) {
    const auto free = facts_.recording ? free_bytes(facts_.output) : std::nullopt;
    publish(web::Topic::state, state_message(progress, facts_, free));
  }
  for (LiveScreen* screen : screens_) screen->state(progress);
}

void LiveRun::tell(const RecordingEvent& event) {
  publish(web::Topic::event, event_message(event, begin_));
  if (event.kind == EventKind::leg_start || event.kind == EventKind::leg_end) return;
  note(event.kind == EventKind::mark ? "mark " + event.message : event.message);
}

void LiveRun::warn(const std::string& sentence) {
  publish(web::Topic::event, event_message({now_, EventKind::warning, std::nullopt, sentence}, begin_));
  note("warning: " + sentence);
}

void LiveRun::note(const std::string& sentence) {
  for (LiveScreen* screen : screens_) screen->note(sentence);
}

void LiveRun::ended(const LiveEnd& end) {
  publish(web::Topic::ended, ended_message(end));
  for (LiveScreen* screen : screens_) screen->ended(end, scorer_.scores());
}

std::vector<rig::Order> LiveRun::take_orders() {
  return std::exchange(orders_, {});
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#pragma once

#include <chrono>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "live_map.h"
#include "live_messages.h"
#include "live_model.h"
#include "thermorig/estimators/live/live_estimates.h"
#include "thermorig/estimators/live/scores.h"
#include "thermorig/io/web/server.h"
#include "thermorig/rig/recording/order.h"

namespace thermorig::app {

/// A run says so often how it goes.
inline constexpr auto state_period = std::chrono::milliseconds(250);

/// Takes the messages of docs/live_messages.md: standard output, the page.
struct MessageSink {
  virtual ~MessageSink() = default;
  virtual bool wants(web::Topic) const { return true; }
  virtual void take(web::Topic topic, const std::string& message) = 0;
};

/// What a person at a terminal sees of a run.
struct LiveScreen {
  virtual ~LiveScreen() = default;
  virtual void hello(const LiveFacts& facts) = 0;
  virtual void state(const rig::RecordingProgress& progress) = 0;
  virtual void frame(const LiveFrame& frame) = 0;
  virtual void note(const std::string& sentence) = 0;
  virtual void ended(const LiveEnd& end, const live::LiveScores& scores) = 0;
};

/// A run as those who watch it see it: each frame gets its row and the figures so far, and everybody is told.
/// All calls come from the recording's thread.
class LiveRun {
 public:
  /// `map`: null, or the file that is begun with and written.
  LiveRun(const LiveFacts& facts, const ChosenModel& model, estimators::Bank bank, LiveMap* map = nullptr);

  void add(MessageSink& sink) { sinks_.push_back(&sink); }
  void add(LiveScreen& screen) { screens_.push_back(&screen); }

  void begun(const RecordingHeader& header);
  /// As rig::Observer.
  EstimateRow observe(const Measurement& measurement, HostTime arrived);
  void progress(const rig::RecordingProgress& progress);
  void tell(const RecordingEvent& event);
  void warn(const std::string& sentence);
  void note(const std::string& sentence);
  /// At the end of a run that ended well, or was stopped. `session`: empty if none is kept. Throws
  /// Error(storage).
  void write_map(const std::filesystem::path& session);
  void ended(const LiveEnd& end);

  /// What this run asks of the recording since the last call.
  std::vector<rig::Order> take_orders();
  live::LiveScores scores() const { return scorer_.scores(); }

 private:
  bool wanted(web::Topic topic) const;
  void publish(web::Topic topic, const nlohmann::json& message);
  void publish_surroundings();
  void warn_of_scene(const ThermalFrame& frame);
  void warn_of_full_frames(const TimedFrame& frame);
  void warn_of_gate(const live::LiveScores& scores);
  void warn_of_ignored();
  void tell_of_map();
  void tell_of_rows();

  LiveFacts facts_;
  std::optional<network::Scaling> scaling_;
  std::optional<network::CameraView> learnt_;
  std::vector<EstimatorColumn> columns_;  // of the rows
  live::LiveEstimates estimates_;
  live::Scorer scorer_;
  LiveMap* map_;
  std::vector<MessageSink*> sinks_;
  std::vector<LiveScreen*> screens_;
  std::vector<rig::Order> orders_;
  HostTime begin_{};
  HostTime now_{};
  std::uint64_t frames_ = 0, full_frames_ = 0;
  std::optional<HostTime> surroundings_shown_;
  bool gate_told_ = false;
  bool ignored_told_ = false;
  std::optional<odometer::FoundRows> rows_told_;
};

}  // namespace thermorig::app

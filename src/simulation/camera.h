// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "free_optics.h"
#include "heard.h"
#include "optics.h"
#include "pixel_noise.h"
#include "random.h"
#include "shaft.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/profile.h"

namespace thermorig::simulation {

struct CameraConfig {
  double field_of_view_deg = 55.0;
  double output_rate_hz = 8.0;  // frames a second, nominal
  bool half_fresh = true;       // a frame after every chess half; false: after every second one
  bool mirrored = true;
  bool warm = true;
  double clock_error = -0.02;  // relative; the clock wanders around it
  std::optional<double>
      latency_s;  // constant part, from the exposure's end to the first byte; drawn if not set
  CameraWorld world;
  SceneWorld scene;
};

/// Exposed is the span of time whose mean view the pixels show: that of their integration, earlier by the lag
/// of their membranes. Where rows are integrated one after the other, it is that of the middle ones.
struct SimulatedFrame {
  ThermalFrame frame;
  ShaftMark exposure_begin;   // of the older half
  ShaftMark exposure_end;     // of the newest half
  std::int64_t ready_ns = 0;  // when the bridge has computed it and wants to send
  unsigned newest_half = 0;   // chess half that was exposed last
};

/// An MLX90640 behind its bridge, turning with the shaft. Times are rig time in nanoseconds.
class Camera {
 public:
  Camera(const CameraConfig& config, const Panorama& panorama, std::uint64_t seed);

  /// The frames whose exposure ends by the time up to which the shaft is known.
  std::vector<SimulatedFrame> follow(const Shaft& shaft);

  /// From the next chess half on.
  void set_output_rate(double output_rate_hz);

 private:
  struct Half {  // a chess half that is being integrated
    unsigned parity = 0;
    std::int64_t begin_ns = 0;
    std::int64_t end_ns = 0;
    ShaftMark exposure_begin;
    int steps = 0;
    int steps_done = 0;
  };
  void warm_up(const Shaft& shaft);
  void begin_half(std::int64_t begin_ns, const ShaftMark& exposure_begin, unsigned parity);
  void view(const Shaft& shaft, std::int64_t time_ns, PixelColumns& seen_c);
  void expose_step();
  void send_frame(const ShaftMark& exposure_end, std::vector<SimulatedFrame>& out);
  void finish_half(const ShaftMark& exposure_end, std::vector<SimulatedFrame>& out);
  std::int64_t step_time_ns(int step) const;
  std::int64_t next_period_ns();
  std::int64_t row_offset_ns(std::size_t row) const;

  CameraConfig config_;
  Optics optics_;
  std::optional<FreeOptics> free_optics_;  // in its place, where the world needs it
  Random clock_;
  Random losses_;
  double refresh_period_s_;  // nominal
  double lag_s_;             // of the membranes
  std::int64_t shown_ns_;    // what pixels show is older than their integration by that
  PixelNoise noise_;
  double processing_s_;  // constant part of what the bridge takes
  double wander_ = 0.0;  // of the clock, relative
  bool started_ = false;
  unsigned last_parity_;  // full-fresh: the half that completes a frame
  Half half_;
  std::array<ShaftMark, 2> shown_begin_;  // of the exposure that each half shows
  std::optional<SimulatedFrame> sent_;    // last
  PixelColumns seen_c_{};                 // by the optics, now
  PixelColumns lagged_c_{};               // by the membranes, which follow slowly
  PixelColumns sum_c_{};                  // of lagged_c_ over the exposure so far
  ThermalFrame frame_;                    // both halves as they were read last
};

/// How the simulated camera speaks a protocol. It shares no code with what reads it (sensors), but the names.
struct CameraEncoder {
  std::string_view name;
  std::vector<std::uint8_t> (*bytes)(const SimulatedFrame& frame, const CameraProfile& profile);
  /// None: it hears nothing and sends by itself.
  Heard (*hear)(std::span<const std::uint8_t> bytes, const CameraProfile& profile) = nullptr;
};

std::span<const CameraEncoder> camera_encoders();

/// Of the profile's protocol. Throws Error(bad_usage) if there is none.
const CameraEncoder& camera_encoder(const CameraProfile& profile);

}  // namespace thermorig::simulation

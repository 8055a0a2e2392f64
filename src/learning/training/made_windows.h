// SPDX-License-Identifier: MIT
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "made_panorama.h"
#include "thermorig/learning/training/training.h"
#include "thermorig/network/workers.h"
#include "window_set.h"

namespace thermorig::training {

/// Windows of made-up rooms, drawn from a few thousand of which the oldest are always being replaced. What a
/// step sees depends on seed and step alone: not on the workers, nor on where the run was begun.
class MadeWindows {
 public:
  /// Ready for step `step` (from 0). What is handed in must live as long as this.
  MadeWindows(const MadeRooms& rooms, const network::Shape& shape, std::uint64_t seed, std::uint64_t step,
              network::Workers& workers);
  ~MadeWindows();

  /// Adds the windows of the next step, each turned by one of the eight symmetries.
  void add_to(BatchBuffer& batch, std::size_t windows);

 private:
  struct Place {  // a panorama and the camera in it
    MadePanorama panorama;
    MadeCamera camera;
  };

  std::uint64_t round_of(std::uint64_t step) const;
  void make_round(std::uint64_t round);
  void make_places(std::uint64_t round);
  void make_windows(std::uint64_t round);
  void make_window(std::uint64_t number);
  const std::vector<MadePanorama::Values>& textures_of(std::uint64_t round);
  template <class Work>
  void share_out(std::uint64_t count, Work work);

  const MadeRooms& rooms_;
  network::Shape shape_;
  std::uint64_t seed_, step_;
  network::Workers& workers_;
  std::uint64_t rounds_kept_;
  std::uint64_t made_;                          // the last round that was
  std::vector<std::unique_ptr<Place>> places_;  // a ring
  std::vector<float> frames_;        // a ring of windows, (Nf, H, W) each, as the network takes them
  std::vector<float> label_, gyro_;  // of these
  std::vector<MadePanorama::Values> textures_;
  std::uint64_t texture_block_ = ~std::uint64_t{0};
};

}  // namespace thermorig::training

// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>

#include "thermorig/network/acquisition.h"

namespace thermorig::dataset {

/// Where a file of frames may lie.
struct FrameFolder {
  std::filesystem::path folder;
  bool is_only_choice = false;  // else $TMPDIR and /var/tmp are tried after it
};

/// Keeps pixels of acquisitions small, without the loss of a bit: whole hundredths of a degree, which is what
/// cameras send, in 16 bits; and as many of them in memory as may be. Those of further ones lie in a file
/// without a name, of which nothing is left when the program has ended, however it ended.
class FrameStore {
 public:
  /// `memory_bytes`: of pixels in memory, at most.
  FrameStore(FrameFolder folder, std::uint64_t memory_bytes);
  ~FrameStore();
  FrameStore(const FrameStore&) = delete;
  FrameStore& operator=(const FrameStore&) = delete;

  /// Takes the pixels, which Acquisition::stored has from then on, also after the end of this store. May be
  /// called from several threads. Throws Error(storage) where the disk has no room for them, or fails.
  void take(network::Acquisition& acquisition);

  /// Puts the pixels of all back into Acquisition::temp_c, where a training finds them fastest, if they fit
  /// into memory so, each frame with so many bytes of others beside it. Not if any lies on the disk.
  void give_back(std::span<network::Acquisition> acquisitions, std::uint64_t bytes_beside_a_frame);

  /// Of what was taken and not given back.
  std::uint64_t bytes_in_memory() const;
  std::uint64_t bytes_on_disk() const;
  /// Where the file lies; empty without one.
  std::filesystem::path place() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::dataset

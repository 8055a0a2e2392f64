// SPDX-License-Identifier: MIT
#include "frame_memory.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>
#include <span>
#include <utility>

#include "print/output.h"
#include "thermorig/core/error.h"
#include "thermorig/core/frame.h"
#include "thermorig/io/host.h"
#include "thermorig/io/spill/spill.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

/// An array of so many bytes is one for the disk: a recording of some seconds.
constexpr std::size_t array_bytes = 64 * frame_pixels * sizeof(std::int16_t);

/// While sessions are read, arrays that memory has no room for lie on a disk, but none that training makes
/// later.
class ArraysOfReading {
 public:
  ArraysOfReading(const fs::path& near, std::uint64_t kept_bytes) : near_(near) {
    spill::arrays_near(near_, {.array_bytes = array_bytes, .in_memory_bytes = kept_bytes});
  }
  ~ArraysOfReading() { spill::arrays_near(near_, {.array_bytes = std::numeric_limits<std::size_t>::max()}); }
  ArraysOfReading(const ArraysOfReading&) = delete;
  ArraysOfReading& operator=(const ArraysOfReading&) = delete;

 private:
  const fs::path& near_;
};

/// Puts the pixels of all back into Acquisition::temp_c, where a training finds them fastest.
void unpack(std::span<network::Acquisition> acquisitions) {
  for (network::Acquisition& acquisition : acquisitions) {
    acquisition.temp_c.resize(acquisition.frames() * frame_pixels);
    acquisition.packed->read(0, acquisition.temp_c);
    acquisition.packed = nullptr;
  }
}

}  // namespace

FrameMemory::FrameMemory(const FrameOptions& options, fs::path near)
    : near_(std::move(near)),
      bytes_(options.memory_mb ? *options.memory_mb * 1'000'000 : io::memory_bytes() / 2) {}

dataset::Acquisitions FrameMemory::read(SessionOptions options, std::uint64_t bytes_beside_a_frame) {
  const ArraysOfReading on_disk(near_, bytes_);
  options.packs = true;
  dataset::Acquisitions data = read_data(options);
  std::uint64_t frames = 0, large_bytes = 0;
  for (const network::Acquisition& acquisition : data.acquisitions) {
    const std::uint64_t bytes = acquisition.packed->bytes();
    frames += acquisition.frames();
    packed_bytes_ += bytes;
    if (bytes >= array_bytes) large_bytes += bytes;
  }
  bytes_on_disk_ = spill::spilled_bytes();
  if (large_bytes > bytes_ + bytes_on_disk_)
    throw Error(ExitCode::storage, "no disk has room for the frames that memory may not take", near_.string(),
                "free some space, set TMPDIR to a disk that has room, or allow more --memory");
  if (bytes_on_disk_ == 0 && frames * (frame_pixels * sizeof(float) + bytes_beside_a_frame) <= bytes_) {
    unpack(data.acquisitions);
    packed_bytes_ = 0;
  }
  return data;
}

void FrameMemory::run_estimators(dataset::Acquisitions& data, bool json, const dataset::IsWanted& is_wanted,
                                 int bound_frames) const {
  const ArraysOfReading on_disk(near_, bytes_);
  app::run_estimators(data, json, is_wanted, bound_frames);
}

std::string FrameMemory::text() const {
  if (packed_bytes_ == 0) return fmt::format("frames in memory (limit {})", bytes_text(bytes_));
  return fmt::format("frames packed to {} (limit of memory {}){}", bytes_text(packed_bytes_),
                     bytes_text(bytes_),
                     bytes_on_disk_ == 0 ? "" : fmt::format("; {} on the disk", bytes_text(bytes_on_disk_)));
}

void FrameMemory::add_to(nlohmann::json& object) const {
  object["memory_bytes"] = bytes_;
  object["packed_bytes"] = packed_bytes_;
  object["bytes_on_disk"] = bytes_on_disk_;
}

}  // namespace thermorig::app

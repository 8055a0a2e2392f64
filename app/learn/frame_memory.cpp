// SPDX-License-Identifier: MIT
#include "frame_memory.h"

#include <fmt/format.h>

#include <limits>
#include <nlohmann/json.hpp>

#include "print/output.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/disk.h"
#include "thermorig/io/host.h"
#include "thermorig/io/spill/spill.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

dataset::FrameFolder folder_for(const fs::path& asked_for, const fs::path& near) {
  if (asked_for.empty()) return {.folder = files::folder_of(near)};
  std::error_code hidden;
  if (!fs::is_directory(asked_for, hidden))
    throw Error(ExitCode::bad_usage, "there is no such folder", asked_for.string(),
                "make it first: mkdir -p " + asked_for.string());
  return {.folder = asked_for, .is_only_choice = true};
}

/// While sessions are read, arrays that are too large for it lie on a disk as well, but none that training
/// makes later.
class ArraysOfReading {
 public:
  ArraysOfReading(const fs::path& folder, std::uint64_t kept_bytes) : near_(folder / "frames") {
    constexpr std::uint64_t sessions_bytes = 256'000'000;
    spill::arrays_near(near_, {.in_memory_bytes = kept_bytes + sessions_bytes});
  }
  ~ArraysOfReading() { spill::arrays_near(near_, {.array_bytes = std::numeric_limits<std::size_t>::max()}); }
  ArraysOfReading(const ArraysOfReading&) = delete;
  ArraysOfReading& operator=(const ArraysOfReading&) = delete;

 private:
  fs::path near_;
};

}  // namespace

FrameMemory::FrameMemory(const FrameOptions& options, const fs::path& near)
    : folder_(folder_for(options.cache, near)),
      bytes_(options.memory_mb ? *options.memory_mb * 1'000'000 : io::memory_bytes() / 2),
      store_(folder_, bytes_) {}

dataset::Acquisitions FrameMemory::read(SessionOptions options, std::uint64_t bytes_beside_a_frame) {
  const ArraysOfReading on_disk(folder_.folder, bytes_);
  options.store = &store_;
  dataset::Acquisitions data = read_data(options);
  store_.give_back(data.acquisitions, bytes_beside_a_frame);
  return data;
}

void FrameMemory::run_estimators(dataset::Acquisitions& data, bool json, const dataset::IsWanted& is_wanted,
                                 int bound_frames) const {
  const ArraysOfReading on_disk(folder_.folder, bytes_);
  app::run_estimators(data, json, is_wanted, bound_frames);
}

std::string FrameMemory::text() const {
  const std::uint64_t in_memory = store_.bytes_in_memory(), on_disk = store_.bytes_on_disk();
  if (on_disk == 0)
    return fmt::format("frames in memory{} (limit {})", in_memory > 0 ? ", packed" : "", bytes_text(bytes_));
  return fmt::format("frames: {} % fit in {} of memory; {} on the disk in {}",
                     100 * in_memory / (in_memory + on_disk), bytes_text(bytes_), bytes_text(on_disk),
                     printable(store_.place().string()));
}

void FrameMemory::add_to(nlohmann::json& object) const {
  object["memory_bytes"] = bytes_;
  object["frames_in_memory_bytes"] = store_.bytes_in_memory();
  object["frames_on_disk_bytes"] = store_.bytes_on_disk();
}

}  // namespace thermorig::app

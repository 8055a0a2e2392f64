// SPDX-License-Identifier: MIT
#include "thermorig/learning/dataset/frame_store.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cerrno>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <mutex>
#include <utility>
#include <vector>

#include "thermorig/core/error.h"
#include "thermorig/core/frame.h"
#include "thermorig/io/files/descriptor.h"

namespace thermorig::dataset {

namespace {

namespace fs = std::filesystem;

constexpr std::uint64_t frame_bytes = frame_pixels * sizeof(float);

[[noreturn]] void refuse_disk(const char* what, int error_number, const fs::path& place) {
  throw Error(ExitCode::storage, fmt::format("{}: {}", what, std::strerror(error_number)), place.string(),
              "check the disk (dmesg), or choose another one with --cache FOLDER");
}

/// A file without a name, which only grows.
class FrameFile {
 public:
  explicit FrameFile(FrameFolder folder) : folder_(std::move(folder)) {}
  ~FrameFile() {
    if (file_ >= 0) ::close(file_);
  }
  FrameFile(const FrameFile&) = delete;
  FrameFile& operator=(const FrameFile&) = delete;

  /// Where so many bytes may be written, whose room is taken. Not from two threads at once.
  std::uint64_t take_room(std::uint64_t bytes) {
    const bool has_room = file_ < 0 ? open(bytes) : files::grow_unlinked(file_, bytes_, bytes);
    if (!has_room)
      throw Error(
          ExitCode::storage,
          fmt::format("there is no room for frames that do not fit in memory, {} MB after {} MB",
                      bytes / 1'000'000 + 1, bytes_ / 1'000'000),
          place().string(),
          "free some space, choose a folder on another disk with --cache FOLDER, or allow more memory "
          "with --memory MB");
    return std::exchange(bytes_, bytes_ + bytes);
  }

  void write(std::uint64_t at, std::span<const std::byte> left) const {
    while (!left.empty()) {
      const ssize_t written = ::pwrite(file_, left.data(), left.size(), static_cast<off_t>(at));
      if (written < 0 && errno == EINTR) continue;
      if (written <= 0) refuse_disk("frames cannot be written", written < 0 ? errno : ENOSPC, place());
      left = left.subspan(static_cast<std::size_t>(written));
      at += static_cast<std::uint64_t>(written);
    }
  }

  void read(std::uint64_t at, std::span<std::byte> left) const {
    while (!left.empty()) {
      const ssize_t got = ::pread(file_, left.data(), left.size(), static_cast<off_t>(at));
      if (got < 0 && errno == EINTR) continue;
      if (got <= 0) refuse_disk("frames cannot be read again", got < 0 ? errno : EIO, place());
      left = left.subspan(static_cast<std::size_t>(got));
      at += static_cast<std::uint64_t>(got);
    }
  }

  void announce(std::uint64_t at, std::uint64_t bytes) const {
    ::posix_fadvise(file_, static_cast<off_t>(at), static_cast<off_t>(bytes), POSIX_FADV_WILLNEED);
  }

  std::uint64_t bytes() const { return bytes_; }

  /// The folder that was found, else the first that was tried.
  fs::path place() const {
    std::error_code hidden;
    const fs::path found =
        file_ < 0 ? "" : fs::read_symlink("/proc/self/fd/" + std::to_string(file_), hidden);
    return found.empty() ? folder_.folder : found.parent_path();
  }

 private:
  bool open(std::uint64_t bytes) {
    file_ = folder_.is_only_choice ? files::open_unlinked_in(folder_.folder, bytes)
                                   : files::open_unlinked(folder_.folder / "frames", bytes);
    return file_ >= 0;
  }

  FrameFolder folder_;
  int file_ = -1;
  std::uint64_t bytes_ = 0;
};

/// The pixels of an acquisition: whole hundredths of a degree, or floats where a bit would be lost.
struct Packed {
  std::vector<std::byte> bytes;
  bool as_hundredths = false;

  std::size_t frame_bytes() const {
    return frame_pixels * (as_hundredths ? sizeof(std::int16_t) : sizeof(float));
  }
};

float temp_c_of(std::int16_t hundredths) {
  return static_cast<float>(hundredths) / 100.0F;
}

std::span<const std::byte> bytes_of(const auto& values) {
  return std::as_bytes(std::span(values));
}

Packed pack(const std::vector<float>& temp_c) {
  constexpr float most = std::numeric_limits<std::int16_t>::max() + 0.25F;  // scaling has rounded
  std::vector<std::int16_t> hundredths;
  hundredths.reserve(temp_c.size());
  for (const float one : temp_c) {
    const float scaled = one * 100.0F;
    if (!(std::abs(scaled) <= most)) break;
    const auto whole = static_cast<std::int16_t>(std::lrint(scaled));
    if (std::bit_cast<std::uint32_t>(temp_c_of(whole)) != std::bit_cast<std::uint32_t>(one)) break;
    hundredths.push_back(whole);
  }
  const bool fits = hundredths.size() == temp_c.size();
  const std::span<const std::byte> kept = fits ? bytes_of(hundredths) : bytes_of(temp_c);
  return {{kept.begin(), kept.end()}, fits};
}

/// In memory, or in a file.
class Frames final : public network::StoredFrames {
 public:
  explicit Frames(Packed packed) : packed_(std::move(packed)) {}
  Frames(Packed packed, std::shared_ptr<const FrameFile> file, std::uint64_t at)
      : packed_({{}, packed.as_hundredths}), file_(std::move(file)), at_(at) {}

  void read(std::size_t first, std::span<float> temp_c) const override {
    constexpr std::size_t frames_at_once = 8;
    std::array<std::byte, frames_at_once * frame_bytes> part;
    for (; !temp_c.empty(); first += frames_at_once) {
      const auto out = temp_c.first(std::min(temp_c.size(), frames_at_once * frame_pixels));
      const std::size_t begin = first * packed_.frame_bytes();
      const auto bytes = std::span(part).first(out.size() / frame_pixels * packed_.frame_bytes());
      if (file_) file_->read(at_ + begin, bytes);
      unpack(file_ ? bytes.data() : &packed_.bytes[begin], out);
      temp_c = temp_c.subspan(out.size());
    }
  }

  void announce(std::size_t first, std::size_t frames) const override {
    if (file_) file_->announce(at_ + first * packed_.frame_bytes(), frames * packed_.frame_bytes());
  }

 private:
  void unpack(const std::byte* from, std::span<float> temp_c) const {
    if (!packed_.as_hundredths) {
      std::memcpy(temp_c.data(), from, temp_c.size_bytes());
      return;
    }
    for (float& one : temp_c) {
      std::int16_t hundredths = 0;
      std::memcpy(&hundredths, from, sizeof hundredths);
      one = temp_c_of(hundredths);
      from += sizeof hundredths;
    }
  }

  Packed packed_;  // of a file: no bytes
  std::shared_ptr<const FrameFile> file_;
  std::uint64_t at_ = 0;  // in the file
};

}  // namespace

struct FrameStore::Parts {
  Parts(FrameFolder folder, std::uint64_t most)
      : file(std::make_shared<FrameFile>(std::move(folder))), memory_bytes(most) {}

  bool fits_in_memory(std::uint64_t bytes) {
    const std::lock_guard lock(mutex);
    if (in_memory_bytes + bytes > memory_bytes) return false;
    in_memory_bytes += bytes;
    return true;
  }

  std::uint64_t take_room(std::uint64_t bytes) {
    const std::lock_guard lock(mutex);
    return file->take_room(bytes);
  }

  std::shared_ptr<const network::StoredFrames> stored(Packed packed) {
    if (fits_in_memory(packed.bytes.size())) return std::make_shared<Frames>(std::move(packed));
    const std::uint64_t at = take_room(packed.bytes.size());
    file->write(at, packed.bytes);
    return std::make_shared<Frames>(std::move(packed), file, at);
  }

  mutable std::mutex mutex;
  std::shared_ptr<FrameFile> file;
  const std::uint64_t memory_bytes;
  std::uint64_t in_memory_bytes = 0;
};

FrameStore::FrameStore(FrameFolder folder, std::uint64_t memory_bytes)
    : parts_(std::make_unique<Parts>(std::move(folder), memory_bytes)) {}

FrameStore::~FrameStore() = default;

void FrameStore::take(network::Acquisition& acquisition) {
  if (acquisition.temp_c.empty()) return;
  acquisition.stored = parts_->stored(pack(acquisition.temp_c));
  acquisition.temp_c = std::vector<float>();
}

void FrameStore::give_back(std::span<network::Acquisition> acquisitions, std::uint64_t bytes_beside_a_frame) {
  std::uint64_t frames = 0;
  for (const network::Acquisition& acquisition : acquisitions) frames += acquisition.frames();
  if (bytes_on_disk() > 0 || frames * (frame_bytes + bytes_beside_a_frame) > parts_->memory_bytes) return;
  for (network::Acquisition& acquisition : acquisitions) {
    if (!acquisition.stored) continue;
    acquisition.temp_c.resize(acquisition.frames() * frame_pixels);
    acquisition.stored->read(0, acquisition.temp_c);
    acquisition.stored = nullptr;
  }
  const std::lock_guard lock(parts_->mutex);
  parts_->in_memory_bytes = 0;
}

std::uint64_t FrameStore::bytes_in_memory() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->in_memory_bytes;
}

std::uint64_t FrameStore::bytes_on_disk() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->file->bytes();
}

fs::path FrameStore::place() const {
  const std::lock_guard lock(parts_->mutex);
  return parts_->file->bytes() == 0 ? fs::path() : parts_->file->place();
}

}  // namespace thermorig::dataset

// SPDX-License-Identifier: MIT
#include "thermorig/storage/view/packed_session.h"

#include <fmt/format.h>
#include <libdeflate.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <memory>
#include <new>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "thermorig/core/base64.h"
#include "thermorig/core/error.h"
#include "thermorig/core/frame.h"
#include "thermorig/core/image_bytes.h"
#include "thermorig/core/printable.h"
#include "thermorig/storage/view/session_view.h"

namespace thermorig::view {

namespace {

constexpr std::size_t packed_images = 64;  // of a block

/// What stands for a pixel that is not a number.
constexpr unsigned char no_code = 255;

constexpr int greatest_code = no_code - 1;
constexpr std::int16_t no_temperature = std::numeric_limits<std::int16_t>::min();

std::int16_t hundredths_at(std::string_view images, std::size_t pixel) {
  std::int16_t value = 0;
  std::memcpy(&value, images.data() + pixel * sizeof value, sizeof value);
  return value;
}

/// Codes of a block's pixels.
struct Scale {
  int least = 0;  // hundredths
  int range = 0;

  explicit Scale(std::string_view images) {
    int low = std::numeric_limits<std::int16_t>::max(), high = no_temperature;
    for (std::size_t pixel = 0; pixel < images.size() / 2; ++pixel) {
      const int value = hundredths_at(images, pixel);
      if (value == no_temperature) continue;
      low = std::min(low, value);
      high = std::max(high, value);
    }
    if (low > high) return;
    least = low;
    range = std::max(high - low, greatest_code);
  }

  float step_c() const { return static_cast<float>(0.01 * std::max(range, greatest_code) / greatest_code); }

  unsigned char code_of(std::int16_t value) const {
    if (value == no_temperature) return no_code;
    return static_cast<unsigned char>(((value - least) * greatest_code + range / 2) / range);
  }
};

void append_float(std::string& block, float value) {
  char bytes[sizeof value];
  std::memcpy(bytes, &value, sizeof value);
  block.append(bytes, sizeof value);
}

/// Images with a byte a pixel: least temperature and step in degC as two little-endian 32-bit floats, then
/// the codes of each image less those of the one before (modulo 256), of the first as they are. A pixel is
/// least + code * step, within half a step; the steps are as fine as the block's range allows, and a
/// hundredth at least. `images`: image_bytes each, packed_images at most.
std::string packed_block(std::string_view images) {
  const Scale scale(images);
  const std::size_t pixels = images.size() / 2;
  std::string block;
  block.reserve(2 * sizeof(float) + pixels);
  append_float(block, static_cast<float>(0.01 * scale.least));
  append_float(block, scale.step_c());
  for (std::size_t pixel = 0; pixel < pixels; ++pixel) {
    const unsigned before =
        pixel < frame_pixels ? 0 : scale.code_of(hundredths_at(images, pixel - frame_pixels));
    block += static_cast<char>(scale.code_of(hundredths_at(images, pixel)) - before);
  }
  return block;
}

constexpr int deflate_level = 9;
constexpr double rows_share = 0.6;         // of the room that rows may take
constexpr std::size_t element_bytes = 80;  // what stands around a part in a document

std::string base64_of(std::string_view bytes) {
  return base64({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});
}

class Deflater {
 public:
  Deflater() : compressor_(libdeflate_alloc_compressor(deflate_level), libdeflate_free_compressor) {
    if (compressor_ == nullptr) throw std::bad_alloc();
  }

  PackedPart part(std::string name, std::string_view bytes) const {
    std::string packed(libdeflate_zlib_compress_bound(compressor_.get(), bytes.size()), '\0');
    packed.resize(libdeflate_zlib_compress(compressor_.get(), bytes.data(), bytes.size(), packed.data(),
                                           packed.size()));
    return {std::move(name), base64_of(packed)};
  }

 private:
  std::unique_ptr<libdeflate_compressor, decltype(&libdeflate_free_compressor)> compressor_;
};

std::size_t bytes_of(const PackedPart& part) {
  return part.base64.size() + part.name.size() + element_bytes;
}

/// The images of every n-th frame, packed block by block, as long as there is room.
class ImagePacker {
 public:
  ImagePacker(const SessionView& view, const Deflater& deflater, std::uint64_t every, std::size_t room)
      : view_(view), deflater_(deflater), every_(every), room_(room) {}

  /// The share of the session that there was room for: 1 if all of it.
  double pack() {
    for (std::uint64_t first = 0; first < view_.frames() && !is_full(); first += session::most_images)
      take(first, std::min(session::most_images, view_.frames() - first));
    if (!waiting_.empty() && !is_full()) finish_block();
    return is_full() ? static_cast<double>(done_) / static_cast<double>(view_.frames()) : 1.0;
  }

  std::vector<PackedPart> take_parts() { return std::move(parts_); }

 private:
  bool is_full() const { return bytes_ > room_; }

  void take(std::uint64_t first, std::uint64_t count) {
    const std::string images = view_.images({first, count});
    for (std::uint64_t i = (every_ - first % every_) % every_; i < count && !is_full(); i += every_) {
      waiting_.append(images, i * image_bytes, image_bytes);
      done_ = first + i + 1;
      if (waiting_.size() == packed_images * image_bytes) finish_block();
    }
  }

  void finish_block() {
    parts_.push_back(deflater_.part(fmt::format("images-{}", parts_.size()), packed_block(waiting_)));
    bytes_ += bytes_of(parts_.back());
    waiting_.clear();
  }

  const SessionView& view_;
  const Deflater& deflater_;
  const std::uint64_t every_;
  const std::size_t room_;
  std::vector<PackedPart> parts_;
  std::string waiting_;
  std::size_t bytes_ = 0;
  std::uint64_t done_ = 0;  // frames
};

std::string ordinal(std::uint64_t number) {
  const std::uint64_t last = number % 10;
  const bool is_teen = number / 10 % 10 == 1;
  const char* const ending = is_teen ? "th" : last == 1 ? "st" : last == 2 ? "nd" : last == 3 ? "rd" : "th";
  return fmt::format("{}{}", number, ending);
}

std::string left_out_of(const PackedSession& packed) {
  if (packed.image_every == 1) return "";
  const std::string rows =
      packed.row_every == 1 ? "all rows" : fmt::format("a row of every {} frame", ordinal(packed.row_every));
  return fmt::format(
      "This file has {}, and an image of every {} of {} frames: all would make it larger than it may be. "
      "thermorig view shows them.",
      rows, ordinal(packed.image_every), packed.frames);
}

/// Facts and rows, of so many frames that they leave room for images.
class SessionPacker {
 public:
  SessionPacker(const std::filesystem::path& path, std::size_t bytes_max)
      : path_(path), bytes_max_(bytes_max - std::min(bytes_max, packing_bytes)) {}

  PackedSession pack() {
    pack_rows();
    pack_images();
    packed_.left_out = left_out_of(packed_);
    packed_.parts.push_back({"packing", base64_of(packing_json())});
    return std::move(packed_);
  }

 private:
  static constexpr std::size_t packing_bytes = 1000;

  void pack_rows() {
    for (std::uint64_t every = 1;;) {
      view_.emplace(path_, every);
      packed_.parts = {deflater_.part("facts", view_->facts()), deflater_.part("rows", view_->rows())};
      packed_.row_every = every;
      const double share =
          static_cast<double>(bytes_of(packed_.parts[1])) / (rows_share * static_cast<double>(bytes_max_));
      if (share <= 1.0) break;
      if (every >= view_->frames()) refuse();
      every = std::max(every + 1, static_cast<std::uint64_t>(std::ceil(share * static_cast<double>(every))));
    }
    packed_.facts = view_->facts();
    packed_.frames = view_->frames();
  }

  void pack_images() {
    const std::size_t used = bytes_of(packed_.parts[0]) + bytes_of(packed_.parts[1]);
    if (used >= bytes_max_) refuse();
    const std::uint64_t step = packed_.row_every;
    for (std::uint64_t every = step;;) {
      ImagePacker images(*view_, deflater_, every, bytes_max_ - used);
      const double share = images.pack();
      if (share < 1.0 && every <= packed_.frames) {
        const double wanted = static_cast<double>(every) / std::max(share, 1e-6) / static_cast<double>(step);
        every = std::max(every + step, step * static_cast<std::uint64_t>(std::ceil(std::min(wanted, 1e9))));
        continue;
      }
      if (share < 1.0) refuse();
      packed_.image_every = every;
      for (PackedPart& part : images.take_parts()) packed_.parts.push_back(std::move(part));
      return;
    }
  }

  [[noreturn]] void refuse() const {
    throw Error(ExitCode::failed, "what is known of this session takes more room than a page in a file has",
                path_.string(), "thermorig view " + shell_word(path_.string()));
  }

  /// Its texts need no escapes.
  std::string packing_json() const {
    return fmt::format(R"({{"every":{},"left_out":"{}"}})", packed_.image_every, packed_.left_out);
  }

  const std::filesystem::path path_;
  const std::size_t bytes_max_;
  const Deflater deflater_;
  std::optional<SessionView> view_;
  PackedSession packed_;
};

}  // namespace

PackedSession packed_session(const std::filesystem::path& path, std::size_t bytes_max) {
  return SessionPacker(path, bytes_max).pack();
}

}  // namespace thermorig::view

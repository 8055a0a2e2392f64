// SPDX-License-Identifier: MIT
#include "thermorig/estimators/map_file/map_file.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <concepts>
#include <cstring>
#include <fstream>
#include <span>

#include "thermorig/core/error.h"
#include "thermorig/io/files/replaced_file.h"
#include "thermorig/io/files/whole_file.h"

namespace thermorig::map_file {

namespace {

static_assert(std::endian::native == std::endian::little, "a map's file holds little-endian values");

constexpr std::string_view magic = "THRMAP01";  // of a plain lens
constexpr std::string_view magic_of_lens = "THRMAP02";
constexpr std::size_t version_digits = 2;  // at the end of magic
constexpr std::size_t crc_bytes = sizeof(std::uint32_t);
constexpr const char* noun = "the map";
// A lens may have been calibrated meanwhile, or again: of the field of view and of the corners, and degrees.
constexpr double same_lens = 0.02, same_distortion = 0.02, same_direction_deg = 1.5;

bool begins_as_map(std::string_view bytes) {
  return bytes.starts_with(magic.substr(0, magic.size() - version_digits));
}

std::uint32_t crc_of(std::string_view bytes) {
  return static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
}

/// What a value may be.
struct Range {
  double low = 0.0, high = 0.0;
};
constexpr Range fields_deg{0.5, 200.0}, distortions{-0.2, 0.2}, directions_deg{-15.0, 15.0},
    reference_c{-100.0, 500.0}, temp_k{-1e5, 1e5};
constexpr Range variance_k2{0.0, 1e9}, offset_deg{-3600.0, 3600.0}, root_deg{-3600.0, 3600.0};
constexpr Range pixel_k{-1e5, 1e5}, pixel_variance_k2{1e-3, 1e9}, flag{0.0, 1.0}, known{0.0, 2.0},
    row_order{0.0, 2.0};

[[noreturn]] void refuse(const std::string& what, const std::string& where) {
  throw Error(
      ExitCode::not_a_session, what, where,
      "make it again from a recorded session: thermorig live --replay SESSION --speed max --map NEW_FILE");
}

/// "kitchen-2.map" beside "kitchen.map".
std::filesystem::path numbered(std::filesystem::path path, int number) {
  return path.replace_filename(
      fmt::format("{}-{}{}", path.stem().string(), number, path.extension().string()));
}

/// All that stands in a file, in its order: for whoever writes it, and for whoever reads it.
template <typename Stored, typename Each>
void for_all(Stored& stored, bool has_plain_lens, Each each) {
  auto& map = stored.map;
  each("simulated", stored.simulated, flag);
  each("environment", stored.environment);
  each("rig", stored.rig);
  each("time", stored.made_utc);
  each("creator", stored.creator);
  each("field of view", map.lens.field_of_view_deg, fields_deg);
  each("order of the columns", map.lens.mirrored, flag);
  if (!has_plain_lens) {
    each("distortion", map.lens.distortion, distortions);
    each("tilt", map.lens.tilt_deg, directions_deg);
    each("roll", map.lens.roll_deg, directions_deg);
  }
  each("order of the rows", map.rows, row_order);
  each("reference", map.reference_c, reference_c);
  each("temperatures", std::span(map.temp_k), temp_k);
  each("variances", std::span(map.variance_k2), variance_k2);
  each("what was seen", std::span(map.seen), flag);
  each("offsets", std::span(map.offset_deg), offset_deg);
  each("covariance", std::span(map.offset_root_deg), root_deg);
  each("what is known of offsets", std::span(map.offset_known), known);
  each("pixels' offsets", std::span(map.pixel_offset_k), pixel_k);
  each("pixels' variances", std::span(map.pixel_variance_k2), pixel_variance_k2);
}

class Writer {
 public:
  explicit Writer(std::string_view begin) : text_(begin) {}

  template <typename Value>
  void operator()(const char*, const Value& value, const Range&) {
    put(std::as_bytes(std::span(&value, 1)));
  }
  template <typename Value, std::size_t extent>
  void operator()(const char*, std::span<Value, extent> values, const Range&) {
    put(std::as_bytes(values));
  }
  void operator()(const char*, const std::string& text) {
    const auto length = static_cast<std::uint8_t>(std::min(text.size(), name_bytes_max));
    put(std::as_bytes(std::span(&length, 1)));
    text_.append(text, 0, length);
  }
  std::string& text() { return text_; }

 private:
  void put(std::span<const std::byte> bytes) {
    text_.append(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  }
  std::string text_;
};

class Reader {
 public:
  Reader(std::string_view bytes, const std::string& where) : left_(bytes), where_(where) {}

  void operator()(const char* name, bool& value, const Range& range) {
    std::uint8_t byte = 0;
    (*this)(name, byte, range);
    value = byte != 0;
  }
  template <typename Value>
  void operator()(const char* name, Value& value, const Range& range) {
    (*this)(name, std::span(&value, 1), range);
  }
  template <typename Value, std::size_t extent>
  void operator()(const char* name, std::span<Value, extent> values, const Range& range) {
    std::memcpy(values.data(), take(values.size_bytes()).data(), values.size_bytes());
    for (const Value value : values) {
      const auto number = static_cast<double>(value);
      if (!(number >= range.low && number <= range.high))  // false for NaN too
        refuse(fmt::format("the map is damaged: among {} is {}, outside {} to {}", name, number, range.low,
                           range.high),
               where_);
    }
  }
  void operator()(const char*, std::string& text) {
    std::uint8_t length = 0;
    std::memcpy(&length, take(1).data(), 1);
    text = take(length);
  }
  void require_end() const {
    if (!left_.empty()) refuse("the map is damaged: it is longer than a map", where_);
  }

 private:
  std::string_view take(std::size_t bytes) {
    if (bytes > left_.size()) refuse("the map is damaged: it is shorter than a map", where_);
    const std::string_view taken = left_.substr(0, bytes);
    left_.remove_prefix(bytes);
    return taken;
  }

  std::string_view left_;
  const std::string& where_;
};

}  // namespace

std::string bytes_of(const StoredMap& stored) {
  const bool has_plain_lens = stored.map.lens.is_plain();
  Writer writer(has_plain_lens ? magic : magic_of_lens);
  for_all(stored, has_plain_lens, [&](const auto&... each) { writer(each...); });
  const std::uint32_t crc = crc_of(writer.text());
  writer.text().append(reinterpret_cast<const char*>(&crc), sizeof(crc));
  return std::move(writer.text());
}

bool is_map(const std::filesystem::path& path) {
  std::error_code hidden;
  if (!std::filesystem::is_regular_file(path, hidden)) return false;
  std::array<char, magic.size()> first{};
  std::ifstream(path, std::ios::binary).read(first.data(), first.size());
  return begins_as_map({first.data(), first.size()});
}

StoredMap map_from(std::string_view bytes, const std::string& where) {
  if (!begins_as_map(bytes)) refuse("this is not a map of thermorig", where);
  const bool has_plain_lens = bytes.starts_with(magic);
  if (!has_plain_lens && !bytes.starts_with(magic_of_lens))
    refuse("the map is of another version of thermorig", where);
  if (bytes.size() < magic.size() + crc_bytes) refuse("the map is damaged: it is shorter than a map", where);
  const std::string_view body = bytes.substr(0, bytes.size() - crc_bytes);
  std::uint32_t crc = 0;
  std::memcpy(&crc, bytes.data() + body.size(), sizeof(crc));
  if (crc != crc_of(body)) refuse("the map is damaged: its check sum does not fit", where);
  Reader reader(body.substr(magic.size()), where);
  StoredMap stored;
  for_all(stored, has_plain_lens, [&](auto&&... each) { reader(each...); });
  reader.require_end();
  return stored;
}

StoredMap read_map(const std::filesystem::path& path) {
  const auto bytes = files::read_whole(path, file_bytes_max, noun);
  return map_from({reinterpret_cast<const char*>(bytes.data()), bytes.size()}, path.string());
}

files::ReplacedFile replaced_map(const std::filesystem::path& path) {
  return files::ReplacedFile(path, noun);
}

std::filesystem::path write_map(files::PartFile& part, const StoredMap& stored) {
  const std::string bytes = bytes_of(stored);
  map_from(bytes, part.path().string());  // what could not be read again takes no other map's place
  part.write(std::as_bytes(std::span(bytes)));
  part.sync();
  if (part.publish_unless_taken()) return part.path();
  for (int number = 2;; ++number) {
    std::filesystem::path free = numbered(part.path(), number);
    std::error_code hidden;  // what cannot be looked at is refused when it is written
    if (!std::filesystem::exists(free, hidden) && files::write_whole_if_free(free, bytes, noun)) return free;
  }
}

void require_lens(const odometer::Map& map, const CameraProfile& camera, const std::string& where) {
  const odometer::Map::Lens &its = map.lens, own(camera);
  const auto refuse_lens = [&](const std::string& what) {
    throw Error(ExitCode::bad_usage, what, where,
                "name a new file for this rig, or check its profile: thermorig calibrate orientation, "
                "thermorig calibrate lens");
  };
  if (std::abs(its.field_of_view_deg - own.field_of_view_deg) > same_lens * own.field_of_view_deg)
    refuse_lens(fmt::format("the map was made with a lens of {:.4g} degrees, and this rig's has {:.4g}",
                            its.field_of_view_deg, own.field_of_view_deg));
  if (its.mirrored != own.mirrored)
    refuse_lens(fmt::format("the map was made with columns that are {}mirrored, and this rig's are{}",
                            its.mirrored ? "" : "not ", own.mirrored ? "" : " not"));
  const auto require_same = [&](const char* what, double of_map, double of_rig, double most) {
    if (std::abs(of_map - of_rig) > most)
      refuse_lens(fmt::format("the map was made with a lens whose {} is {:.3g}, and this rig's is {:.3g}",
                              what, of_map, of_rig));
  };
  require_same("distortion", its.distortion, own.distortion, same_distortion);
  require_same("tilt in degrees", its.tilt_deg, own.tilt_deg, same_direction_deg);
  require_same("roll in degrees", its.roll_deg, own.roll_deg, same_direction_deg);
}

double seen_share(const odometer::Map& map) {
  const auto seen = std::count(map.seen.begin(), map.seen.end(), std::uint8_t{1});
  return static_cast<double>(seen) / static_cast<double>(map.seen.size());
}

}  // namespace thermorig::map_file

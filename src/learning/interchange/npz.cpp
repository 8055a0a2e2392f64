// SPDX-License-Identifier: MIT
#include "thermorig/learning/interchange/formats.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <array>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "checked_sink.h"
#include "facts.h"
#include "thermorig/core/frame.h"
#include "thermorig/learning/interchange/table.h"
#include "thermorig/network/scaling.h"
#include "thermorig/network/window_index.h"

namespace thermorig::interchange {

namespace {

/// A ZIP archive (APPNOTE 6.3) with members as they are, neither compressed nor limited to 4 GiB. A member is
/// produced twice, first for its check sum, so that nothing has to be kept or gone back to.
class ZipWriter {
 public:
  explicit ZipWriter(Sink& sink) : sink_(sink) {}

  /// `produce` writes the same bytes each time that it is called.
  void add(const std::string& name, const std::function<void(Sink&)>& produce);

  /// The central directory; the last call.
  void finish();

 private:
  struct Member {
    std::string name;
    std::uint32_t crc = 0;
    std::uint64_t size = 0, begin = 0;
  };
  void write(const std::string& bytes);
  void write_ends(std::uint64_t directory_begin);

  Sink& sink_;
  std::uint64_t written_ = 0;
  std::vector<Member> members_;
};

constexpr std::uint16_t version = 45;  // that of ZIP64
constexpr std::uint16_t utf8_names = 0x800;
constexpr std::uint16_t stored = 0;
constexpr std::uint16_t no_time = 0, first_date = 0x21;  // 1980-01-01: the same session gives the same bytes
constexpr std::uint16_t zip64_field = 1;
constexpr std::uint32_t elsewhere = 0xFFFFFFFF;  // the number stands in a field of ZIP64
constexpr std::uint16_t elsewhere_16 = 0xFFFF;

void ZipWriter::write(const std::string& bytes) {
  sink_.write(bytes);
  written_ += bytes.size();
}

void ZipWriter::add(const std::string& name, const std::function<void(Sink&)>& produce) {
  CheckedSink dry;
  produce(dry);
  members_.push_back({name, dry.crc(), dry.size(), written_});
  const auto length = static_cast<std::uint16_t>(name.size());
  std::string header = "PK\x03\x04";
  append_little_endian(header, version, utf8_names, stored, no_time, first_date, dry.crc(), elsewhere,
                       elsewhere, length, std::uint16_t{20});
  header += name;
  append_little_endian(header, zip64_field, std::uint16_t{16}, dry.size(), dry.size());
  write(header);
  produce(sink_);
  written_ += dry.size();
}

void ZipWriter::finish() {
  const std::uint64_t begin = written_;
  for (const Member& member : members_) {
    std::string entry = "PK\x01\x02";
    append_little_endian(entry, version, version, utf8_names, stored, no_time, first_date, member.crc,
                         elsewhere, elsewhere, static_cast<std::uint16_t>(member.name.size()),
                         std::uint16_t{28}, std::uint16_t{0}, std::uint16_t{0}, std::uint16_t{0},
                         std::uint32_t{0}, elsewhere);
    entry += member.name;
    append_little_endian(entry, zip64_field, std::uint16_t{24}, member.size, member.size, member.begin);
    write(entry);
  }
  write_ends(begin);
}

void ZipWriter::write_ends(std::uint64_t directory_begin) {
  const std::uint64_t directory_end = written_, count = members_.size();
  std::string ends = "PK\x06\x06";
  append_little_endian(ends, std::uint64_t{44}, version, version, std::uint32_t{0}, std::uint32_t{0}, count,
                       count, directory_end - directory_begin, directory_begin);
  ends += "PK\x06\x07";
  append_little_endian(ends, std::uint32_t{0}, directory_end, std::uint32_t{1});
  ends += "PK\x05\x06";
  append_little_endian(ends, std::uint16_t{0}, std::uint16_t{0}, elsewhere_16, elsewhere_16, elsewhere,
                       elsewhere, std::uint16_t{0});
  write(ends);
}

using Shape = std::vector<std::uint64_t>;

/// NumPy's, in the order of the alternatives of Value; text has none.
constexpr std::array<const char*, 6> type_names{"|u1", "<u2", "<u4", "<i8", "<f4", "<f8"};

/// The header of an array (NumPy's format 1.0), so that its values begin at a multiple of 64.
std::string npy_header(const std::string& type, const Shape& shape) {
  constexpr std::size_t before = 10, alignment = 64;
  std::string dictionary = fmt::format("{{'descr': '{}', 'fortran_order': False, 'shape': ({}{}), }}", type,
                                       fmt::join(shape, ", "), shape.size() == 1 ? "," : "");
  const std::size_t beyond = (before + dictionary.size() + 1) % alignment;
  dictionary.append(beyond == 0 ? 0 : alignment - beyond, ' ');
  dictionary += '\n';
  std::string header("\x93NUMPY\x01\x00", 8);
  append_little_endian(header, static_cast<std::uint16_t>(dictionary.size()));
  return header + dictionary;
}

/// Values that are made a row at a time, as `append` appends their bytes.
template <typename Append>
void write_array(Sink& sink, const std::string& header, std::size_t rows, Append append) {
  constexpr std::size_t block_bytes = 1U << 20U;
  std::string bytes = header;
  for (std::size_t row = 0; row < rows; ++row) {
    append(bytes, row);
    if (bytes.size() < block_bytes) continue;
    sink.write(std::string_view(bytes));
    bytes.clear();
  }
  sink.write(std::string_view(bytes));
}

template <typename Append>
void add_array(ZipWriter& zip, const std::string& name, const std::string& type, const Shape& shape,
               Append append) {
  zip.add(name + ".npy",
          [&](Sink& sink) { write_array(sink, npy_header(type, shape), shape.front(), append); });
}

/// Facts of the session as JSON, a string without axes.
void add_about(ZipWriter& zip, const session::Session& session) {
  const std::string text = facts_of(session).dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  zip.add("about.npy", [&](Sink& sink) {
    write_array(sink, npy_header(fmt::format("<U{}", text.size()), {}), text.size(),
                [&](std::string& bytes, std::size_t i) {
                  append_little_endian(bytes, static_cast<char32_t>(text[i]));
                });
  });
}

void add_column(ZipWriter& zip, const Column& column, std::size_t rows) {
  if (column.type >= type_names.size()) return;
  add_array(zip, column.name, type_names[column.type], {rows}, [&](std::string& bytes, std::size_t row) {
    std::visit(
        [&](const auto& value) {
          if constexpr (!std::is_same_v<std::decay_t<decltype(value)>, std::string>)
            append_little_endian(bytes, value);
        },
        column.at(row));
  });
}

template <typename Number>
void append_numbers(std::string& bytes, std::span<const Number> numbers) {
  bytes.append(reinterpret_cast<const char*>(numbers.data()), numbers.size_bytes());
}

/// The windows of one acquisition.
class WindowArrays {
 public:
  WindowArrays(const session::Session& session, const network::Acquisition& acquisition, WindowShape shape)
      : session_(session),
        acquisition_(acquisition),
        shape_{.frames = shape.frames, .reduction = shape.reduction},
        windows_(network::find_windows({&acquisition, 1}, shape.frames)),
        image_(shape_.pixels()) {}

  std::size_t count() const { return windows_.size(); }

  void add_to(ZipWriter& zip) {
    const std::uint64_t count = windows_.size();
    add_array(zip, "images", "<f4",
              {count, static_cast<std::uint64_t>(shape_.frames), static_cast<std::uint64_t>(shape_.rows()),
               static_cast<std::uint64_t>(shape_.columns())},
              [&](std::string& bytes, std::size_t i) { append_images(bytes, windows_[i]); });
    add(zip, "label_dps", "<f4", [&](const auto& window) { return rates(window).label_dps; });
    add_label(zip, "corrected_dps", &LabelledSample::rate_corrected_dps);
    add_label(zip, "shaft_dps", &LabelledSample::rate_shaft_dps);
    if (has_measured_shaft(session_.raw)) add_label(zip, "measured_dps", &LabelledSample::rate_measured_dps);
    add(zip, "gyro_dps", "<f4", [&](const auto& window) { return rates(window).gyro_dps; });
    add(zip, "last", "<u4", [](const auto& window) { return window.last; });
    add(zip, "middle_s", "<f8", [&](const auto& window) {
      return to_s(acquisition_.time[window.last] - session_.raw.header.time_reference);
    });
  }

 private:
  template <typename Get>
  void add(ZipWriter& zip, const std::string& name, const std::string& type, Get get) {
    add_array(zip, name, type, {windows_.size()},
              [&](std::string& bytes, std::size_t i) { append_little_endian(bytes, get(windows_[i])); });
  }

  void add_label(ZipWriter& zip, const std::string& name, float LabelledSample::*rate_dps) {
    std::vector<float> rates_dps;
    rates_dps.reserve(session_.samples.size());
    for (const LabelledSample& sample : session_.samples) rates_dps.push_back(sample.*rate_dps);
    add(zip, name, "<f4",
        [&](const auto& window) { return network::mean_rate(rates_dps, window, shape_.frames); });
  }

  network::WindowRates rates(const network::Window& window) const {
    return network::rates_of(acquisition_, window, shape_.frames);
  }

  /// In degrees: neither shifted nor scaled.
  void append_images(std::string& bytes, const network::Window& window) {
    const auto frames = static_cast<std::size_t>(shape_.frames);
    const std::span<const float> pixels(acquisition_.temp_c);
    for (std::size_t frame = window.last + 1 - frames; frame <= window.last; ++frame) {
      network::prepare_frame(pixels.subspan(frame * frame_pixels, frame_pixels), shape_, {}, image_);
      append_numbers(bytes, std::span<const float>(image_));
    }
  }

  const session::Session& session_;
  const network::Acquisition& acquisition_;
  network::Shape shape_;
  std::vector<network::Window> windows_;
  std::vector<float> image_;
};

}  // namespace

void write_rows_npz(const session::Session& session, Sink& sink) {
  ZipWriter zip(sink);
  add_about(zip, session);
  const Table table = table_of(session, "samples");
  for (const Column& column : table.columns) add_column(zip, column, table.rows);
  add_array(zip, "temperature", "<f4", {session.frames.size(), frame_rows, frame_columns},
            [&](std::string& bytes, std::size_t row) {
              append_numbers(bytes, std::span<const float>(session.frames[row].frame.temp_c));
            });
  zip.finish();
}

std::size_t write_windows_npz(const session::Session& session, const network::Acquisition& acquisition,
                              WindowShape shape, Sink& sink) {
  ZipWriter zip(sink);
  add_about(zip, session);
  WindowArrays arrays(session, acquisition, shape);
  arrays.add_to(zip);
  zip.finish();
  return arrays.count();
}

}  // namespace thermorig::interchange

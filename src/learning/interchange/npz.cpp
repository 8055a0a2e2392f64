// SPDX-License-Identifier: MIT
#include "thermorig/learning/interchange/npz.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <array>
#include <nlohmann/json.hpp>

#include "facts.h"
#include "little_endian_text.h"
#include "thermorig/core/frame.h"
#include "thermorig/learning/interchange/table.h"
#include "thermorig/network/scaling.h"
#include "thermorig/network/window_index.h"
#include "zip_writer.h"

namespace thermorig::interchange {

namespace {

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

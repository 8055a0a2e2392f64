// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "column.h"
#include "format.h"
#include "hdf5_handle.h"
#include "thermorig/core/time.h"

namespace thermorig::session {

/// What a reader must know of the file as a whole.
struct FileFacts {
  std::uint64_t bytes = 0;
  FormatVersion version;
  HostTime reference{};
  std::uint64_t bytes_there =
      0;  // fewer than `bytes`: it was cut short, and zeros stand in place of the rest

  bool is_cut() const { return bytes_there < bytes; }
};

/// Reads one group with the interface of GroupWriter. Nothing in the file is believed: types, ranks, shapes,
/// filters and sizes are checked before anything is allocated, and the values against their CRC. Throws
/// Hdf5Failure with what is wrong. Rows is a vector, or what takes rows as one does (passed_rows.h). Of a
/// file that was cut short an axis has the rows that are left, and no sum of a whole column is known.
class GroupReader {
  template <typename Rows>
  using RowOf = typename Rows::value_type;

 public:
  GroupReader(hid_t file, const std::string& path, const FileFacts& facts);

  hid_t id() const { return group_.get(); }

  /// Of the format that the file has: what came later is not in it.
  FormatVersion version() const { return facts_.version; }

  template <typename Stored, typename Rows, typename At>
  void axis(const Column& info, Rows& rows, At at) {
    begin_rows(info.name, rows_max, sizeof(RowOf<Rows>));
    rows.resize(rows_);
    this->field<Stored>(info, rows, at);
  }

  template <typename Rows>
  void bare_axis(const char* /*name*/, const char* /*long_name*/, Rows& rows, const char* counted_by,
                 std::uint64_t rows_limit = rows_max) {
    begin_rows(counted_by, rows_limit, sizeof(RowOf<Rows>));
    rows.resize(rows_);
  }
  template <typename Rows>
  void share_axis(Rows& rows) const {
    rows.resize(rows_);
  }

  template <typename Rows, typename At>
  void time_axis(const Column& info, Rows& rows, At at, std::uint64_t rows_limit = rows_max) {
    begin_rows(info.name, rows_limit, sizeof(RowOf<Rows>));
    rows.resize(rows_);
    time_column(info, rows, at);
  }
  template <typename Rows, typename At>
  void time_column(const Column& info, Rows& rows, At at) {
    const auto set = [this, at](RowOf<Rows>& row, double seconds) {
      std::invoke(at, row) = facts_.reference + checked_time(seconds);
    };
    this->column<double>(info, rows, nullptr, set);
  }

  template <typename Stored, typename Rows, typename Get, typename Set>
  void column(const Column& info, Rows& rows, Get /*get*/, Set set) {
    const auto take = [&rows, &set](std::size_t first, std::size_t count, const std::byte* in) {
      for (std::size_t i = 0; i < count; ++i, in += sizeof(Stored)) {
        Stored value;
        std::memcpy(&value, in, sizeof value);
        set(rows[first + i], value);
      }
    };
    read(info, stored_type<Stored>(), sizeof(Stored), {}, take);
  }

  template <typename Stored, typename Rows, typename At>
  void field(const Column& info, Rows& rows, At at) {
    const auto set = [at](RowOf<Rows>& row, Stored value) { std::invoke(at, row) = value; };
    this->column<Stored>(info, rows, nullptr, set);
  }

  template <typename Stored, typename Rows, typename At>
  void block(const Column& info, std::span<const InnerAxis> inner, Rows& rows, At at) {
    const auto take = [&rows, &at](std::size_t first, std::size_t count, const std::byte* in) {
      for (std::size_t i = 0; i < count; ++i) {
        auto& values = std::invoke(at, rows[first + i]);
        std::memcpy(values.data(), in, sizeof values);
        in += sizeof values;
      }
    };
    read(info, stored_type<Stored>(), sizeof(Stored), inner, take);
  }

  /// How many rows the axis has: for block_range().
  std::uint64_t count_rows(const char* axis, std::uint64_t rows_limit, std::size_t row_bytes) {
    begin_rows(axis, rows_limit, row_bytes);
    return rows_;
  }

  /// As many rows as there is room in `rows`, from `first` on; there must be so many. They are held against
  /// the check sums of their chunks alone, not against that of the whole column.
  template <typename Stored, typename Row, typename At>
  void block_range(const Column& info, std::span<const InnerAxis> inner, std::uint64_t first,
                   std::vector<Row>& rows, At at) {
    const auto take = [&](std::size_t begin, std::size_t count, const std::byte* in) {
      for (std::size_t i = 0; i < count; ++i) {
        auto& values = std::invoke(at, rows[begin - first + i]);
        std::memcpy(values.data(), in, sizeof values);
        in += sizeof values;
      }
    };
    read_range(info, stored_type<Stored>(), sizeof(Stored), inner, {first, first + rows.size()}, take);
  }

  template <typename Stored, typename Rows, typename Get, typename Set>
  void elements(const Column& info, const InnerAxis& inner, Rows& rows, Get /*get*/, Set set) {
    const auto take = [&rows, &set, size = inner.size](std::size_t first, std::size_t count,
                                                       const std::byte* in) {
      for (std::size_t i = 0; i < count * size; ++i, in += sizeof(Stored)) {
        Stored value;
        std::memcpy(&value, in, sizeof value);
        set(rows[first + i / size], i % size, value);
      }
    };
    read(info, stored_type<Stored>(), sizeof(Stored), {&inner, 1}, take);
  }

  template <typename Rows, typename At>
  void time_elements(const Column& info, const InnerAxis& inner, Rows& rows, At at) {
    const auto set = [this, at](RowOf<Rows>& row, std::size_t i, double seconds) {
      at(row, i) = facts_.reference + checked_time(seconds);
    };
    elements<double>(info, inner, rows, nullptr, set);
  }

  template <typename Row>
  void texts(const Column& info, std::vector<Row>& rows, std::string Row::*at) {
    const auto values = read_texts(info, {rows_});
    for (std::size_t i = 0; i < rows.size(); ++i) rows[i].*at = values[i];
  }

  InnerAxis inner_axis(const Column&, std::uint8_t size) const { return {-1, size}; }

  /// Throws Hdf5Failure if the axis has other names.
  InnerAxis named_axis(const Column& info, const std::vector<std::string>& names) const;

  std::string text(const Column& info) { return read_texts(info, {}).front(); }

 private:
  using Take = std::function<void(std::size_t first, std::size_t rows, const std::byte* in)>;

  struct Source;
  struct Table;
  struct Range {
    std::uint64_t begin = 0, end = 0;
  };
  void begin_rows(const char* axis, std::uint64_t rows_limit, std::size_t row_bytes);
  std::uint64_t rows_there(const Source& source) const;
  Source open(const char* name) const;
  const char* stored_name(const Column& info) const;
  void check_size(const char* name, std::uint64_t rows, std::size_t row_bytes) const;
  Table open_table(const Column& info, hid_t type, std::size_t element_bytes,
                   std::span<const InnerAxis> inner) const;
  void read(const Column& info, hid_t type, std::size_t element_bytes, std::span<const InnerAxis> inner,
            const Take& take) const;
  void read_range(const Column& info, hid_t type, std::size_t element_bytes, std::span<const InnerAxis> inner,
                  Range range, const Take& take) const;
  std::uint32_t read_chunks(const Table& table, hid_t type, Range range, const Take& take) const;
  std::vector<std::string> read_texts(const Column& info, const std::vector<hsize_t>& shape) const;
  static HostDuration checked_time(double seconds);

  std::string path_;
  Handle group_;
  FileFacts facts_;
  std::uint64_t rows_ = 0;
};

}  // namespace thermorig::session

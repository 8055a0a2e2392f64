// SPDX-License-Identifier: MIT
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "chunk_writer.h"
#include "column.h"
#include "format.h"
#include "hdf5_handle.h"
#include "thermorig/core/time.h"

namespace thermorig::session {

/// Writes one group: the columns of a table, every axis with its dimension scale. GroupReader has the same
/// interface, so that one description of a table (`*_columns.h`) serves both directions. Of each column's
/// pair of functions this class uses `get(row)`, and GroupReader `set(row, value)`.
class GroupWriter {
 public:
  /// Makes the group, unless it is there.
  GroupWriter(hid_t file, const std::string& path, ChunkWriter& chunks, HostTime reference);

  hid_t id() const { return group_.get(); }

  /// Of the format that is written.
  static constexpr FormatVersion version() { return format_version; }

  /// The column that is the axis of the table's rows: the columns after it are attached to it.
  template <typename Stored, typename Row, typename At>
  void axis(const Column& info, const std::vector<Row>& rows, At at) {
    begin_axis(rows.size());
    this->field<Stored>(info, rows, at);
    end_axis(info.name);
  }

  /// An axis without coordinates, as netCDF has them. `counted_by`: a dataset that is as long as the axis.
  template <typename Row>
  void bare_axis(const char* name, const char* long_name, const std::vector<Row>& rows,
                 const char* /*counted_by*/, std::uint64_t /*rows_limit*/ = rows_max) {
    add_bare_axis(name, long_name, rows.size());
  }

  /// More vectors that belong to the same axis.
  template <typename Row>
  void share_axis(const std::vector<Row>& /*rows*/) const {}

  /// Seconds since the time reference, to the nanosecond. `at` refers to the time.
  template <typename Row, typename At>
  void time_axis(const Column& info, const std::vector<Row>& rows, At at,
                 std::uint64_t /*rows_limit*/ = rows_max) {
    begin_axis(rows.size());
    time_column(info, rows, at);
    end_axis(info.name);
  }
  template <typename Row, typename At>
  void time_column(const Column& info, const std::vector<Row>& rows, At at) {
    const auto get = [at, reference = reference_](const Row& row) {
      return to_s(std::invoke(at, row) - reference);
    };
    this->column<double>(info, rows, get, nullptr);
  }

  template <typename Stored, typename Row, typename Get, typename Set>
  void column(const Column& info, const std::vector<Row>& rows, Get get, Set /*set*/) {
    add(info, stored_type<Stored>(), sizeof(Stored), {},
        [&rows, get](auto first, auto count, std::byte* out) {
          for (std::size_t i = 0; i < count; ++i, out += sizeof(Stored)) {
            const auto value = static_cast<Stored>(std::invoke(get, rows[first + i]));
            std::memcpy(out, &value, sizeof value);
          }
        });
  }

  /// A member: `at` is a pointer to it, or at(row) refers to it.
  template <typename Stored, typename Row, typename At>
  void field(const Column& info, const std::vector<Row>& rows, At at) {
    this->column<Stored>(info, rows, at, nullptr);
  }

  /// `at` refers to a std::array<Stored, ...> of as many elements as the inner axes span.
  template <typename Stored, typename Row, typename At>
  void block(const Column& info, std::span<const InnerAxis> inner, const std::vector<Row>& rows, At at) {
    add(info, stored_type<Stored>(), sizeof(Stored), inner,
        [&rows, at](auto first, auto count, std::byte* out) {
          for (std::size_t i = 0; i < count; ++i) {
            const auto& values = std::invoke(at, rows[first + i]);
            out = std::copy_n(reinterpret_cast<const std::byte*>(values.data()), sizeof values, out);
          }
        });
  }

  /// `get(row, i)`: element i of the row, inner axes flattened.
  template <typename Stored, typename Row, typename Get, typename Set>
  void elements(const Column& info, const InnerAxis& inner, const std::vector<Row>& rows, Get get,
                Set /*set*/) {
    add(info, stored_type<Stored>(), sizeof(Stored), {&inner, 1},
        [&rows, get, size = inner.size](auto first, auto count, std::byte* out) {
          for (std::size_t i = 0; i < count * size; ++i, out += sizeof(Stored)) {
            const auto value = static_cast<Stored>(get(rows[first + i / size], i % size));
            std::memcpy(out, &value, sizeof value);
          }
        });
  }

  /// Times of several things a row: `at(row, i)` refers to one.
  template <typename Row, typename At>
  void time_elements(const Column& info, const InnerAxis& inner, const std::vector<Row>& rows, At at) {
    const auto get = [at, reference = reference_](const Row& row, std::size_t i) {
      return to_s(at(row, i) - reference);
    };
    elements<double>(info, inner, rows, get, nullptr);
  }

  template <typename Row>
  void texts(const Column& info, const std::vector<Row>& rows, std::string Row::*at) {
    std::vector<std::string> values;
    for (const auto& row : rows) values.push_back(row.*at);
    attach_rows(add_texts(info, values));
  }

  InnerAxis inner_axis(const Column& info, std::uint8_t size);

  /// An axis within a row whose places have names.
  InnerAxis named_axis(const Column& info, const std::vector<std::string>& names);

  /// Attributes of a dataset of this group that has just been written.
  void set_image(const char* name) const;
  void set_computed_mask(const char* name, std::uint32_t mask) const;

  /// One text as a scalar dataset.
  void text(const Column& info, const std::string& value);

 private:
  void add_bare_axis(const char* name, const char* long_name, std::uint64_t rows);
  void add(const Column& info, hid_t type, std::size_t element_bytes, std::span<const InnerAxis> inner,
           ChunkWriter::Fill fill);
  hid_t add_texts(const Column& info, const std::vector<std::string>& values);
  void begin_axis(std::uint64_t rows);
  void end_axis(const char* name);
  void make_scale(hid_t dataset, const char* name);
  void attach_rows(hid_t dataset) const;
  hid_t keep(Handle dataset);

  std::string path_;
  Handle group_;
  ChunkWriter& chunks_;
  HostTime reference_;
  std::uint64_t rows_ = 0;
  hid_t row_scale_ = -1;
  hid_t last_dataset_ = -1;
  std::vector<Handle> open_;  // datasets that are not the ChunkWriter's
};

/// Creation properties of groups and datasets: members in the order of creation, no time stamps of objects.
Handle group_properties();

/// Marks a group for viewers as NXdata: what to plot against what.
void plot_as(hid_t group, const std::string& signal, const std::vector<std::string>& axes,
             const std::vector<std::string>& auxiliary = {});

}  // namespace thermorig::session

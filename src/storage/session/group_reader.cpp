// SPDX-License-Identifier: MIT
#include "group_reader.h"

#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "attributes.h"

namespace thermorig::session {

namespace {

// Deflate cannot shrink by more than 1032 : 1: whoever claims more wants our memory.
constexpr std::uint64_t deflate_ratio_max = 1032;
constexpr std::uint64_t small_bytes = 1U << 20U;
constexpr std::uint64_t chunk_bytes_max = 16U << 20U;

void check_link(hid_t parent, const std::string& name, const std::string& path) {
  H5L_info_t info;
  check(H5Lget_info(parent, name.c_str(), &info, H5P_DEFAULT), "find " + path);
  if (info.type != H5L_TYPE_HARD) throw Hdf5Failure("accept a link at " + path);
}

bool is_known_filter(H5Z_filter_t filter) {
  return filter == H5Z_FILTER_SHUFFLE || filter == H5Z_FILTER_DEFLATE || filter == H5Z_FILTER_FLETCHER32;
}

void check_filters(hid_t properties, const std::string& path) {
  const int count = check(H5Pget_nfilters(properties), "read the filters of " + path);
  for (int i = 0; i < count; ++i) {
    unsigned flags = 0, config = 0;
    std::size_t values = 0;
    const auto filter =
        H5Pget_filter2(properties, static_cast<unsigned>(i), &flags, &values, nullptr, 0, nullptr, &config);
    if (!is_known_filter(filter)) throw Hdf5Failure("accept the filters of " + path);
  }
}

/// Can so many elements be held at once? Also where the product of the sizes would overflow.
bool is_modest(const std::vector<hsize_t>& dims, std::uint64_t element_bytes) {
  std::uint64_t bytes = element_bytes;
  for (const hsize_t size : dims) {
    if (size > chunk_bytes_max || bytes > chunk_bytes_max) return false;
    bytes *= size;
  }
  return bytes <= chunk_bytes_max;
}

}  // namespace

struct GroupReader::Source {
  Handle dataset;
  Handle type;
  std::vector<hsize_t> dims;
  std::vector<hsize_t> chunk;  // empty: contiguous
};

/// A dataset whose type and shape are as they should be.
struct GroupReader::Table {
  std::string path;
  Source source;
  std::size_t row_bytes = 0;
};

GroupReader::GroupReader(hid_t file, const std::string& path, const FileFacts& facts)
    : path_(path), facts_(facts) {
  for (std::size_t end = path.find('/', 1);; end = path.find('/', end + 1)) {
    check_link(file, path.substr(0, end), path);
    if (end == std::string::npos) break;
  }
  group_ = Handle(H5Gopen2(file, path.c_str(), H5P_DEFAULT), "open " + path);
}

GroupReader::Source GroupReader::open(const char* name) const {
  const std::string path = path_ + "/" + name;
  check_link(id(), name, path);
  Source source;
  source.dataset = Handle(H5Dopen2(id(), name, H5P_DEFAULT), "open " + path);
  source.type = Handle(H5Dget_type(source.dataset.get()), "read the type of " + path);
  const Handle space(H5Dget_space(source.dataset.get()), "read the shape of " + path);
  const int rank = check(H5Sget_simple_extent_ndims(space.get()), "read the shape of " + path);
  source.dims.resize(static_cast<std::size_t>(rank));
  check(H5Sget_simple_extent_dims(space.get(), source.dims.data(), nullptr), "read the shape of " + path);
  const Handle properties(H5Dget_create_plist(source.dataset.get()), "read the layout of " + path);
  check_filters(properties.get(), path);
  const H5D_layout_t layout = H5Pget_layout(properties.get());
  if (H5Pget_external_count(properties.get()) != 0 || layout == H5D_VIRTUAL)
    throw Hdf5Failure("accept data outside the file at " + path);
  if (layout == H5D_CHUNKED) {
    source.chunk.resize(source.dims.size());
    check(H5Pget_chunk(properties.get(), rank, source.chunk.data()), "read the chunks of " + path);
  }
  return source;
}

void GroupReader::check_size(const char* name, std::uint64_t rows, std::size_t row_bytes) const {
  const std::uint64_t limit = facts_.bytes * deflate_ratio_max + small_bytes;
  if (rows > limit / row_bytes) throw Hdf5Failure("believe the size of " + path_ + "/" + name);
}

void GroupReader::begin_rows(const char* axis, std::uint64_t rows_limit, std::size_t row_bytes) {
  const Source source = open(axis);
  if (source.dims.size() != 1 || source.dims[0] > rows_limit)
    throw Hdf5Failure("believe the size of " + path_ + "/" + axis);
  check_size(axis, source.dims[0], row_bytes);
  rows_ = facts_.is_cut() ? rows_there(source) : source.dims[0];
}

/// Those before the first chunk that is not whole.
std::uint64_t GroupReader::rows_there(const Source& source) const {
  if (source.chunk.empty()) return source.dims[0];
  std::array<hsize_t, H5S_MAX_RANK> offset{};
  for (hsize_t& row = offset[0]; row < source.dims[0]; row += source.chunk[0]) {
    hsize_t size = 0;
    haddr_t address = HADDR_UNDEF;
    unsigned mask = 0;
    if (H5Dget_chunk_info_by_coord(source.dataset.get(), offset.data(), &mask, &address, &size) < 0 ||
        address > facts_.bytes_there || size > facts_.bytes_there - address)
      return row;
  }
  return source.dims[0];
}

const char* GroupReader::stored_name(const Column& info) const {
  return version().major < 2 && info.name_before_2 != nullptr ? info.name_before_2 : info.name;
}

GroupReader::Table GroupReader::open_table(const Column& info, hid_t type, std::size_t element_bytes,
                                           std::span<const InnerAxis> inner) const {
  const char* const name = stored_name(info);
  Table table{path_ + "/" + name, open(name), 0};
  std::vector<hsize_t> expected{rows_};
  for (const auto& axis : inner) expected.push_back(axis.size);
  if (facts_.is_cut() && !table.source.dims.empty() && table.source.dims[0] > rows_)
    expected[0] = table.source.dims[0];
  if (table.source.dims != expected || H5Tequal(table.source.type.get(), type) <= 0)
    throw Hdf5Failure("accept the type or the shape of " + table.path);
  table.row_bytes =
      std::accumulate(expected.begin() + 1, expected.end(), element_bytes, std::multiplies<std::size_t>());
  check_size(name, rows_, table.row_bytes);
  if (rows_ > 0 && table.source.chunk.empty()) throw Hdf5Failure("accept the layout of " + table.path);
  return table;
}

void GroupReader::read(const Column& info, hid_t type, std::size_t element_bytes,
                       std::span<const InnerAxis> inner, const Take& take) const {
  const Table table = open_table(info, type, element_bytes, inner);
  const std::uint32_t crc = rows_ == 0 ? 0 : read_chunks(table, type, {0, rows_}, take);
  if (rows_ < table.source.dims[0]) return;  // the sum is of all of them
  if (crc != get_attribute<std::uint32_t>(table.source.dataset.get(), "crc32"))
    throw Hdf5Failure("believe " + table.path + ": its values differ from its checksum");
}

void GroupReader::read_range(const Column& info, hid_t type, std::size_t element_bytes,
                             std::span<const InnerAxis> inner, Range range, const Take& take) const {
  const Table table = open_table(info, type, element_bytes, inner);
  if (range.begin > range.end || range.end > rows_) throw Hdf5Failure("find so many rows in " + table.path);
  if (range.begin < range.end) read_chunks(table, type, range, take);
}

std::uint32_t GroupReader::read_chunks(const Table& table, hid_t type, Range range, const Take& take) const {
  const Source& source = table.source;
  const hsize_t step = std::min<hsize_t>(source.chunk[0], rows_);
  if (!is_modest(source.chunk, H5Tget_size(source.type.get())) ||
      !is_modest(std::vector{step}, table.row_bytes))
    throw Hdf5Failure("accept the chunks of " + table.path);
  std::vector<std::byte> buffer(step * table.row_bytes);
  const Handle space(H5Dget_space(source.dataset.get()), "read " + table.path);
  std::vector<hsize_t> start(source.dims.size(), 0);
  std::vector<hsize_t> count = source.dims;
  std::uint32_t crc = 0;
  for (start[0] = range.begin; start[0] < range.end; start[0] += count[0]) {
    count[0] = std::min<hsize_t>(step - start[0] % step, range.end - start[0]);
    const Handle memory(H5Screate_simple(static_cast<int>(count.size()), count.data(), nullptr),
                        "read " + table.path);
    check(H5Sselect_hyperslab(space.get(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr),
          "read " + table.path);
    check(H5Dread(source.dataset.get(), type, memory.get(), space.get(), H5P_DEFAULT, buffer.data()),
          "read " + table.path + ": a chunk is damaged");
    crc = libdeflate_crc32(crc, buffer.data(), count[0] * table.row_bytes);
    take(start[0], count[0], buffer.data());
  }
  return crc;
}

InnerAxis GroupReader::named_axis(const Column& info, const std::vector<std::string>& names) const {
  if (read_texts(info, {names.size()}) != names)
    throw Hdf5Failure("believe " + path_ + "/" + info.name + ": the header has other names");
  return {-1, names.size()};
}

std::vector<std::string> GroupReader::read_texts(const Column& info,
                                                 const std::vector<hsize_t>& shape) const {
  const std::string path = path_ + "/" + info.name;
  const Source source = open(info.name);
  const std::size_t rows = shape.empty() ? 1 : shape.front();
  if (source.dims != shape || H5Tis_variable_str(source.type.get()) <= 0)
    throw Hdf5Failure("accept the type or the shape of " + path);
  check_size(info.name, rows, sizeof(char*));
  std::vector<char*> texts(rows, nullptr);
  if (rows > 0)
    check(H5Dread(source.dataset.get(), text_type().get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()),
          "read " + path);
  std::vector<std::string> values;
  std::uint32_t crc = 0;
  for (char* text : texts) {
    values.emplace_back(text == nullptr ? "" : text);
    crc = libdeflate_crc32(crc, values.back().c_str(), values.back().size() + 1);
    H5free_memory(text);
  }
  if (crc != get_attribute<std::uint32_t>(source.dataset.get(), "crc32"))
    throw Hdf5Failure("believe " + path + ": its text differs from its checksum");
  return values;
}

HostDuration GroupReader::checked_time(double seconds) {
  if (!std::isfinite(seconds) || std::abs(seconds) > farthest_time_s) throw Hdf5Failure("believe a time");
  return from_s(seconds);
}

}  // namespace thermorig::session

// SPDX-License-Identifier: MIT
#include "group_writer.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <hdf5_hl.h>
#include <libdeflate.h>

#include <numeric>

#include "attributes.h"
#include "chunk_codec.h"

namespace thermorig::session {

namespace {

// One-dimensional chunks hold about so many bytes; three-dimensional ones 64 frames: 8 s at 8 frames/s.
constexpr std::uint64_t chunk_bytes = 64U << 10U;
constexpr std::uint64_t frames_per_chunk = 64;

void set_flags(hid_t dataset, hid_t type, const Flags& flags) {
  if (flags.kind == Flags::Kind::none) return;
  const char* name = flags.kind == Flags::Kind::values ? "flag_values" : "flag_masks";
  const hsize_t count = flags.values.size();
  const Handle space(H5Screate_simple(1, &count, nullptr), "make a dataspace");
  // CF asks for the type of the dataset itself; HDF5 converts from our 32 bits.
  const Handle attribute(H5Acreate2(dataset, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                         "create flags");
  check(H5Awrite(attribute.get(), H5T_NATIVE_UINT32, flags.values.data()), "write flags");
  set_attribute(dataset, "flag_meanings", fmt::format("{}", fmt::join(flags.meanings, " ")));
}

void describe(hid_t dataset, const Column& info, hid_t type) {
  set_attribute(dataset, "units", info.units);
  set_attribute(dataset, "long_name", info.long_name);
  if (*info.description != '\0') set_attribute(dataset, "description", info.description);
  set_flags(dataset, type, info.flags);
}

Handle dataset_properties() {
  Handle properties(H5Pcreate(H5P_DATASET_CREATE), "make properties");
  check(H5Pset_obj_track_times(properties.get(), false), "switch object times off");
  return properties;
}

Handle chunked_properties(std::span<const hsize_t> chunk, std::size_t element_bytes) {
  Handle properties = dataset_properties();
  check(H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data()), "set chunks");
  if (element_bytes > 1) check(H5Pset_shuffle(properties.get()), "set the shuffle filter");
  check(H5Pset_deflate(properties.get(), ChunkCodec::deflate_level), "set the deflate filter");
  check(H5Pset_fletcher32(properties.get()), "set the fletcher32 filter");
  return properties;
}

std::uint64_t chunk_rows_of(std::uint64_t rows, std::size_t element_bytes, int rank) {
  const std::uint64_t wanted = rank == 3 ? frames_per_chunk : chunk_bytes / element_bytes;
  return std::clamp<std::uint64_t>(rows, 1, wanted);
}

/// Without rows it is chunked as well, though there is nothing to filter: h5repack fails on one that is not.
/// No chunk may be longer than the dataset can become, so such a one could grow.
Handle row_space(const std::vector<hsize_t>& dims) {
  std::vector<hsize_t> most = dims;
  if (dims[0] == 0) most[0] = H5S_UNLIMITED;
  return Handle(H5Screate_simple(static_cast<int>(dims.size()), dims.data(), most.data()),
                "make a dataspace");
}

Handle row_properties(std::vector<hsize_t> dims, std::uint64_t chunk_rows, std::size_t element_bytes) {
  const bool is_empty = dims[0] == 0;
  dims[0] = chunk_rows;
  if (!is_empty) return chunked_properties(dims, element_bytes);
  Handle properties = dataset_properties();
  check(H5Pset_chunk(properties.get(), static_cast<int>(dims.size()), dims.data()), "set chunks");
  return properties;
}

}  // namespace

Handle group_properties() {
  Handle properties(H5Pcreate(H5P_GROUP_CREATE), "make properties");
  check(H5Pset_link_creation_order(properties.get(), H5P_CRT_ORDER_TRACKED | H5P_CRT_ORDER_INDEXED),
        "track the order of creation");
  check(H5Pset_obj_track_times(properties.get(), false), "switch object times off");
  return properties;
}

void plot_as(hid_t group, const std::string& signal, const std::vector<std::string>& axes,
             const std::vector<std::string>& auxiliary) {
  set_attribute(group, "NX_class", "NXdata");
  set_attribute(group, "signal", signal);
  set_attribute(group, "axes", axes);
  set_attribute(group, "auxiliary_signals", auxiliary);
}

GroupWriter::GroupWriter(hid_t file, const std::string& path, ChunkWriter& chunks, HostTime reference)
    : path_(path),
      group_(H5Lexists(file, path.c_str(), H5P_DEFAULT) > 0
                 ? H5Gopen2(file, path.c_str(), H5P_DEFAULT)
                 : H5Gcreate2(file, path.c_str(), H5P_DEFAULT, group_properties().get(), H5P_DEFAULT),
             "create " + path),
      chunks_(chunks),
      reference_(reference) {}

hid_t GroupWriter::keep(Handle dataset) {
  return open_.emplace_back(std::move(dataset)).get();
}

void GroupWriter::make_scale(hid_t dataset, const char* name) {
  check(H5DSset_scale(dataset, name), "make a scale of " + path_ + "/" + name);
}

void GroupWriter::begin_axis(std::uint64_t rows) {
  rows_ = rows;
  row_scale_ = -1;
}

void GroupWriter::end_axis(const char* name) {
  make_scale(last_dataset_, name);
  row_scale_ = last_dataset_;
}

void GroupWriter::attach_rows(hid_t dataset) const {
  if (row_scale_ >= 0) check(H5DSattach_scale(dataset, row_scale_, 0), "attach a scale in " + path_);
}

void GroupWriter::add_bare_axis(const char* name, const char* long_name, std::uint64_t rows) {
  rows_ = rows;
  const Handle space = row_space({rows});
  const Handle properties = rows == 0 ? row_properties({0}, 1, 1) : dataset_properties();
  // Never written, and allocated late: it takes no room in the file.
  const hid_t scale = keep(
      Handle(H5Dcreate2(id(), name, H5T_IEEE_F32BE, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
             "create " + path_ + "/" + name));
  // The words by which netCDF knows a dimension without a variable.
  make_scale(scale, fmt::format("This is a netCDF dimension but not a netCDF variable. {:9}", rows).c_str());
  set_attribute(scale, "units", "1");
  set_attribute(scale, "long_name", long_name);
  row_scale_ = scale;
}

InnerAxis GroupWriter::inner_axis(const Column& info, std::uint8_t size) {
  const hsize_t dims = size;
  const Handle space(H5Screate_simple(1, &dims, nullptr), "make a dataspace");
  const hid_t scale = keep(Handle(H5Dcreate2(id(), info.name, H5T_STD_U8LE, space.get(), H5P_DEFAULT,
                                             dataset_properties().get(), H5P_DEFAULT),
                                  "create " + path_ + "/" + info.name));
  std::vector<std::uint8_t> indices(size);
  std::iota(indices.begin(), indices.end(), std::uint8_t{0});
  check(H5Dwrite(scale, H5T_STD_U8LE, H5S_ALL, H5S_ALL, H5P_DEFAULT, indices.data()), "write an axis");
  describe(scale, info, H5T_STD_U8LE);
  make_scale(scale, info.name);
  return {scale, size};
}

void GroupWriter::add(const Column& info, hid_t type, std::size_t element_bytes,
                      std::span<const InnerAxis> inner, ChunkWriter::Fill fill) {
  std::vector<hsize_t> dims{rows_};
  for (const auto& axis : inner) dims.push_back(axis.size);
  const int rank = static_cast<int>(dims.size());
  const std::size_t row_bytes =
      std::accumulate(dims.begin() + 1, dims.end(), element_bytes, std::multiplies<std::size_t>());
  const std::uint64_t chunk_rows = chunk_rows_of(rows_, element_bytes, rank);
  const Handle properties = row_properties(dims, chunk_rows, element_bytes);
  const Handle space = row_space(dims);
  const std::string path = path_ + "/" + info.name;
  Handle dataset(H5Dcreate2(id(), info.name, type, space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                 "create " + path);
  last_dataset_ = dataset.get();
  describe(last_dataset_, info, type);
  attach_rows(last_dataset_);
  for (unsigned i = 0; i < inner.size(); ++i)
    check(H5DSattach_scale(last_dataset_, inner[i].scale, i + 1), "attach a scale to " + path);
  chunks_.add(std::move(dataset), {path, rows_, chunk_rows, row_bytes, element_bytes}, std::move(fill));
}

InnerAxis GroupWriter::named_axis(const Column& info, const std::vector<std::string>& names) {
  const hid_t scale = add_texts(info, names);
  make_scale(scale, info.name);
  return {scale, names.size()};
}

hid_t GroupWriter::add_texts(const Column& info, const std::vector<std::string>& values) {
  const hsize_t size = values.size();
  const Handle space = row_space({size});
  const Handle type = text_type();
  const std::string path = path_ + "/" + info.name;
  const Handle properties = size == 0 ? row_properties({0}, 1, sizeof(char*)) : dataset_properties();
  const hid_t dataset = keep(
      Handle(H5Dcreate2(id(), info.name, type.get(), space.get(), H5P_DEFAULT, properties.get(), H5P_DEFAULT),
             "create " + path));
  std::vector<const char*> texts;
  std::uint32_t crc = 0;
  for (const auto& value : values) {
    texts.push_back(value.c_str());
    crc = libdeflate_crc32(crc, value.c_str(), std::strlen(value.c_str()) + 1);
  }
  if (size > 0)
    check(H5Dwrite(dataset, type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, texts.data()), "write " + path);
  describe(dataset, info, type.get());
  set_attribute(dataset, "crc32", crc);
  return dataset;
}

void GroupWriter::set_image(const char* name) const {
  const Handle dataset(H5Dopen2(id(), name, H5P_DEFAULT), "open " + path_ + "/" + name);
  set_attribute(dataset.get(), "interpretation", "image");
}

void GroupWriter::set_computed_mask(const char* name, std::uint32_t mask) const {
  const Handle dataset(H5Dopen2(id(), name, H5P_DEFAULT), "open " + path_ + "/" + name);
  set_attribute(dataset.get(), "computed_mask", mask);
}

void GroupWriter::text(const Column& info, const std::string& value) {
  const Handle space(H5Screate(H5S_SCALAR), "make a dataspace");
  const Handle type = text_type();
  const std::string path = path_ + "/" + info.name;
  const hid_t dataset = keep(Handle(H5Dcreate2(id(), info.name, type.get(), space.get(), H5P_DEFAULT,
                                               dataset_properties().get(), H5P_DEFAULT),
                                    "create " + path));
  const char* text = value.c_str();
  check(H5Dwrite(dataset, type.get(), H5S_ALL, H5S_ALL, H5P_DEFAULT, &text), "write " + path);
  describe(dataset, info, type.get());
  set_attribute(dataset, "crc32", libdeflate_crc32(0, text, std::strlen(text) + 1));
}

}  // namespace thermorig::session

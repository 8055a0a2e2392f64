// SPDX-License-Identifier: MIT
#include "stored_attributes.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <libdeflate.h>

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <string_view>
#include <utility>

#include "attributes.h"
#include "recording_columns.h"

namespace thermorig::session {

namespace {

constexpr std::size_t value_bytes_max = 1U << 20U;
constexpr std::size_t sum_digits = 8;
constexpr std::string_view licence_path = "/@license";

herr_t collect_object(hid_t /*file*/, const char* name, const H5O_info_t* /*info*/, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

herr_t collect_attribute(hid_t /*object*/, const char* name, const H5A_info_t* /*info*/, void* names) {
  static_cast<std::vector<std::string>*>(names)->emplace_back(name);
  return 0;
}

/// "/gyro", "/gyro/rate" of "/gyro". What the library cannot reach is not among them.
std::vector<std::string> objects_in(hid_t file, const std::string& group) {
  std::vector<std::string> names;
  H5Ovisit_by_name2(file, group.c_str(), H5_INDEX_NAME, H5_ITER_INC, collect_object, &names, H5O_INFO_BASIC,
                    H5P_DEFAULT);
  const std::string before = group == "/" ? "/" : group + "/";
  for (std::string& name : names) name = name == "." ? group : before + name;
  return names;
}

/// Of an attribute's path: "/gyro" is, of "/gyro@signal" and "/gyro/rate@units".
bool is_within(const std::string& path, const std::string& group) {
  return path.starts_with(group) && (path[group.size()] == '@' || path[group.size()] == '/');
}

bool is_variable_text(hid_t type) {
  return H5Tget_class(type) == H5T_STRING && H5Tis_variable_str(type) > 0;
}

/// Whether its bytes are the values, and no places of values. Text within a compound may be either.
bool is_plain(hid_t type) {
  const H5T_class_t kind = H5Tget_class(type);
  const bool is_composed = kind == H5T_COMPOUND || kind == H5T_ARRAY;
  return H5Tdetect_class(type, H5T_VLEN) == 0 && H5Tdetect_class(type, H5T_REFERENCE) == 0 &&
         !(is_composed && H5Tdetect_class(type, H5T_STRING) != 0);
}

/// The same kind of text in any file.
Handle text_type_like(hid_t type) {
  Handle copy = text_type();
  check(H5Tset_cset(copy.get(), H5Tget_cset(type)), "make a text type");
  return copy;
}

void read_texts(hid_t attribute, std::size_t count, StoredAttribute& stored) {
  std::vector<char*> texts(count, nullptr);
  check(H5Aread(attribute, stored.type.get(), texts.data()), "read " + stored.path());
  for (char* text : texts) {
    stored.texts.emplace_back(text == nullptr ? "" : text);
    H5free_memory(text);
  }
}

std::optional<StoredAttribute> read_attribute(hid_t object, std::string path, std::string name) {
  StoredAttribute stored{std::move(path), std::move(name), {}, {}, {}, {}};
  const std::string action = "read " + stored.path();
  const Handle attribute(H5Aopen(object, stored.name.c_str(), H5P_DEFAULT), action);
  const Handle type_in_file(H5Aget_type(attribute.get()), action);
  stored.type = Handle(H5Tcopy(type_in_file.get()), action);  // does not keep the file open
  stored.space = Handle(H5Aget_space(attribute.get()), action);
  const hssize_t count = check(H5Sget_simple_extent_npoints(stored.space.get()), action);
  const std::size_t element_bytes = H5Tget_size(stored.type.get());
  if (element_bytes == 0 || static_cast<std::size_t>(count) > value_bytes_max / element_bytes)
    return std::nullopt;
  if (is_variable_text(stored.type.get())) {
    stored.type = text_type_like(stored.type.get());
    if (count > 0) read_texts(attribute.get(), static_cast<std::size_t>(count), stored);
    return stored;
  }
  if (!is_plain(stored.type.get())) return std::nullopt;
  stored.bytes.resize(static_cast<std::size_t>(count) * element_bytes);
  if (count > 0) check(H5Aread(attribute.get(), stored.type.get(), stored.bytes.data()), action);
  return stored;
}

/// One that is damaged counts as one that is not there.
std::optional<StoredAttribute> attribute_if_readable(hid_t object, const std::string& path,
                                                     std::string name) {
  try {
    return read_attribute(object, path, std::move(name));
  } catch (const Hdf5Failure&) {
    return std::nullopt;
  }
}

void take_attributes_of(hid_t file, const std::string& path, std::vector<StoredAttribute>& found) {
  const hid_t id = H5Oopen(file, path.c_str(), H5P_DEFAULT);
  if (id < 0) return;
  const Handle object(id, "open " + path);
  std::vector<std::string> names;
  hsize_t next = 0;
  H5Aiterate2(object.get(), H5_INDEX_NAME, H5_ITER_INC, &next, collect_attribute, &names);
  for (std::string& name : names)
    if (auto stored = attribute_if_readable(object.get(), path, std::move(name)))
      found.push_back(std::move(*stored));
}

/// "8x3"; "" of a single value.
std::string shape_of(hid_t space) {
  std::vector<hsize_t> lengths(static_cast<std::size_t>(std::max(H5Sget_simple_extent_ndims(space), 0)));
  if (!lengths.empty()) H5Sget_simple_extent_dims(space, lengths.data(), nullptr);
  return fmt::format("{}", fmt::join(lengths, "x"));
}

std::string type_of(const StoredAttribute& stored) {
  const hid_t type = stored.type.get();
  const H5T_class_t kind = H5Tget_class(type);
  const bool is_number = kind == H5T_INTEGER || kind == H5T_FLOAT;
  return fmt::format("{} {} {} {}", static_cast<int>(kind), is_variable_text(type) ? 0 : H5Tget_size(type),
                     kind == H5T_INTEGER ? static_cast<int>(H5Tget_sign(type)) : 0,
                     is_number ? static_cast<int>(H5Tget_order(type)) : 0);
}

std::uint32_t sum_of(const StoredAttribute& stored) {
  std::string text = fmt::format("{} {} {}\n", type_of(stored),
                                 static_cast<int>(H5Sget_simple_extent_type(stored.space.get())),
                                 shape_of(stored.space.get()));
  text.append(reinterpret_cast<const char*>(stored.bytes.data()), stored.bytes.size());
  for (const std::string& value : stored.texts) text.append(value.c_str(), value.size() + 1);
  return libdeflate_crc32(0, text.data(), text.size());
}

/// By path. Throws Hdf5Failure.
std::map<std::string, std::uint32_t> sums_in(std::string_view text) {
  std::map<std::string, std::uint32_t> sums;
  while (!text.empty()) {
    const std::size_t end = text.find('\n');
    const std::string_view line = text.substr(0, end);
    std::uint32_t sum = 0;
    const char* const digits_end = line.data() + std::min(line.size(), sum_digits);
    const auto [at, error] = std::from_chars(line.data(), digits_end, sum, 16);
    if (end == std::string_view::npos || error != std::errc() || at != digits_end ||
        line.size() < sum_digits + 2 || line[sum_digits] != ' ')
      throw Hdf5Failure("believe the check sums of the attributes");
    sums.emplace(line.substr(sum_digits + 1), sum);
    text.remove_prefix(end + 1);
  }
  return sums;
}

bool has_object(hid_t file, const std::string& path) {
  const hid_t object = H5Oopen(file, path.c_str(), H5P_DEFAULT);
  if (object >= 0) H5Oclose(object);
  return object >= 0;
}

void add_attribute(hid_t file, const StoredAttribute& stored) {
  const std::string action = "write " + stored.path();
  const Handle object(H5Oopen(file, stored.object.c_str(), H5P_DEFAULT), action);
  const Handle attribute(H5Acreate2(object.get(), stored.name.c_str(), stored.type.get(), stored.space.get(),
                                    H5P_DEFAULT, H5P_DEFAULT),
                         action);
  std::vector<const char*> texts;
  for (const std::string& text : stored.texts) texts.push_back(text.c_str());
  const void* values = stored.bytes.data();
  if (!texts.empty()) values = texts.data();
  if (values != nullptr) check(H5Awrite(attribute.get(), stored.type.get(), values), action);
}

}  // namespace

std::vector<StoredAttribute> stored_attributes(hid_t file, const std::string& group) {
  std::vector<StoredAttribute> found;
  for (const std::string& path : objects_in(file, group)) take_attributes_of(file, path, found);
  return found;
}

std::string attribute_sums(const std::vector<StoredAttribute>& attributes) {
  std::string lines;
  for (const StoredAttribute& stored : attributes)
    if (stored.path() != licence_path) lines += fmt::format("{:08x} {}\n", sum_of(stored), stored.path());
  return lines;
}

std::vector<std::string> altered_attributes(const std::vector<StoredAttribute>& attributes,
                                            const std::string& sums) {
  std::map<std::string, std::uint32_t> expected = sums_in(sums);
  for (const StoredAttribute& stored : attributes) {
    const auto line = expected.find(stored.path());
    if (line != expected.end() && line->second == sum_of(stored)) expected.erase(line);
  }
  std::vector<std::string> paths;
  for (const auto& [path, sum] : expected) paths.push_back(path);
  return paths;
}

std::vector<std::string> altered_attributes(hid_t file, const std::string& group, const std::string& sums) {
  std::vector<std::string> paths = altered_attributes(stored_attributes(file, group), sums);
  std::erase_if(paths, [&](const std::string& path) { return !is_within(path, group); });
  return paths;
}

std::vector<StoredAttribute> without_named(std::vector<StoredAttribute> attributes, const std::string& sums) {
  const std::map<std::string, std::uint32_t> named = sums_in(sums);
  std::erase_if(attributes, [&](const StoredAttribute& stored) { return named.contains(stored.path()); });
  return attributes;
}

std::vector<std::string> objects_without_named(hid_t file, const std::string& sums) {
  std::vector<std::string> others;
  const std::map<std::string, std::uint32_t> named = sums_in(sums);
  for (const std::string& path : objects_in(file, "/")) {
    const auto is_in_it = [&](const auto& line) { return is_within(line.first, path); };
    const auto holds_it = [&](const std::string& other) { return path.starts_with(other + "/"); };
    if (path == "/" || path == std::string("/quality/") + attribute_sums_column.name ||
        std::any_of(named.begin(), named.end(), is_in_it) ||
        std::any_of(others.begin(), others.end(), holds_it))
      continue;
    others.push_back(path);
  }
  return others;
}

void add_attributes(hid_t file, const std::vector<StoredAttribute>& attributes) {
  for (const StoredAttribute& stored : attributes)
    if (has_object(file, stored.object) &&
        H5Aexists_by_name(file, stored.object.c_str(), stored.name.c_str(), H5P_DEFAULT) == 0)
      add_attribute(file, stored);
}

}  // namespace thermorig::session

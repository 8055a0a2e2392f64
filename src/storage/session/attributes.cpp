// SPDX-License-Identifier: MIT
#include "attributes.h"

#include <algorithm>

namespace thermorig::session {

namespace {

std::string action(const char* verb, const char* name) {
  return std::string(verb) + " attribute " + name;
}

Handle scalar_or_array(std::size_t count) {
  const hsize_t size = count;
  return Handle(count == 0 ? H5Screate(H5S_SCALAR) : H5Screate_simple(1, &size, nullptr), "make a dataspace");
}

Handle open_scalar(hid_t object, const char* name) {
  Handle attribute(H5Aopen(object, name, H5P_DEFAULT), action("find", name));
  const Handle space(H5Aget_space(attribute.get()), action("read", name));
  if (H5Sget_simple_extent_type(space.get()) != H5S_SCALAR) throw Hdf5Failure(action("read", name));
  return attribute;
}

/// As other tools write text: so many bytes, the rest filled up with zeros or blanks.
std::string get_fixed_text(hid_t attribute, hid_t type, const char* name) {
  constexpr std::size_t most = 65'536;  // a file may claim any size
  const std::size_t size = H5Tget_size(type);
  if (size == 0 || size > most) throw Hdf5Failure(action("read", name));
  std::string text(size, '\0');
  check(H5Aread(attribute, type, text.data()), action("read", name));
  text.resize(std::min(text.find('\0'), size));
  text.resize(text.find_last_not_of(' ') + 1);
  return text;
}

}  // namespace

Handle text_type() {
  Handle type(H5Tcopy(H5T_C_S1), "make a text type");
  check(H5Tset_size(type.get(), H5T_VARIABLE), "make a text type");
  check(H5Tset_cset(type.get(), H5T_CSET_UTF8), "make a text type");
  return type;
}

void set_raw_attribute(hid_t object, const char* name, hid_t type, std::size_t count, const void* data) {
  const Handle space = scalar_or_array(count);
  const bool is_there = has_attribute(object, name);
  const Handle attribute(is_there ? H5Aopen(object, name, H5P_DEFAULT)
                                  : H5Acreate2(object, name, type, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                         action(is_there ? "open" : "create", name));
  check(H5Awrite(attribute.get(), type, data), action("write", name));
}

void set_attribute(hid_t object, const char* name, const char* value) {
  set_raw_attribute(object, name, text_type().get(), 0, &value);
}

void set_attribute(hid_t object, const char* name, const std::string& value) {
  set_attribute(object, name, value.c_str());
}

void set_attribute(hid_t object, const char* name, const std::vector<std::string>& values) {
  if (values.empty()) return;
  std::vector<const char*> texts;
  for (const auto& value : values) texts.push_back(value.c_str());
  set_raw_attribute(object, name, text_type().get(), texts.size(), texts.data());
}

bool has_attribute(hid_t object, const char* name) {
  return H5Aexists(object, name) > 0;
}

void get_raw_attribute(hid_t object, const char* name, hid_t type, void* data) {
  const Handle attribute = open_scalar(object, name);
  const Handle stored(H5Aget_type(attribute.get()), action("read", name));
  if (H5Tequal(stored.get(), type) <= 0) throw Hdf5Failure(action("read", name));
  check(H5Aread(attribute.get(), type, data), action("read", name));
}

std::string get_text_attribute(hid_t object, const char* name) {
  const Handle attribute = open_scalar(object, name);
  const Handle stored(H5Aget_type(attribute.get()), action("read", name));
  if (H5Tget_class(stored.get()) == H5T_STRING && H5Tis_variable_str(stored.get()) == 0)
    return get_fixed_text(attribute.get(), stored.get(), name);
  if (H5Tis_variable_str(stored.get()) <= 0) throw Hdf5Failure(action("read", name));
  char* text = nullptr;
  check(H5Aread(attribute.get(), stored.get(), &text), action("read", name));
  std::string value = text == nullptr ? "" : text;
  H5free_memory(text);
  return value;
}

}  // namespace thermorig::session

// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "hdf5_handle.h"

namespace thermorig::session {

/// Scalar variable-length UTF-8, which is what h5py, h5web, silx and MATLAB take for a native string.
void set_attribute(hid_t object, const char* name, const std::string& value);
void set_attribute(hid_t object, const char* name, const char* value);

/// A one-dimensional array of strings; writes nothing if there is none, for some readers refuse empty arrays.
void set_attribute(hid_t object, const char* name, const std::vector<std::string>& values);

/// `data` holds `count` elements; count 0 stands for a scalar. One that is there takes them, if it is like
/// this.
void set_raw_attribute(hid_t object, const char* name, hid_t type, std::size_t count, const void* data);

template <typename Number>
requires std::integral<Number> || std::floating_point<Number>
void set_attribute(hid_t object, const char* name, Number value) {
  set_raw_attribute(object, name, stored_type<Number>(), 0, &value);
}

bool has_attribute(hid_t object, const char* name);

/// A scalar of exactly the stored type; throws Hdf5Failure otherwise.
void get_raw_attribute(hid_t object, const char* name, hid_t type, void* data);

template <typename Number>
Number get_attribute(hid_t object, const char* name) {
  Number value{};
  get_raw_attribute(object, name, stored_type<Number>(), &value);
  return value;
}

std::string get_text_attribute(hid_t object, const char* name);

/// Variable-length UTF-8: the type of every text in the file.
Handle text_type();

}  // namespace thermorig::session

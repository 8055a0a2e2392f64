// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "hdf5_handle.h"
#include "thermorig/storage/session/stored_file.h"

namespace thermorig::session {

/// An attribute as it stands in a file, whoever wrote it: numbers, text, or anything else that holds no
/// references and no lists of other than text.
struct StoredAttribute {
  std::string object;  // "/", "/gyro/rate"
  std::string name;
  Handle type;
  Handle space;
  std::vector<std::byte> bytes;    // the values; of text of variable length:
  std::vector<std::string> texts;  // each of them

  std::string path() const { return object + "@" + name; }
};

/// All attributes of a group and of all objects in it that can be reached by hard links, by name. What cannot
/// be read, is larger than 1 MiB or holds references is left out: dimension scales.
std::vector<StoredAttribute> stored_attributes(hid_t file, const std::string& group = "/");

/// A line an attribute: CRC-32 of its type, shape and values, and its path. The licence is left out, which
/// owners of data may state later.
std::string attribute_sums(const std::vector<StoredAttribute>& attributes);

/// Of the attributes that attribute_sums() named, the paths of those that are not there any more or have
/// other values. Throws Hdf5Failure if `sums` is no such text.
std::vector<std::string> altered_attributes(const std::vector<StoredAttribute>& attributes,
                                            const std::string& sums);

/// The same of the attributes of a group and of what is in it alone.
std::vector<std::string> altered_attributes(hid_t file, const std::string& group, const std::string& sums);

/// Those of them that `sums` does not name.
std::vector<StoredAttribute> without_named(std::vector<StoredAttribute> attributes, const std::string& sums);

/// Groups and datasets without an attribute that `sums` names, and without such an object in them: the
/// outermost alone.
std::vector<std::string> objects_without_named(hid_t file, const std::string& sums);

/// What thermorig did not write in a session.
struct AddedByOthers {
  std::vector<StoredAttribute>
      attributes;                    // and some that it did: what a file that replaces it lacks is kept
  std::vector<std::string> objects;  // outermost groups and datasets; formats before 1.3 cannot tell
};

/// Throws as read_session() does.
AddedByOthers added_by_others(const StoredFile& file);

/// Puts attributes on the same objects of another file, as far as these are there and have none of the name.
void add_attributes(hid_t file, const std::vector<StoredAttribute>& attributes);

}  // namespace thermorig::session

// SPDX-License-Identifier: MIT
// A sound session file in which the input changes attributes, shapes, types, values and links with libhdf5's
// own calls: the file's structure stays sound, what it says does not. Refused, or a session. What becomes of
// a file whose structure is damaged is libhdf5's affair, which a child process suffers
// (tests/session/hostile_file_test.cpp).
#include <hdf5.h>
#include <zlib.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fuzz_require.h"
#include "session/synthetic_session.h"
#include "storage/session/session_image.h"
#include "support/stored_bytes.h"
#include "thermorig/storage/session/session.h"

namespace {

using namespace thermorig;
using test::fuzz_require;
using test::FuzzScript;
using Bytes = std::vector<std::byte>;

const Bytes& sound_file() {
  static const Bytes bytes = [] {
    session::SyntheticSession made(2, 1);
    const session::SessionImage image = session::build_image(made.take(), 1);
    return Bytes(image.bytes.begin(), image.bytes.end());
  }();
  return bytes;
}

herr_t collect(hid_t, const char* name, const H5O_info_t*, void* to) {
  static_cast<std::vector<std::string>*>(to)->emplace_back(name);
  return 0;
}

/// Names of all groups and datasets.
const std::vector<std::string>& objects_of(hid_t file) {
  static const std::vector<std::string> names = [file] {
    std::vector<std::string> all;
    H5Ovisit2(file, H5_INDEX_NAME, H5_ITER_NATIVE, collect, &all, H5O_INFO_BASIC);
    return all;
  }();
  return names;
}

hid_t some_type(FuzzScript& script) {
  const std::array<hid_t, 8> types{H5T_STD_U8LE,   H5T_STD_U32LE, H5T_STD_I64LE, H5T_IEEE_F32LE,
                                   H5T_IEEE_F64LE, H5T_STD_U64LE, H5T_STD_I16LE, H5T_IEEE_F64BE};
  return types[script.byte() % types.size()];
}

/// Writes eight bytes of the input over an attribute, as what it is or as something else.
void change_attribute(hid_t object, FuzzScript& script) {
  const hid_t attribute = H5Aopen_by_idx(object, ".", H5_INDEX_NAME, H5_ITER_NATIVE, script.byte() % 16U,
                                         H5P_DEFAULT, H5P_DEFAULT);
  if (attribute < 0) return;
  std::array<char, 64> name{};
  H5Aget_name(attribute, name.size(), name.data());
  const hid_t type = H5Aget_type(attribute);
  const bool keeps_type = script.byte() % 4 != 0;
  const hid_t there = H5Aget_space(attribute);
  const bool is_single = H5Sget_simple_extent_type(there) == H5S_SCALAR;
  H5Sclose(there);
  if (H5Tis_variable_str(type) > 0 && is_single) {
    const std::string text = script.text(script.byte());
    const char* at = text.c_str();
    H5Awrite(attribute, type, &at);
  } else if (keeps_type && H5Tget_size(type) <= 8) {
    const auto value = script.number<std::uint64_t>();
    if (is_single) H5Awrite(attribute, type, &value);
  } else {
    H5Adelete(object, name.data());
    const hsize_t size = 1 + script.byte() % 3;
    const hid_t space = H5Screate_simple(1, &size, nullptr);
    const hid_t made = H5Acreate2(object, name.data(), some_type(script), space, H5P_DEFAULT, H5P_DEFAULT);
    H5Aclose(made);
    H5Sclose(space);
  }
  H5Tclose(type);
  H5Aclose(attribute);
}

/// Values of the input over the first of a dataset, with the check sum that they ask for.
void change_values(hid_t dataset, FuzzScript& script) {
  const hid_t type = H5Dget_type(dataset);
  const hid_t space = H5Dget_space(dataset);
  const auto count = static_cast<std::size_t>(H5Sget_simple_extent_npoints(space));
  if (H5Tis_variable_str(type) <= 0 && count < 100'000) {
    std::vector<unsigned char> values(count * H5Tget_size(type));
    H5Dread(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    const std::size_t at = values.empty() ? 0 : script.number<std::uint16_t>() % values.size();
    for (std::size_t i = at; i < values.size() && i < at + 8; ++i) values[i] = script.byte();
    H5Dwrite(dataset, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data());
    const auto sum = static_cast<std::uint32_t>(::crc32(0, values.data(), static_cast<uInt>(values.size())));
    const hid_t attribute = H5Aopen(dataset, "crc32", H5P_DEFAULT);
    if (attribute >= 0) H5Awrite(attribute, H5T_NATIVE_UINT32, &sum);
    if (attribute >= 0) H5Aclose(attribute);
  }
  H5Sclose(space);
  H5Tclose(type);
}

/// Another dataset, link or nothing in its place.
void replace(hid_t file, const std::string& name, FuzzScript& script) {
  H5Ldelete(file, name.c_str(), H5P_DEFAULT);
  const std::uint8_t what = script.byte();
  if (what % 4 == 0) return;
  if (what % 4 == 1) {
    const auto& others = objects_of(file);
    const std::string& other = others[script.byte() % others.size()];
    if (script.byte() % 2 == 0)
      H5Lcreate_soft(("/" + other).c_str(), file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    else
      H5Lcreate_external("/etc/passwd", "/", file, name.c_str(), H5P_DEFAULT, H5P_DEFAULT);
    return;
  }
  const std::array<hsize_t, 3> dims{script.byte() % 5U, 1 + script.byte() % 33U, 1 + script.byte() % 33U};
  const int rank = script.byte() % 4;
  const hid_t space = H5Screate_simple(rank, dims.data(), nullptr);
  const hid_t made =
      H5Dcreate2(file, name.c_str(), some_type(script), space, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
  if (made >= 0) H5Dclose(made);
  H5Sclose(space);
}

void edit(hid_t file, FuzzScript& script) {
  const auto& names = objects_of(file);
  const std::string& name = names[script.number<std::uint16_t>() % names.size()];
  const std::uint8_t what = script.byte();
  if (name != "." && what % 8 == 7) return replace(file, name, script);
  const hid_t object = H5Oopen(file, name.c_str(), H5P_DEFAULT);
  if (object < 0) return;
  if (what % 8 < 4 && H5Iget_type(object) == H5I_DATASET)
    change_values(object, script);
  else
    change_attribute(object, script);
  H5Oclose(object);
}

Bytes edited(FuzzScript& script) {
  const Bytes& sound = sound_file();
  const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
  H5Pset_fapl_core(access, 1U << 20U, false);
  H5Pset_file_image(access, const_cast<std::byte*>(sound.data()), sound.size());
  const hid_t file = H5Fopen("sound", H5F_ACC_RDWR, access);
  fuzz_require(file >= 0);
  for (int edits = 0; !script.done() && edits < 6; ++edits) edit(file, script);
  H5Fflush(file, H5F_SCOPE_GLOBAL);
  Bytes bytes(static_cast<std::size_t>(H5Fget_file_image(file, nullptr, 0)));
  H5Fget_file_image(file, bytes.data(), bytes.size());
  H5Fclose(file);
  H5Pclose(access);
  return bytes;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  FuzzScript script(data, size);
  const Bytes bytes = edited(script);
  const session::StoredFile file = tests::stored_bytes(bytes, "fuzz");
  test::read_or_refuse(ExitCode::not_a_session, [&] {
    const session::Session read = session::read_session(file);
    fuzz_require(read.samples.size() <= 100'000);
    session::quality_of(read);
  });
  return 0;
}

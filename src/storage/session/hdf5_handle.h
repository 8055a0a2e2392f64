// SPDX-License-Identifier: MIT
#pragma once

#include <hdf5.h>

#include <bit>
#include <concepts>
#include <cstdint>
#include <mutex>
#include <stdexcept>
#include <string>
#include <utility>

namespace thermorig::session {

/// HDF5 refused. Turned into an Error with the right exit code where the file's name is known.
class Hdf5Failure : public std::runtime_error {
 public:
  /// `action`: what cannot be done, "open /camera".
  explicit Hdf5Failure(const std::string& action) : std::runtime_error("cannot " + action) {}
};

/// Passes a result of the C API through; throws Hdf5Failure(action) if it is negative.
template <typename Result>
Result check(Result result, const std::string& action) {
  if (result < 0) throw Hdf5Failure(action);
  return result;
}

/// Owns one HDF5 identifier of any kind. Move-only.
class Handle {
 public:
  Handle() = default;
  Handle(hid_t id, const std::string& action) : id_(check(id, action)) {}
  ~Handle() { release(); }
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)) {}
  Handle& operator=(Handle&& other) noexcept {
    std::swap(id_, other.id_);
    return *this;
  }

  hid_t get() const { return id_; }

  /// Closes now, so that a failure is seen; the destructor would swallow it.
  void close(const std::string& action) {
    const hid_t id = std::exchange(id_, -1);
    check(H5Idec_ref(id), action);
  }

 private:
  void release() noexcept {
    if (id_ >= 0) H5Idec_ref(id_);
  }
  hid_t id_ = -1;
};

/// Empties the thread's list of the library's errors when it goes: the texts of a thread that ends would stay
/// in memory.
struct ClearedErrors {
  ClearedErrors() = default;
  ClearedErrors(const ClearedErrors&) = delete;
  ClearedErrors& operator=(const ClearedErrors&) = delete;
  ~ClearedErrors() { H5Eclear2(H5E_DEFAULT); }
};

/// The library may be in one thread at a time: who calls it holds this.
std::mutex& hdf5_turn();

/// Settings of the library that every entry needs: no printing on stderr, no filter plug-ins from outside.
inline void prepare_hdf5() {
  H5open();
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
  H5PLset_loading_state(0);
}

// Chunks are written as they lie in memory, so memory must have the file's byte order.
static_assert(std::endian::native == std::endian::little, "sessions are written on little-endian hosts only");

/// The type in the file, which is also the type in memory, of one element.
template <typename T>
hid_t stored_type() {
  if constexpr (std::same_as<T, std::uint8_t>) return H5T_STD_U8LE;
  if constexpr (std::same_as<T, std::uint16_t>) return H5T_STD_U16LE;
  if constexpr (std::same_as<T, std::uint32_t>) return H5T_STD_U32LE;
  if constexpr (std::same_as<T, std::uint64_t>) return H5T_STD_U64LE;
  if constexpr (std::same_as<T, std::int16_t>) return H5T_STD_I16LE;
  if constexpr (std::same_as<T, std::int32_t>) return H5T_STD_I32LE;
  if constexpr (std::same_as<T, std::int64_t>) return H5T_STD_I64LE;
  if constexpr (std::same_as<T, float>) return H5T_IEEE_F32LE;
  if constexpr (std::same_as<T, double>) return H5T_IEEE_F64LE;
}

}  // namespace thermorig::session

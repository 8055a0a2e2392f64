// SPDX-License-Identifier: MIT
#pragma once

#include <hdf5.h>

#include <bit>
#include <concepts>
#include <cstdint>

namespace thermorig::session {

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

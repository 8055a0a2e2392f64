// SPDX-License-Identifier: MIT
#include "image_memory.h"

#include <algorithm>
#include <cstddef>
#include <cstring>
#include <new>

namespace thermorig::session {

namespace {

constexpr std::size_t step_bytes = 16U << 20U;

/// Stands before the file: a file that grows by small steps is not copied at each.
struct Front {
  std::size_t capacity = 0;
  alignas(std::max_align_t) std::byte file[1];
};
constexpr std::size_t front_bytes = offsetof(Front, file);

Front* front_of(void* file) {
  return reinterpret_cast<Front*>(static_cast<std::byte*>(file) - front_bytes);
}

void* allocate(std::size_t bytes, H5FD_file_image_op_t /*why*/, void* /*data*/) {
  void* const at = ::operator new(front_bytes + bytes, std::nothrow);
  return at == nullptr ? nullptr : (new (at) Front{bytes, {}})->file;
}

void* copy(void* to, const void* from, std::size_t bytes, H5FD_file_image_op_t /*why*/, void* /*data*/) {
  return std::memcpy(to, from, bytes);
}

herr_t release(void* file, H5FD_file_image_op_t /*why*/, void* /*data*/) {
  if (file != nullptr) ::operator delete(front_of(file));
  return 0;
}

void* resize(void* file, std::size_t bytes, H5FD_file_image_op_t why, void* data) {
  if (file == nullptr) return allocate(bytes, why, data);
  const std::size_t capacity = front_of(file)->capacity;
  if (bytes <= capacity) return file;
  void* const grown = allocate(std::max(bytes, capacity + capacity / 2), why, data);
  if (grown == nullptr) return nullptr;
  std::memcpy(grown, file, capacity);
  release(file, why, data);
  return grown;
}

}  // namespace

Handle access_in_memory() {
  Handle access(H5Pcreate(H5P_FILE_ACCESS), "make properties");
  check(H5Pset_fapl_core(access.get(), step_bytes, false), "build the file in memory");
  H5FD_file_image_callbacks_t memory{allocate, copy, resize, release, nullptr, nullptr, nullptr};
  check(H5Pset_file_image_callbacks(access.get(), &memory), "build the file in memory");
  return access;
}

}  // namespace thermorig::session

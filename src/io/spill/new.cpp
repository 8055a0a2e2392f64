// SPDX-License-Identifier: MIT
// Replaces the program's `new` and `delete`, as C++ lets a program do: so no array that grows with a
// recording is forgotten, whichever library makes it. Small blocks go to malloc() as ever. The forms for
// arrays and those that do not throw end here as well; over-aligned ones are the standard library's own.
// A file of its own: a program that links this library and has a `new` of its own (a test that counts) keeps
// it.
#ifndef THERMORIG_LEAVES_NEW_ALONE
#include <cstdint>
#include <cstdlib>
#include <new>

#include "blocks.h"

namespace thermorig::spill {

namespace {

constexpr std::uintptr_t within_page = 4095;

void* allocate(std::size_t bytes) {
  if (is_on && blocks().is_large(bytes)) return blocks().allocate(bytes);
  return std::malloc(bytes == 0 ? 1 : bytes);
}

/// Mapped blocks begin with a page; few others do.
void release(void* at) {
  if (Blocks::is_inside()) return std::free(at);
  const bool may_be_mapped =
      is_on && at != nullptr && (reinterpret_cast<std::uintptr_t>(at) & within_page) == 0;
  if (may_be_mapped && blocks().release(at)) return;
  std::free(at);
}

}  // namespace

}  // namespace thermorig::spill

void* operator new(std::size_t bytes) {
  while (true) {
    if (void* const at = thermorig::spill::allocate(bytes)) return at;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* at) noexcept {
  thermorig::spill::release(at);
}

void operator delete(void* at, std::size_t /*bytes*/) noexcept {
  thermorig::spill::release(at);
}
#endif

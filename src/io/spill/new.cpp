// SPDX-License-Identifier: MIT
// Replaces the program's `new` and `delete`, as C++ lets a program do: so no array that grows with a
// recording is forgotten, whichever library makes it. Small blocks go to malloc() as ever. The forms for
// arrays and those that do not throw end here as well; over-aligned ones are the standard library's own.
// A file of its own: a program that links this library and has a `new` of its own (a test that counts) keeps
// it.
#ifndef THERMORIG_LEAVES_NEW_ALONE
#include <cstdlib>
#include <new>

#include "blocks.h"

using namespace thermorig;

void* operator new(std::size_t bytes) {
  while (true) {
    void* const at = spill::is_large(bytes) ? spill::map_block(bytes) : std::malloc(bytes == 0 ? 1 : bytes);
    if (at != nullptr) return at;
    const std::new_handler handler = std::get_new_handler();
    if (handler == nullptr) throw std::bad_alloc();
    handler();
  }
}

void operator delete(void* at) noexcept {
  if (!spill::unmap_block(at)) std::free(at);
}

void operator delete(void* at, std::size_t /*bytes*/) noexcept {
  operator delete(at);
}
#endif

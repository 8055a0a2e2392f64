// SPDX-License-Identifier: MIT
#include "allocation_count.h"

#include <malloc.h>

#include <algorithm>
#include <cstdlib>
#include <new>

namespace {

// The libraries' calls come here as well: these replace the program's operators.
bool counting = false;
std::ptrdiff_t held_bytes = 0, peak = 0;

void* counted(std::size_t size) {
  void* const memory = std::malloc(std::max<std::size_t>(size, 1));
  if (memory == nullptr) throw std::bad_alloc();
  if (counting) {
    held_bytes += static_cast<std::ptrdiff_t>(::malloc_usable_size(memory));
    peak = std::max(peak, held_bytes);
  }
  return memory;
}

void give_back(void* memory) noexcept {
  if (counting && memory != nullptr) held_bytes -= static_cast<std::ptrdiff_t>(::malloc_usable_size(memory));
  std::free(memory);
}

}  // namespace

void* operator new(std::size_t size) {
  return counted(size);
}
void* operator new[](std::size_t size) {
  return counted(size);
}
void operator delete(void* memory) noexcept {
  give_back(memory);
}
void operator delete[](void* memory) noexcept {
  give_back(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  give_back(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  give_back(memory);
}

namespace thermorig::model {

AllocationCount::AllocationCount() {
  held_bytes = peak = 0;
  counting = true;
}

AllocationCount::~AllocationCount() {
  counting = false;
}

std::size_t AllocationCount::peak_bytes() const {
  return static_cast<std::size_t>(std::max<std::ptrdiff_t>(peak, 0));
}

}  // namespace thermorig::model

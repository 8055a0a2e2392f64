// SPDX-License-Identifier: MIT
#include "thermorig/io/spill/spill.h"

#include <sys/mman.h>
#include <unistd.h>

#include <atomic>
#include <cstdint>
#include <map>
#include <mutex>
#include <new>

#include "blocks.h"
#include "thermorig/io/files/descriptor.h"

namespace thermorig::spill {

namespace {

constexpr std::uintptr_t within_page = 4095;

std::atomic<bool> is_on = false;
std::atomic<std::size_t> array_bytes = 0;

struct Block {
  std::size_t bytes = 0;
  bool is_on_disk = false;
};

/// All but the mutex is read and written under it.
struct Blocks {
  std::mutex mutex;
  std::filesystem::path near;
  std::size_t most_in_memory_bytes = 0;
  std::map<void*, Block> all;
  std::size_t in_memory_bytes = 0;
  std::size_t on_disk_bytes = 0;
};

/// Never destroyed: the last `delete` of the program may come after everything else.
Blocks& blocks() {
  alignas(Blocks) static std::byte place[sizeof(Blocks)];
  static Blocks* const made = ::new (place) Blocks;
  return *made;
}

thread_local bool inside = false;

/// Holds the lock, and says that this thread is inside: what is made and freed there are small blocks.
class Inside {
 public:
  Inside() : lock_((inside = true, blocks().mutex)) {}
  ~Inside() {
    lock_.unlock();
    inside = false;
  }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
};

void* mapped(std::size_t bytes, int flags, int file) {
  void* const at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, flags, file, 0);
  return at == MAP_FAILED ? nullptr : at;
}

/// The mapping keeps the file, which needs no descriptor. Nothing: no disk has the room.
void* map_file(const std::filesystem::path& near, std::size_t bytes) {
  const int file = files::open_unlinked(near, bytes);
  if (file < 0) return nullptr;
  void* const at = mapped(bytes, MAP_SHARED, file);
  ::close(file);
  return at;
}

}  // namespace

bool is_large(std::size_t bytes) {
  return is_on && bytes >= array_bytes;
}

void* map_block(std::size_t bytes) {
  const Inside lock;
  Blocks& own = blocks();
  const bool is_full = own.in_memory_bytes + bytes > own.most_in_memory_bytes;
  void* at = is_full ? map_file(own.near, bytes) : nullptr;
  const bool is_on_disk = at != nullptr;
  if (!is_on_disk) at = mapped(bytes, MAP_PRIVATE | MAP_ANONYMOUS, -1);
  if (at == nullptr) return nullptr;
  own.all.emplace(at, Block{bytes, is_on_disk});
  (is_on_disk ? own.on_disk_bytes : own.in_memory_bytes) += bytes;
  return at;
}

/// Mapped blocks begin with a page; few others do.
bool unmap_block(void* at) {
  if (!is_on || at == nullptr || (reinterpret_cast<std::uintptr_t>(at) & within_page) != 0 || inside)
    return false;
  const Inside lock;
  Blocks& own = blocks();
  const auto found = own.all.find(at);
  if (found == own.all.end()) return false;
  (found->second.is_on_disk ? own.on_disk_bytes : own.in_memory_bytes) -= found->second.bytes;
  ::munmap(at, found->second.bytes);
  own.all.erase(found);
  return true;
}

void arrays_near(const std::filesystem::path& near, const Limits& limits) {
  const Inside lock;
  blocks().near = near;
  blocks().most_in_memory_bytes = limits.in_memory_bytes;
  array_bytes = limits.array_bytes;
  is_on = true;
}

void arrays_in_memory() {
  is_on = false;
}

std::size_t spilled_bytes() {
  const Inside lock;
  return blocks().on_disk_bytes;
}

}  // namespace thermorig::spill

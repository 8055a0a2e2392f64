// SPDX-License-Identifier: MIT
#include "thermorig/io/spill/spill.h"

#include <sys/mman.h>
#include <unistd.h>

#include <new>

#include "blocks.h"
#include "thermorig/io/files/unlinked_file.h"

namespace thermorig::spill {

namespace {

thread_local bool inside = false;

/// The mapping keeps the file, which needs no descriptor. Nothing: no disk has the room.
void* map_file(const std::filesystem::path& near, std::size_t bytes) {
  const int file = files::open_unlinked(near, bytes);
  if (file < 0) return nullptr;
  void* const at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  return at == MAP_FAILED ? nullptr : at;
}

}  // namespace

/// Holds the lock, and says that this thread is inside.
class Blocks::Inside {
 public:
  explicit Inside(std::mutex& mutex) : lock_((inside = true, mutex)) {}
  ~Inside() {
    lock_.unlock();
    inside = false;
  }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

 private:
  std::unique_lock<std::mutex> lock_;
};

/// The last `delete` of the program may come after everything else.
Blocks& blocks() {
  alignas(Blocks) static std::byte place[sizeof(Blocks)];
  static Blocks* const all = ::new (place) Blocks;
  return *all;
}

void Blocks::configure(const std::filesystem::path& near, const Limits& limits) {
  const Inside lock(mutex_);
  near_ = near;
  limits_ = limits;
  array_bytes_ = limits.array_bytes;
}

bool Blocks::is_inside() {
  return inside;
}

void* Blocks::allocate(std::size_t bytes) {
  const Inside lock(mutex_);
  void* at = in_memory_bytes_ + bytes > limits_.in_memory_bytes ? map_file(near_, bytes) : nullptr;
  const bool is_on_disk = at != nullptr;
  if (!is_on_disk) at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) return nullptr;
  blocks_.emplace(at, Block{bytes, is_on_disk});
  (is_on_disk ? on_disk_bytes_ : in_memory_bytes_) += bytes;
  return at;
}

bool Blocks::release(void* at) {
  const Inside lock(mutex_);
  const auto found = blocks_.find(at);
  if (found == blocks_.end()) return false;
  (found->second.is_on_disk ? on_disk_bytes_ : in_memory_bytes_) -= found->second.bytes;
  ::munmap(at, found->second.bytes);
  blocks_.erase(found);
  return true;
}

std::size_t Blocks::on_disk_bytes() {
  const Inside lock(mutex_);
  return on_disk_bytes_;
}

void arrays_near(const std::filesystem::path& near, const Limits& limits) {
  blocks().configure(near, limits);
  is_on = true;
}

void arrays_in_memory() {
  is_on = false;
}

std::size_t spilled_bytes() {
  return blocks().on_disk_bytes();
}

}  // namespace thermorig::spill

// SPDX-License-Identifier: MIT
#include "blocks.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <new>
#include <system_error>

#include "interrupts.h"
#include "thermorig/io/files/unlinked_file.h"

namespace thermorig::spill {

namespace {

thread_local bool inside = false;
thread_local Interrupts interrupts;

/// Holds the lock, and says that this thread is inside. An interrupt could do nothing then, and what makes a
/// file as large as it shall be may begin anew after each (fallocate() of some file systems).
class Inside {
 public:
  explicit Inside(std::mutex& mutex) : lock_((inside = true, mutex)) {}
  ~Inside() {
    lock_.unlock();
    inside = false;
  }
  Inside(const Inside&) = delete;
  Inside& operator=(const Inside&) = delete;

 private:
  Uninterrupted uninterrupted_;
  std::unique_lock<std::mutex> lock_;
};

/// Mapped pages of files that are in memory: the third number of /proc/self/statm. 0: not known.
std::size_t resident_file_bytes(int statm) {
  std::array<char, 128> text{};
  const ssize_t size = ::pread(statm, text.data(), text.size(), 0);
  const char* at = text.data();
  const char* const end = at + (size > 0 ? size : 0);
  std::size_t number = 0;
  for (int i = 0; i < 3; ++i) {
    const auto [behind, error] = std::from_chars(at, end, number);
    if (error != std::errc()) return 0;
    at = behind == end ? end : behind + 1;
  }
  return number * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

}  // namespace

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
  void* at = nullptr;
  if (in_memory_bytes_ + bytes > limits_.in_memory_bytes) at = map_file(bytes);
  const bool is_on_disk = at != nullptr;
  if (!is_on_disk) at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (at == MAP_FAILED) return nullptr;
  blocks_.emplace(at, Block{bytes, is_on_disk});
  (is_on_disk ? on_disk_bytes_ : in_memory_bytes_) += bytes;
  if (is_on_disk) be_interrupted();
  if (is_on_disk) give_back();
  return at;
}

/// To unmap much takes long: meanwhile others look and give back.
bool Blocks::release(void* at) {
  const auto bytes = forget(at);
  if (bytes) ::munmap(at, *bytes);
  return bytes.has_value();
}

std::optional<std::size_t> Blocks::forget(void* at) {
  const Inside lock(mutex_);
  const auto found = blocks_.find(at);
  if (found == blocks_.end()) return std::nullopt;
  const Block block = found->second;
  blocks_.erase(found);
  (block.is_on_disk ? on_disk_bytes_ : in_memory_bytes_) -= block.bytes;
  return block.bytes;
}

std::size_t Blocks::on_disk_bytes() {
  const Inside lock(mutex_);
  return on_disk_bytes_;
}

/// The mapping keeps the file, which needs no descriptor.
void* Blocks::map_file(std::size_t bytes) const {
  const int file = files::open_unlinked(near_, bytes);
  if (file < 0) return nullptr;
  void* const at = ::mmap(nullptr, bytes, PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
  ::close(file);
  if (at == MAP_FAILED) return nullptr;
  ::madvise(at, bytes, MADV_NOHUGEPAGE);  // else one look may bring two megabytes
  return at;
}

/// Where the system has no timer to spare, it gives pages back by itself when memory runs short.
void Blocks::be_interrupted() {
  if (statm_ < 0) statm_ = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
  interrupts.begin([] { blocks().look(); });
}

/// Within an interrupt: whoever holds the lock may wait for what the interrupted code holds.
void Blocks::look() {
  const std::unique_lock lock(mutex_, std::try_to_lock);
  if (!lock) return;
  if (on_disk_bytes_ > 0) return give_back();
  interrupts.end();
}

void Blocks::limit_resident() {
  const Inside lock(mutex_);
  if (on_disk_bytes_ > 0) give_back();
}

/// Where what is not of the blocks is too much already, only what comes to it counts: an interrupt that
/// always found work would leave the thread no time for its own.
void Blocks::give_back() {
  if (resident_file_bytes(statm_) <=
      std::max(limits_.resident_bytes, of_others_ + limits_.resident_bytes / 2))
    return;
  for (const auto& [at, block] : blocks_)
    if (block.is_on_disk) ::madvise(at, block.bytes, MADV_DONTNEED);
  of_others_ = resident_file_bytes(statm_);
}

}  // namespace thermorig::spill

// SPDX-License-Identifier: MIT
#include "blocks.h"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <new>
#include <utility>

#include "thermorig/io/files/unlinked_file.h"

namespace thermorig::spill {

namespace {

constexpr std::chrono::nanoseconds look_every = std::chrono::microseconds(500);

thread_local bool inside = false;

/// Holds the lock, and says that this thread is inside.
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

void on_timer(int /*signal*/) {
  const int kept = errno;
  blocks().limit_resident();
  errno = kept;
}

}  // namespace

/// Waits for a look at the blocks to end, and keeps others from it.
class Blocks::Changing {
 public:
  explicit Changing(Blocks& blocks) : flag_(blocks.is_changing_) {
    while (flag_.test_and_set(std::memory_order_acquire)) ::sched_yield();
  }
  ~Changing() { flag_.clear(std::memory_order_release); }
  Changing(const Changing&) = delete;
  Changing& operator=(const Changing&) = delete;

 private:
  std::atomic_flag& flag_;
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
  resident_bytes_ = limits.resident_bytes;
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
  {
    const Changing changing(*this);
    blocks_.emplace(at, Block{bytes, is_on_disk});
  }
  if (is_on_disk && on_disk_bytes_ == 0) set_timer(true);
  (is_on_disk ? on_disk_bytes_ : in_memory_bytes_) += bytes;
  return at;
}

bool Blocks::release(void* at) {
  const Inside lock(mutex_);
  const auto found = blocks_.find(at);
  if (found == blocks_.end()) return false;
  const Block block = found->second;
  {
    const Changing changing(*this);
    blocks_.erase(found);
  }
  (block.is_on_disk ? on_disk_bytes_ : in_memory_bytes_) -= block.bytes;
  if (block.is_on_disk && on_disk_bytes_ == 0) set_timer(false);
  ::munmap(at, block.bytes);
  return true;
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
  return at == MAP_FAILED ? nullptr : at;
}

/// Where the system has no timer to spare, it gives pages back by itself when memory runs short.
void Blocks::set_timer(bool runs) {
  if (!has_timer_ && runs) {
    statm_ = ::open("/proc/self/statm", O_RDONLY | O_CLOEXEC);
    struct sigaction action {};
    action.sa_handler = on_timer;
    action.sa_flags = SA_RESTART;
    sigevent event{};
    event.sigev_notify = SIGEV_SIGNAL;
    event.sigev_signo = SIGPROF;
    has_timer_ =
        ::sigaction(SIGPROF, &action, nullptr) == 0 && ::timer_create(CLOCK_MONOTONIC, &event, &timer_) == 0;
  }
  if (!has_timer_) return;
  const timespec every{0, runs ? static_cast<long>(look_every.count()) : 0};
  const itimerspec setting{every, every};
  ::timer_settime(timer_, 0, &setting, nullptr);
}

void Blocks::limit_resident() {
  if (is_changing_.test_and_set(std::memory_order_acquire)) return;
  if (statm_ >= 0 && resident_file_bytes(statm_) > resident_bytes_)
    for (const auto& [at, block] : blocks_)
      if (block.is_on_disk) ::madvise(at, block.bytes, MADV_DONTNEED);
  is_changing_.clear(std::memory_order_release);
}

}  // namespace thermorig::spill

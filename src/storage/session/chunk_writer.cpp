// SPDX-License-Identifier: MIT
#include "chunk_writer.h"

#include <libdeflate.h>
#include <zlib.h>

#include <algorithm>
#include <array>

#include "attributes.h"
#include "chunk_codec.h"

namespace thermorig::session {

namespace {

std::uint32_t crc32_of(std::span<const std::byte> bytes) {
  return libdeflate_crc32(0, bytes.data(), bytes.size());
}

}  // namespace

ChunkWriter::ChunkWriter(unsigned threads) {
  for (unsigned i = 0; i < std::max(threads, 1U); ++i) threads_.emplace_back([this] { work(); });
}

ChunkWriter::~ChunkWriter() {
  stop();
}

void ChunkWriter::stop() noexcept {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    next_ = jobs_.size();
  }
  changed_.notify_all();
  for (auto& thread : threads_)
    if (thread.joinable()) thread.join();
}

hid_t ChunkWriter::add(Handle handle, Layout layout, Fill fill) {
  // Its room is taken before any chunk's: all that describes a file stands before the values in it, where a
  // file that is cut short still has it.
  set_attribute(handle.get(), "crc32", std::uint32_t{0});
  const std::lock_guard lock(mutex_);
  Dataset& dataset = datasets_.emplace_back(Dataset{std::move(handle), std::move(layout), std::move(fill)});
  for (std::size_t first = 0; first < dataset.layout.rows; first += dataset.layout.chunk_rows)
    jobs_.push_back({&dataset, first});
  changed_.notify_all();
  return dataset.handle.get();
}

void ChunkWriter::work() {
  try {
    ChunkCodec codec;
    std::vector<std::byte> buffer;
    std::unique_lock lock(mutex_);
    while (true) {
      changed_.wait(lock, [this] { return ended_ || may_begin(); });
      if (ended_) return;
      Job& job = jobs_[next_++];
      lock.unlock();
      run(job, codec, buffer);
      lock.lock();
      job.done = true;
      unwritten_bytes_ += job.encoded.size();
      changed_.notify_all();
    }
  } catch (...) {
    const std::lock_guard lock(mutex_);
    failure_ = std::current_exception();
    changed_.notify_all();
  }
}

void ChunkWriter::run(Job& job, ChunkCodec& codec, std::vector<std::byte>& buffer) const {
  const Layout& layout = job.dataset->layout;
  const std::size_t rows = std::min<std::size_t>(layout.chunk_rows, layout.rows - job.first);
  // A chunk is always stored whole: what lies beyond the last row is zero.
  buffer.resize(layout.chunk_rows * layout.row_bytes);
  std::fill(buffer.begin() + static_cast<std::ptrdiff_t>(rows * layout.row_bytes), buffer.end(),
            std::byte{0});
  job.dataset->fill(job.first, rows, buffer.data());
  job.row_crc = crc32_of(std::span(buffer).first(rows * layout.row_bytes));
  job.encoded = codec.encode(buffer, layout.element_bytes);
}

ChunkWriter::Job& ChunkWriter::wait_for(std::size_t index) {
  std::unique_lock lock(mutex_);
  Job& job = jobs_[index];
  changed_.wait(lock, [&] { return job.done || failure_; });
  if (failure_) std::rethrow_exception(failure_);
  return job;
}

void ChunkWriter::release(Job& job) {
  const std::vector<std::byte> written = std::move(job.encoded);
  const std::lock_guard lock(mutex_);
  unwritten_bytes_ -= written.size();
  changed_.notify_all();
}

std::vector<StoredDataset> ChunkWriter::finish() {
  std::vector<StoredDataset> stored;
  std::size_t index = 0;
  for (auto& dataset : datasets_) {
    const Layout& layout = dataset.layout;
    StoredDataset entry{layout.path, layout.rows, layout.chunk_rows, {}};
    uLong crc = 0;
    for (std::size_t first = 0; first < layout.rows; first += layout.chunk_rows) {
      Job& job = wait_for(index++);
      const std::array<hsize_t, 3> offset{first, 0, 0};
      check(H5Dwrite_chunk(dataset.handle.get(), H5P_DEFAULT, 0, offset.data(), job.encoded.size(),
                           job.encoded.data()),
            "write " + layout.path);
      entry.chunk_crc.push_back(crc32_of(job.encoded));
      const std::size_t rows = std::min<std::size_t>(layout.chunk_rows, layout.rows - first);
      crc = crc32_combine(crc, job.row_crc, static_cast<z_off_t>(rows * layout.row_bytes));
      release(job);
    }
    set_attribute(dataset.handle.get(), "crc32", static_cast<std::uint32_t>(crc));
    dataset.handle.close("close " + layout.path);
    stored.push_back(std::move(entry));
  }
  stop();
  return stored;
}

}  // namespace thermorig::session

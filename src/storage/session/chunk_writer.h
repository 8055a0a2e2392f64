// SPDX-License-Identifier: MIT
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <exception>
#include <functional>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "hdf5_handle.h"

namespace thermorig::session {

/// What was stored of one dataset: what a look at the finished file is compared with.
struct StoredDataset {
  std::string path;
  std::uint64_t rows = 0;
  std::uint64_t chunk_rows = 0;
  std::vector<std::uint32_t> chunk_crc;  // CRC-32 of each chunk as it stands in the file
};

/// Fills and compresses the chunks of many datasets on all cores while the caller goes on creating datasets;
/// finish() puts them into the file, in order, from the calling thread alone. The file does not depend on the
/// number of threads.
class ChunkWriter {
 public:
  /// Writes `rows` rows from row `first` on to `out`. Called from other threads.
  using Fill = std::function<void(std::size_t first, std::size_t rows, std::byte* out)>;

  struct Layout {
    std::string path;
    std::uint64_t rows = 0;
    std::uint64_t chunk_rows = 1;
    std::size_t row_bytes = 1;
    std::size_t element_bytes = 1;
  };

  explicit ChunkWriter(unsigned threads);
  ~ChunkWriter();
  ChunkWriter(const ChunkWriter&) = delete;
  ChunkWriter& operator=(const ChunkWriter&) = delete;

  /// Queues all chunks of a dataset. What `fill` refers to must live until finish() has returned.
  /// Returns the dataset's identifier, which stays open until then.
  hid_t add(Handle dataset, Layout layout, Fill fill);

  /// Waits for the chunks, writes them, and gives each dataset its `crc32` attribute.
  std::vector<StoredDataset> finish();

 private:
  static constexpr std::size_t unwritten_bytes_max = 4U << 20U;  // and a chunk more for each thread

  struct Dataset {
    Handle handle;
    Layout layout;
    Fill fill;
  };
  struct Job {
    const Dataset* dataset;
    std::size_t first;
    std::vector<std::byte> encoded;
    std::uint32_t row_crc = 0;  // CRC-32 of the rows, before the filters
    bool done = false;
  };

  bool may_begin() const { return next_ < jobs_.size() && unwritten_bytes_ < unwritten_bytes_max; }
  void work();
  void run(Job& job, class ChunkCodec& codec, std::vector<std::byte>& buffer) const;
  Job& wait_for(std::size_t index);
  void release(Job& job);
  void stop() noexcept;

  std::deque<Dataset> datasets_;
  std::deque<Job> jobs_;  // grows at its end only: references stay valid
  std::size_t next_ = 0;
  std::size_t unwritten_bytes_ = 0;  // of compressed chunks that finish() has not put into the file yet
  bool ended_ = false;
  std::exception_ptr failure_;
  std::mutex mutex_;
  std::condition_variable changed_;
  std::vector<std::thread> threads_;
};

}  // namespace thermorig::session

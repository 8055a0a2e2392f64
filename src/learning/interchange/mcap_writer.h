// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "checked_sink.h"
#include "thermorig/learning/interchange/formats.h"

namespace thermorig::interchange {

/// A topic of an MCAP file: its messages are JSON.
struct McapChannel {
  std::string topic;
  std::string schema_name;
  std::string schema;  // JSON Schema
};

/// Writes an MCAP file (https://mcap.dev/spec, version 0) from front to end: chunks, each with its indices, a
/// summary, all check sums. Keeps one chunk, and 100 bytes or so of each that was.
class McapWriter {
 public:
  /// Of at most 65,535 channels; `facts` become a metadata record `session`.
  McapWriter(Sink& sink, McapCompression compression, const std::string& library,
             std::vector<McapChannel> channels, const std::map<std::string, std::string>& facts);

  /// A message on a channel, by index. Messages may come in any order of time; readers like them ascending.
  void add(std::size_t channel, std::uint64_t time_ns, std::string_view data);

  /// The rest of it; the last call.
  void finish();

 private:
  struct Chunk {
    std::uint64_t first_ns = 0, last_ns = 0, begin = 0, length = 0, indices_length = 0;
    std::uint64_t size = 0, stored_size = 0;             // of its records
    std::map<std::uint16_t, std::uint64_t> index_begin;  // by channel
  };
  struct Place {
    std::uint64_t time_ns, offset;
  };

  void write_header(const std::string& library, const std::map<std::string, std::string>& facts);
  void write_chunk();
  void write_summary();
  void write_record(std::uint8_t kind, const std::string& content);
  void note_time(std::uint64_t time_ns, bool is_first, std::uint64_t& first_ns, std::uint64_t& last_ns) const;
  std::string schemas() const;
  std::string channels() const;
  std::string chunk_indices() const;
  std::string statistics() const;

  CheckedSink sink_;
  McapCompression compression_;
  std::vector<McapChannel> channels_;
  std::vector<std::uint64_t> counts_;         // of messages, by channel
  std::string records_;                       // of the present chunk
  std::vector<std::vector<Place>> in_chunk_;  // by channel
  Chunk now_;
  std::vector<Chunk> chunks_;
  std::uint64_t first_ns_ = 0, last_ns_ = 0, messages_ = 0, metadata_begin_ = 0, metadata_length_ = 0;
};

}  // namespace thermorig::interchange

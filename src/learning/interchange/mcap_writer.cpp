// SPDX-License-Identifier: MIT
#include "mcap_writer.h"

#include <zstd.h>

#include <algorithm>
#include <new>
#include <utility>

#include "checked_sink.h"

namespace thermorig::interchange {

namespace {

constexpr std::size_t chunk_bytes = 1U << 20U;
constexpr std::string_view magic{"\x89MCAP0\r\n", 8};
constexpr int zstd_level = 3;  // the library's own choice

enum Kind : std::uint8_t {
  header = 0x01,
  footer = 0x02,
  schema = 0x03,
  channel = 0x04,
  message = 0x05,
  chunk = 0x06,
  message_index = 0x07,
  chunk_index = 0x08,
  statistics_record = 0x0B,
  metadata = 0x0C,
  metadata_index = 0x0D,
  summary_offset = 0x0E,
  data_end = 0x0F
};

constexpr std::string_view metadata_name = "session";

void append_string(std::string& bytes, std::string_view text) {
  append_little_endian(bytes, static_cast<std::uint32_t>(text.size()));
  bytes += text;
}

void append_record(std::string& bytes, std::uint8_t kind, const std::string& content) {
  append_little_endian(bytes, kind, static_cast<std::uint64_t>(content.size()));
  bytes += content;
}

std::string map_of(const std::map<std::string, std::string>& entries) {
  std::string content;
  for (const auto& [key, value] : entries) {
    append_string(content, key);
    append_string(content, value);
  }
  return content;
}

std::string_view name_of(McapCompression compression) {
  return compression == McapCompression::zstd ? "zstd" : "";
}

/// Of one chunk.
std::string stored_records(const std::string& records, McapCompression compression) {
  if (compression == McapCompression::none) return records;
  std::string bytes(ZSTD_compressBound(records.size()), '\0');
  const std::size_t size =
      ZSTD_compress(bytes.data(), bytes.size(), records.data(), records.size(), zstd_level);
  if (ZSTD_isError(size) != 0) throw std::bad_alloc();  // there is room: nothing else can go wrong
  bytes.resize(size);
  return bytes;
}

/// Channels and schemas have the same numbers, from 1.
std::uint16_t number_of(std::size_t channel_index) {
  return static_cast<std::uint16_t>(channel_index + 1);
}

}  // namespace

McapWriter::McapWriter(Sink& sink, McapCompression compression, const std::string& library,
                       std::vector<McapChannel> channels, const std::map<std::string, std::string>& facts)
    : sink_(&sink),
      compression_(compression),
      channels_(std::move(channels)),
      counts_(channels_.size()),
      in_chunk_(channels_.size()) {
  write_header(library, facts);
}

void McapWriter::write_record(std::uint8_t kind, const std::string& content) {
  std::string record;
  append_record(record, kind, content);
  sink_.write(std::string_view(record));
}

void McapWriter::write_header(const std::string& library, const std::map<std::string, std::string>& facts) {
  sink_.write(magic);
  std::string content;
  append_string(content, "");  // of no profile
  append_string(content, library);
  write_record(Kind::header, content);
  sink_.write(std::string_view(schemas() + McapWriter::channels()));
  content.clear();
  append_string(content, metadata_name);
  append_string(content, map_of(facts));
  metadata_begin_ = sink_.size();
  write_record(Kind::metadata, content);
  metadata_length_ = sink_.size() - metadata_begin_;
}

std::string McapWriter::schemas() const {
  std::string records;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    std::string content;
    append_little_endian(content, number_of(i));
    append_string(content, channels_[i].schema_name);
    append_string(content, "jsonschema");
    append_string(content, channels_[i].schema);
    append_record(records, Kind::schema, content);
  }
  return records;
}

std::string McapWriter::channels() const {
  std::string records;
  for (std::size_t i = 0; i < channels_.size(); ++i) {
    std::string content;
    append_little_endian(content, number_of(i), number_of(i));
    append_string(content, channels_[i].topic);
    append_string(content, "json");
    append_string(content, map_of({}));
    append_record(records, Kind::channel, content);
  }
  return records;
}

void McapWriter::note_time(std::uint64_t time_ns, bool is_first, std::uint64_t& first_ns,
                           std::uint64_t& last_ns) const {
  first_ns = is_first ? time_ns : std::min(first_ns, time_ns);
  last_ns = is_first ? time_ns : std::max(last_ns, time_ns);
}

void McapWriter::add(std::size_t channel_index, std::uint64_t time_ns, std::string_view data) {
  note_time(time_ns, records_.empty(), now_.first_ns, now_.last_ns);
  note_time(time_ns, messages_ == 0, first_ns_, last_ns_);
  in_chunk_[channel_index].push_back({time_ns, records_.size()});
  std::string content;
  append_little_endian(content, number_of(channel_index), static_cast<std::uint32_t>(counts_[channel_index]),
                       time_ns, time_ns);
  content += data;
  append_record(records_, Kind::message, content);
  ++counts_[channel_index];
  ++messages_;
  if (records_.size() >= chunk_bytes) write_chunk();
}

void McapWriter::write_chunk() {
  if (records_.empty()) return;
  now_.begin = sink_.size();
  now_.size = records_.size();
  std::string content;
  append_little_endian(content, now_.first_ns, now_.last_ns, now_.size,
                       libdeflate_crc32(0, records_.data(), records_.size()));
  append_string(content, name_of(compression_));
  const std::string records = stored_records(records_, compression_);
  now_.stored_size = records.size();
  append_little_endian(content, now_.stored_size);
  content += records;
  write_record(Kind::chunk, content);
  now_.length = sink_.size() - now_.begin;
  for (std::size_t i = 0; i < in_chunk_.size(); ++i) {
    if (in_chunk_[i].empty()) continue;
    now_.index_begin[number_of(i)] = sink_.size();
    std::string places;
    for (const Place& place : in_chunk_[i]) append_little_endian(places, place.time_ns, place.offset);
    std::string index;
    append_little_endian(index, number_of(i));
    append_string(index, places);
    write_record(Kind::message_index, index);
    in_chunk_[i].clear();
  }
  now_.indices_length = sink_.size() - now_.begin - now_.length;
  chunks_.push_back(std::exchange(now_, {}));
  records_.clear();
}

std::string McapWriter::chunk_indices() const {
  std::string records;
  for (const Chunk& written : chunks_) {
    std::string indices;
    for (const auto& [number, begin] : written.index_begin) append_little_endian(indices, number, begin);
    std::string content;
    append_little_endian(content, written.first_ns, written.last_ns, written.begin, written.length);
    append_string(content, indices);
    append_little_endian(content, written.indices_length);
    append_string(content, name_of(compression_));
    append_little_endian(content, written.stored_size, written.size);
    append_record(records, Kind::chunk_index, content);
  }
  return records;
}

std::string McapWriter::statistics() const {
  std::string counts;
  for (std::size_t i = 0; i < counts_.size(); ++i) append_little_endian(counts, number_of(i), counts_[i]);
  const auto channel_count = static_cast<std::uint32_t>(channels_.size());
  std::string content, record;
  append_little_endian(content, messages_, static_cast<std::uint16_t>(channel_count), channel_count,
                       std::uint32_t{0}, std::uint32_t{1}, static_cast<std::uint32_t>(chunks_.size()),
                       first_ns_, last_ns_);
  append_string(content, counts);
  append_record(record, Kind::statistics_record, content);
  return record;
}

void McapWriter::write_summary() {
  std::string index, content;
  append_little_endian(content, metadata_begin_, metadata_length_);
  append_string(content, metadata_name);
  append_record(index, Kind::metadata_index, content);
  const std::vector<std::pair<Kind, std::string>> groups{{Kind::schema, schemas()},
                                                         {Kind::channel, McapWriter::channels()},
                                                         {Kind::statistics_record, statistics()},
                                                         {Kind::chunk_index, chunk_indices()},
                                                         {Kind::metadata_index, index}};
  const std::uint64_t summary_begin = sink_.size();
  sink_.restart_crc();
  std::string offsets;
  for (const auto& [kind, records] : groups) {
    if (records.empty()) continue;
    std::string offset;
    append_little_endian(offset, static_cast<std::uint8_t>(kind), sink_.size(),
                         static_cast<std::uint64_t>(records.size()));
    append_record(offsets, Kind::summary_offset, offset);
    sink_.write(std::string_view(records));
  }
  const std::uint64_t offsets_begin = sink_.size();
  sink_.write(std::string_view(offsets));
  std::string footer;
  append_little_endian(footer, static_cast<std::uint8_t>(Kind::footer), std::uint64_t{20}, summary_begin,
                       offsets_begin);
  sink_.write(std::string_view(footer));
  std::string crc;
  append_little_endian(crc, sink_.crc());
  sink_.write(std::string_view(crc));
}

void McapWriter::finish() {
  write_chunk();
  std::string crc;
  append_little_endian(crc, sink_.crc());
  write_record(Kind::data_end, crc);
  write_summary();
  sink_.write(magic);
}

}  // namespace thermorig::interchange

// SPDX-License-Identifier: MIT
#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "payload.h"
#include "record.h"
#include "thermorig/core/error.h"
#include "thermorig/journal/journal.h"
#include "thermorig/recording_header/header_json.h"

namespace thermorig::journal {

namespace {

using Bytes = std::span<const std::uint8_t>;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw Error(ExitCode::not_a_session, what, path.string(),
              "name a .journal file that thermorig record left");
}

/// A regular file, read from its front through a buffer.
class SourceFile {
 public:
  explicit SourceFile(const std::filesystem::path& path) {
    // NONBLOCK: a FIFO must not hang us before fstat() tells what it is.
    descriptor_ = ::open(path.c_str(), O_RDONLY | O_NONBLOCK | O_CLOEXEC);
    if (descriptor_ < 0) refuse(path, std::string("cannot be opened: ") + std::strerror(errno));
    struct stat info {};
    if (::fstat(descriptor_, &info) == 0 && S_ISREG(info.st_mode)) {
      size_ = static_cast<std::uint64_t>(info.st_size);
      return;
    }
    ::close(descriptor_);
    refuse(path, "is not a regular file");
  }
  ~SourceFile() { ::close(descriptor_); }
  SourceFile(const SourceFile&) = delete;
  SourceFile& operator=(const SourceFile&) = delete;

  std::uint64_t size() const { return size_; }

  /// Fills `out` with the next bytes; false if there are not so many.
  bool read(std::span<std::uint8_t> out) {
    while (!out.empty()) {
      if (next_ == buffered_ && !refill()) return false;
      const std::size_t count = std::min(out.size(), buffered_ - next_);
      std::copy_n(buffer_.begin() + static_cast<std::ptrdiff_t>(next_), count, out.begin());
      next_ += count;
      out = out.subspan(count);
    }
    return true;
  }

 private:
  bool refill() {
    const ssize_t count = ::read(descriptor_, buffer_.data(), buffer_.size());
    next_ = 0;
    buffered_ = count > 0 ? static_cast<std::size_t>(count) : 0;
    return buffered_ > 0;
  }

  int descriptor_ = -1;
  std::uint64_t size_ = 0;
  std::vector<std::uint8_t> buffer_ = std::vector<std::uint8_t>(64U << 10U);
  std::size_t next_ = 0;
  std::size_t buffered_ = 0;
};

/// One record after another; nothing at the first that is torn, damaged or of another journal.
class RecordReader {
 public:
  explicit RecordReader(SourceFile& source) : source_(source) {}

  std::optional<RecordFront> next() {
    FrontBytes bytes;
    if (left() < front_bytes || !source_.read(bytes)) return std::nullopt;
    const auto front = decode_front(bytes);
    // The length is believed only as far as the file reaches: nothing is allocated for what is not there.
    if (!front || front->sequence != records_ || front->length > left() - front_bytes) return std::nullopt;
    if (records_ > 0 && front->journal_id != id_) return std::nullopt;
    payload_.resize(front->length);
    if (!source_.read(payload_) || !crc_is_good(bytes, payload_)) return std::nullopt;
    return front;
  }

  void accept(const RecordFront& front) {
    id_ = front.journal_id;
    ++records_;
    bytes_read_ += front_bytes + front.length;
  }

  Bytes payload() const { return payload_; }
  std::uint64_t records() const { return records_; }
  std::uint64_t bytes_read() const { return bytes_read_; }

 private:
  std::uint64_t left() const { return source_.size() - bytes_read_; }

  SourceFile& source_;
  std::vector<std::uint8_t> payload_;
  std::uint64_t id_ = 0;
  std::uint64_t records_ = 0;
  std::uint64_t bytes_read_ = 0;
};

bool take_chunk(RawStream& stream, Bytes payload, RawRecording& recording) {
  const auto time = decode_time(payload);
  if (!time) return false;
  stream.append(payload.subspan(time_bytes), *time);
  recording.end_time = *time;
  return true;
}

bool take_event(Bytes payload, RawRecording& recording) {
  auto event = decode_event(payload);
  if (!event) return false;
  recording.end_time = event->time;
  recording.events.push_back(std::move(*event));
  return true;
}

bool take_leg(Bytes payload, RawRecording& recording) {
  const auto leg = decode_leg(payload);
  if (leg) recording.legs.push_back(*leg);
  return leg.has_value();
}

/// Frames are told once, in their order.
bool take_estimate(Bytes payload, RawRecording& recording) {
  const auto row = decode_estimate(payload);
  if (!row || (!recording.estimates.empty() && row->frame_index <= recording.estimates.back().frame_index))
    return false;
  recording.estimates.push_back(*row);
  return true;
}

bool take_end(Bytes payload, RawRecording& recording) {
  const auto time = decode_time(payload);
  if (!time) return false;
  recording.end_time = *time;
  recording.complete = true;
  return true;
}

/// False if the record, although whole, says nothing that a recorder writes.
bool take(const RecordFront& front, Bytes payload, RawRecording& recording) {
  switch (front.type) {
    case RecordType::received:
      return front.device < device_count &&
             take_chunk(recording.received[static_cast<Device>(front.device)], payload, recording);
    case RecordType::sent:
      return take_chunk(recording.sent, payload, recording);
    case RecordType::event:
      return take_event(payload, recording);
    case RecordType::leg:
      return take_leg(payload, recording);
    case RecordType::estimate:
      return take_estimate(payload, recording);
    case RecordType::end:
      return take_end(payload, recording);
    case RecordType::header:
      break;  // a second header
  }
  return false;
}

}  // namespace

JournalContents read_journal(const std::filesystem::path& path) {
  SourceFile source(path);
  RecordReader reader(source);
  const auto header = reader.next();
  if (!header || header->type != RecordType::header)
    refuse(path, "is not a journal, or its first record is damaged");
  JournalContents contents;
  auto& recording = contents.recording;
  const std::string text(reader.payload().begin(), reader.payload().end());
  recording.header = recording_header::header_from_json_text(text, path.string());
  recording.end_time = recording.header.time_reference;
  reader.accept(*header);
  while (!recording.complete) {
    const auto front = reader.next();
    if (!front || !take(*front, reader.payload(), recording)) break;
    reader.accept(*front);
  }
  contents.records = reader.records();
  contents.bytes_read = reader.bytes_read();
  contents.bytes_ignored = source.size() - reader.bytes_read();
  return contents;
}

bool is_journal(const std::filesystem::path& path) {
  SourceFile source(path);
  FrontBytes bytes;
  if (!source.read(bytes)) return false;
  const auto front = decode_front(bytes);
  return front && front->type == RecordType::header && front->sequence == 0;
}

}  // namespace thermorig::journal

// SPDX-License-Identifier: MIT
#include <algorithm>
#include <cerrno>
#include <cstring>
#include <initializer_list>
#include <utility>

#include "record.h"
#include "thermorig/core/error.h"
#include "thermorig/core/printable.h"
#include "thermorig/storage/journal/journal.h"
#include "thermorig/storage/recording_header/header_json.h"

namespace thermorig::journal {

namespace {

using Bytes = std::span<const std::uint8_t>;

[[noreturn]] void refuse(const std::filesystem::path& path, const std::string& what) {
  throw Error(ExitCode::not_a_session, what, path.string(),
              "name a .journal file that thermorig record left");
}

/// A disk that fails is no fault of the file.
[[noreturn]] void refuse_call(const std::filesystem::path& path, const char* what, int error_number) {
  const std::string sentence = std::string(what) + ": " + std::strerror(error_number);
  if (error_number == EACCES || error_number == EPERM)
    throw Error(ExitCode::no_permission, sentence, path.string(),
                "see who may read it: ls -l " + shell_word(path.string()));
  if (error_number != EIO) refuse(path, sentence);
  throw Error(ExitCode::storage, sentence, path.string(),
              "check the disk (dmesg), then run thermorig recover: the journal is still there");
}

/// A regular file, read from its front through a buffer.
class SourceFile {
 public:
  SourceFile(const std::filesystem::path& path, files::Disk& disk)
      : path_(path), disk_(disk), file_(disk, open(path, disk)) {
    const auto size = disk.size(file_.get());
    if (size.error_number == EINVAL) refuse(path, "is not a regular file");
    if (!size.good()) refuse_call(path, "cannot be accessed", size.error_number);
    size_ = size.value;
  }

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
  static files::OpenFile open(const std::filesystem::path& path, files::Disk& disk) {
    const auto opened = disk.open(path);
    if (!opened.good()) refuse_call(path, "cannot be opened", opened.error_number);
    return opened.value;
  }

  /// A disk that cannot read must not pass for a journal that ends here.
  bool refill() {
    const auto count = disk_.read(file_.get(), offset_, std::as_writable_bytes(std::span(buffer_)));
    if (!count.good()) refuse_call(path_, "cannot be read", count.error_number);
    next_ = 0;
    buffered_ = count.value;
    offset_ += count.value;
    return buffered_ > 0;
  }

  const std::filesystem::path& path_;
  files::Disk& disk_;
  files::ClosedOnExit file_;
  std::uint64_t size_ = 0;
  std::uint64_t offset_ = 0;  // of the next refill
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

/// A time that no recorder can have written would run out of the clock's range wherever it is counted with.
bool is_possible(std::initializer_list<HostTime> times, const RawRecording& recording) {
  return std::all_of(times.begin(), times.end(),
                     [&](HostTime time) { return is_of_recording(time, recording.header.time_reference); });
}

bool take_chunk(PerDevice<RawStream>& streams, std::uint8_t device, Bytes payload, RawRecording& recording) {
  const auto time = decode_time(payload);
  if (device >= device_count || !time || !is_possible({*time}, recording)) return false;
  streams[static_cast<Device>(device)].append(payload.subspan(time_bytes), *time);
  recording.end_time = *time;
  return true;
}

bool take_event(Bytes payload, RawRecording& recording) {
  auto event = decode_event(payload);
  if (!event || !is_possible({event->time}, recording)) return false;
  recording.end_time = event->time;
  recording.events.push_back(std::move(*event));
  return true;
}

bool take_leg(Bytes payload, RawRecording& recording) {
  const auto leg = decode_leg(payload);
  if (!leg || !is_possible({leg->begin, leg->end}, recording)) return false;
  recording.legs.push_back(*leg);
  return true;
}

/// Frames are told once, in their order.
bool take_row(const std::optional<EstimateRow>& row, RawRecording& recording) {
  if (!row || !is_possible({row->time, row->exposure_begin, row->exposure_end, row->arrival}, recording))
    return false;
  if (!recording.estimates.empty() && row->frame_index <= recording.estimates.back().frame_index)
    return false;
  recording.estimates.push_back(*row);
  return true;
}

bool take_estimates(Bytes payload, RawRecording& recording) {
  if (recording.header.estimators.empty()) return false;
  return take_row(decode_estimates(payload, recording.header.estimators.size()), recording);
}

/// Of before format 2, when the header did not name estimators.
bool take_estimate(Bytes payload, RawRecording& recording) {
  if (!take_row(decode_estimate(payload), recording)) return false;
  recording.header.estimators = columns_before_format_2(recording.header.live_model);
  return true;
}

bool take_end(Bytes payload, RawRecording& recording) {
  const auto time = decode_time(payload);
  if (!time || !is_possible({*time}, recording)) return false;
  recording.end_time = *time;
  recording.complete = true;
  return true;
}

/// False if the record, although whole, says nothing that a recorder writes.
bool take(const RecordFront& front, Bytes payload, RawRecording& recording) {
  switch (front.type) {
    case RecordType::received:
      return take_chunk(recording.received, front.device, payload, recording);
    case RecordType::sent:
      return take_chunk(recording.sent, front.device, payload, recording);
    case RecordType::event:
      return take_event(payload, recording);
    case RecordType::leg:
      return take_leg(payload, recording);
    case RecordType::estimate:
      return take_estimate(payload, recording);
    case RecordType::estimates:
      return take_estimates(payload, recording);
    case RecordType::end:
      return take_end(payload, recording);
    case RecordType::header:
      break;  // a second header
  }
  return false;
}

/// `budget`: bytes that may still be checked; what would need more counts as a record.
bool has_record_at(Bytes bytes, std::size_t at, std::size_t& budget) {
  FrontBytes front_at;
  std::copy_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), front_bytes, front_at.begin());
  const auto front = decode_front(front_at);
  const Bytes behind = bytes.subspan(at + front_bytes);
  if (!front || front->length > behind.size()) return false;
  if (front->length > budget) return true;
  budget -= front->length;
  return crc_is_good(front_at, behind.first(front->length));
}

}  // namespace

JournalContents read_journal(const std::filesystem::path& path, files::Disk& disk) {
  SourceFile source(path, disk);
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

bool is_journal(const std::filesystem::path& path, files::Disk& disk) {
  SourceFile source(path, disk);
  FrontBytes bytes;
  if (!source.read(bytes)) return false;
  const auto front = decode_front(bytes);
  return front && front->type == RecordType::header && front->sequence == 0;
}

bool holds_nothing(const std::filesystem::path& path, files::Disk& disk) {
  SourceFile front_source(path, disk);
  if (RecordReader(front_source).next()) return false;
  SourceFile source(path, disk);
  std::vector<std::uint8_t> bytes(source.size());
  if (!source.read(bytes)) refuse(path, "becomes shorter while it is read");
  const bool is_zero = std::all_of(bytes.begin(), bytes.end(), [](std::uint8_t byte) { return byte == 0; });
  if (!is_zero && !has_magic(bytes)) return false;  // something else, that bears the name of a journal
  // Records that a recorder wrote do not overlap. A file that has been made so that they seem to would keep
  // the processor busy for hours: it is left alone.
  std::size_t budget = 2 * bytes.size();
  for (std::size_t at = 0; at + front_bytes <= bytes.size(); ++at)
    if (has_record_at(bytes, at, budget)) return false;
  return true;
}

}  // namespace thermorig::journal

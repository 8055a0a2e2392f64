// SPDX-License-Identifier: MIT
// Any bytes as a journal, and any payloads in records whose check sums are right: what is read is within what
// the file holds, and the ignored tail is counted.
#include <sys/mman.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "fuzz_require.h"
#include "storage/journal/record.h"
#include "thermorig/storage/journal/journal.h"
#include "thermorig/storage/recording_header/header_json.h"

namespace {

using namespace thermorig;
using test::fuzz_require;
using Bytes = std::vector<std::uint8_t>;

void append(Bytes& file, const journal::RecordFront& front, const Bytes& payload) {
  const std::array<std::span<const std::uint8_t>, 1> parts{payload};
  const journal::FrontBytes bytes = journal::encode_front(front, parts);
  file.insert(file.end(), bytes.begin(), bytes.end());
  file.insert(file.end(), payload.begin(), payload.end());
}

Bytes good_header() {
  RecordingHeader header;
  header.environment = "garden";
  header.uuid = "8d3f2a10-7f6e-4c55-9d0a-2b1c3d4e5f60";
  const std::string text = recording_header::header_to_json_text(header);
  return {text.begin(), text.end()};
}

/// Records one after another, all but their payloads sound.
Bytes framed(test::FuzzScript& script) {
  Bytes file;
  journal::RecordFront front{.type = journal::RecordType::header, .journal_id = 7};
  append(file, front, good_header());
  while (!script.done()) {
    front.type = static_cast<journal::RecordType>(script.byte() % 9);
    front.device = script.byte() % 4;
    ++front.sequence;
    const std::string text = script.text(script.byte());
    const Bytes payload(text.begin(), text.end());
    front.length = static_cast<std::uint32_t>(payload.size());
    append(file, front, payload);
  }
  return file;
}

void read(const Bytes& bytes) {
  const int fd = ::memfd_create("journal", MFD_CLOEXEC);
  fuzz_require(fd >= 0 && ::write(fd, bytes.data(), bytes.size()) == static_cast<ssize_t>(bytes.size()));
  const std::string path = "/proc/self/fd/" + std::to_string(fd);
  test::read_or_refuse(ExitCode::not_a_session, [&] {
    journal::is_journal(path);
    journal::holds_nothing(path);
    const journal::JournalContents contents = journal::read_journal(path);
    fuzz_require(contents.bytes_read + contents.bytes_ignored == bytes.size());
    for (const Device device : all_devices) {
      const RawStream& stream = contents.recording.received[device];
      fuzz_require(stream.bytes.size() <= bytes.size() && stream.time_ns.size() == stream.chunk_end.size());
      fuzz_require(stream.chunk_end.empty() || stream.chunk_end.back() == stream.bytes.size());
    }
  });
  ::close(fd);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read({data, data + size});
  test::FuzzScript script(data, size);
  read(framed(script));
  return 0;
}

// SPDX-License-Identifier: MIT
// Any text as a recording's header: refused, or believed and the same after it was written.
#include <cstdint>
#include <string>

#include "fuzz_require.h"
#include "thermorig/storage/recording_header/header_json.h"

namespace {

using namespace thermorig;

const std::string& sound() {
  static const std::string text = [] {
    RecordingHeader header;
    header.uuid = "8d3f2a10-7f6e-4c55-9d0a-2b1c3d4e5f60";
    header.environment = "garden";
    header.start_time_utc = "2026-07-25T14:35:59.900001Z";
    return recording_header::header_to_json_text(header);
  }();
  return text;
}

void read(const std::string& text) {
  test::read_or_refuse(ExitCode::not_a_session, [&] {
    const std::string written =
        recording_header::header_to_json_text(recording_header::header_from_json_text(text, "fuzz"));
    const auto again = recording_header::header_from_json_text(written, "written");
    test::fuzz_require(recording_header::header_to_json_text(again) == written);
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  read({reinterpret_cast<const char*>(data), size});
  read(test::spliced(sound(), data, size));
  return 0;
}

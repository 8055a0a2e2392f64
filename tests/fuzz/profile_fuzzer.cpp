// SPDX-License-Identifier: MIT
// Any text as a rig profile: refused, or a profile that comes back the same.
#include <cstdint>
#include <string>

#include "fuzz_require.h"
#include "thermorig/rig/profile/profile_file.h"

namespace {

using namespace thermorig;

void read(const std::string& text) {
  test::read_or_refuse(ExitCode::bad_usage, [&] {
    const std::string written = rig::profile_text(rig::parse_profile(text, "fuzz"));
    test::fuzz_require(rig::profile_text(rig::parse_profile(written, "written")) == written);
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string sound = rig::profile_text(RigProfile());
  read({reinterpret_cast<const char*>(data), size});
  read(test::spliced(sound, data, size));
  return 0;
}

// SPDX-License-Identifier: MIT
// Any text as a study's result: refused, or a result that comes back the same.
#include <cstdint>
#include <string>

#include "fuzz_require.h"
#include "thermorig/learning/study/study.h"

namespace {

using namespace thermorig;

void read(const std::string& text) {
  test::read_or_refuse(ExitCode::not_a_session, [&] {
    const std::string written = study::to_json(study::result_from_json(text, "fuzz"));
    test::fuzz_require(study::to_json(study::result_from_json(written, "written")) == written);
  });
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string sound = study::to_json(study::JobResult());
  read({reinterpret_cast<const char*>(data), size});
  read(test::spliced(sound, data, size));
  return 0;
}

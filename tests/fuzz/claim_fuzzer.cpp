// SPDX-License-Identifier: MIT
// Any text as a claim's file, and a sound one in which pieces differ: nobody known, or a holder whose name
// steers no terminal and who comes back the same.
#include <cstdint>
#include <string>

#include "fuzz_require.h"
#include "io/files/claim_text.h"
#include "thermorig/core/printable.h"

namespace {

using namespace thermorig;
using test::fuzz_require;

const files::Process node7{"node7", "0123-4567", 4026531836, 4711, 500};

void require_sound(const std::string& bytes) {
  const files::ClaimSight seen = files::claim_from(bytes);
  fuzz_require(seen.number == 0 && seen.bytes == 0 &&
               !seen.given_up);  // that is said by the file, not its text
  const std::string text = files::text_of(seen);
  fuzz_require(printable(text) == text);
  if (!seen.holder) return;
  const files::ClaimSight again = files::claim_from(files::claim_text(*seen.holder, seen.since_utc));
  fuzz_require(again.holder == seen.holder && again.since_utc == seen.since_utc);
  fuzz_require(files::life_of(*seen.holder) != files::Life::runs);
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  require_sound({reinterpret_cast<const char*>(data), size});
  require_sound(test::spliced(files::claim_text(node7, "2026-11-24T03:49:01Z"), data, size));
  return 0;
}

// SPDX-License-Identifier: MIT
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "../support/chunking.h"
#include "../support/same_message.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::test {

inline void require(bool condition, const char* what) {
  if (condition) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

template <typename Message>
struct FuzzScan {
  std::vector<Message> messages;
  wire::Counters counters;
};

template <typename Message, typename Scanner>
FuzzScan<Message> fuzz_scan(Scanner scanner, const std::vector<ByteSpan>& chunks, std::size_t pending_max) {
  FuzzScan<Message> scan;
  for (const ByteSpan chunk : chunks) {
    scanner.push(chunk, scan.messages);
    const wire::Counters& counters = scanner.counters();
    require(counters.bytes_received == counters.bytes_in_messages + counters.bytes_in_damaged +
                                           counters.bytes_skipped + counters.bytes_pending,
            "every byte is accounted for");
    require(counters.bytes_pending < pending_max, "what waits is bounded");
  }
  if constexpr (requires { scanner.finish(scan.messages); }) scanner.finish(scan.messages);
  scan.counters = scanner.counters();
  require(scan.counters.bytes_received == scan.counters.bytes_in_messages + scan.counters.bytes_in_damaged +
                                              scan.counters.bytes_skipped + scan.counters.bytes_pending,
          "every byte is accounted for at the end");
  return scan;
}

/// The first two bytes of the input choose the chunking, the rest is the stream. Whole and in chunks, the
/// scanner must give the same messages and counters, account for every byte and keep less than `pending_max`.
template <typename Message, typename Scanner>
void fuzz_scanner(const Scanner& scanner, ByteSpan input, std::size_t pending_max) {
  if (input.size() < 2) return;
  const ByteSpan stream = input.subspan(2);
  const auto chunks = random_chunks(stream, 1U + input[0], input[1]);
  const auto whole = fuzz_scan<Message>(scanner, {stream}, pending_max);
  const auto split = fuzz_scan<Message>(scanner, chunks, pending_max);
  require(whole.counters == split.counters, "the counters do not depend on the chunking");
  require(whole.messages.size() == split.messages.size(), "nor does the number of messages");
  for (std::size_t i = 0; i < whole.messages.size(); ++i)
    require(same(whole.messages[i], split.messages[i]), "nor do the messages");
}

}  // namespace thermorig::test

// SPDX-License-Identifier: MIT
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "support/chunking.h"
#include "support/same_message.h"
#include "thermorig/sensors/wire/counters.h"

namespace thermorig::test {

/// Whether the stream goes on behind the bytes that were fed, or ends there and the scanner is told so.
enum class Stream { goes_on, ends };

/// What a scanner made of a stream.
template <typename Message>
struct Scan {
  std::vector<Message> messages;
  wire::Counters counters;
};

inline std::uint64_t bytes_booked(const wire::Counters& counters) {
  return counters.bytes_in_messages + counters.bytes_in_damaged + counters.bytes_skipped +
         counters.bytes_pending;
}

/// Feeds `chunks` to `scanner` and checks after each that every byte is accounted for.
template <typename Message, typename Scanner>
Scan<Message> scan_chunks(Scanner scanner, const std::vector<ByteSpan>& chunks, Stream stream) {
  Scan<Message> scan;
  std::uint64_t received = 0;
  for (const ByteSpan chunk : chunks) {
    scanner.push(chunk, scan.messages);
    received += chunk.size();
    EXPECT_EQ(scanner.counters().bytes_received, received);
    EXPECT_EQ(bytes_booked(scanner.counters()), received);
  }
  if (stream == Stream::ends) scanner.finish(scan.messages);
  EXPECT_EQ(bytes_booked(scanner.counters()), received);
  scan.counters = scanner.counters();
  return scan;
}

template <typename Message>
void expect_spans_in_order(const Scan<Message>& scan) {
  std::uint64_t end = 0;
  std::uint64_t bytes = 0;
  for (const Message& message : scan.messages) {
    EXPECT_LE(end, message.span.begin);
    EXPECT_LT(message.span.begin, message.span.end);
    end = message.span.end;
    bytes += message.span.size();
  }
  EXPECT_LE(end, scan.counters.bytes_received);
  EXPECT_LE(bytes, scan.counters.bytes_in_messages);
}

/// Feeds `bytes` whole, byte by byte and in random pieces: messages and counters must be equal every time.
template <typename Message, typename Scanner>
Scan<Message> scan_any_chunking(const Scanner& scanner, ByteSpan bytes, Stream stream = Stream::goes_on) {
  const auto whole = scan_chunks<Message>(scanner, {bytes}, stream);
  expect_spans_in_order(whole);
  std::vector<std::vector<ByteSpan>> chunkings{even_chunks(bytes, 1), even_chunks(bytes, 62)};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) chunkings.push_back(random_chunks(bytes, 2000, seed));
  for (const auto& chunks : chunkings) {
    const auto scan = scan_chunks<Message>(scanner, chunks, stream);
    EXPECT_EQ(scan.counters, whole.counters);
    EXPECT_EQ(scan.messages.size(), whole.messages.size());
    for (std::size_t i = 0; i < std::min(scan.messages.size(), whole.messages.size()); ++i)
      EXPECT_TRUE(same(scan.messages[i], whole.messages[i])) << "message " << i;
  }
  return whole;
}

}  // namespace thermorig::test

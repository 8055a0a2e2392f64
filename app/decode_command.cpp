// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "byte_source.h"
#include "commands.h"
#include "decoded_text.h"
#include "output.h"

namespace thermorig::app {

namespace {

GyroProfile gyro_profile(const DecodeOptions& options) {
  GyroProfile profile;
  profile.protocol = options.gyro_protocol == "text" ? GyroProtocol::text : GyroProtocol::witmotion;
  std::copy(options.columns.begin(), options.columns.end(), profile.text.rate.begin());
  profile.text.prefix = options.prefix;
  profile.text.scale_dps = options.scale_dps;
  profile.text.time = options.time_column;
  profile.text.time_unit_s = options.time_unit_s;
  return profile;
}

ChecksumPolicy checksum_policy(const std::string& name) {
  if (name == "ignore") return ChecksumPolicy::ignore;
  return name == "byte" ? ChecksumPolicy::byte : ChecksumPolicy::word;
}

/// Prints messages as they come: all of them, or the first few.
class MessagePrinter {
 public:
  explicit MessagePrinter(const DecodeOptions& options)
      : json_(options.json),
        most_(options.all || options.json ? std::numeric_limits<std::uint64_t>::max() : options.lines) {}

  template <typename Message>
  void print(const Message& message) {
    const std::uint64_t index = count_++;
    if (index >= most_) return;
    const std::string line = json_ ? json_line(json_of(message, index)) : text_of(message, index) + "\n";
    std::fwrite(line.data(), 1, line.size(), stdout);
  }

  std::uint64_t count() const { return count_; }
  std::uint64_t left_out() const { return count_ > most_ ? count_ - most_ : 0; }

 private:
  bool json_;
  std::uint64_t most_;
  std::uint64_t count_ = 0;
};

template <typename Message, typename Scanner>
wire::Counters decode(Scanner scanner, ByteSource& source, MessagePrinter& printer,
                      std::vector<std::uint8_t>& head) {
  constexpr std::size_t head_bytes = 1 << 16;
  std::vector<Message> messages;
  for (auto block = source.next(); !block.empty(); block = source.next()) {
    if (head.size() < head_bytes) head.insert(head.end(), block.begin(), block.end());
    messages.clear();
    scanner.push(block, messages);
    for (const Message& message : messages) printer.print(message);
  }
  return scanner.counters();
}

wire::Counters decode(const DecodeOptions& options, ByteSource& source, MessagePrinter& printer,
                      std::vector<std::uint8_t>& head) {
  switch (options.device) {
    case Device::camera:
      return decode<wire::CameraMessage>(wire::CameraScanner(checksum_policy(options.camera_checksum)),
                                         source, printer, head);
    case Device::gyro:
      return decode<wire::GyroMessage>(wire::GyroScanner(gyro_profile(options)), source, printer, head);
    case Device::servo:
      break;
  }
  return decode<wire::ServoMessage>(wire::ServoScanner(), source, printer, head);
}

template <typename Message, typename Scanner>
std::size_t messages_in(Scanner scanner, std::span<const std::uint8_t> bytes) {
  std::vector<Message> messages;
  scanner.push(bytes, messages);
  return messages.size();
}

/// Which device's bytes these are, if not the one that was named.
std::string advice(std::span<const std::uint8_t> head) {
  if (messages_in<wire::CameraMessage>(wire::CameraScanner(), head) > 0) return "--device camera";
  if (messages_in<wire::ServoMessage>(wire::ServoScanner(), head) > 0) return "--device servo";
  if (messages_in<wire::GyroMessage>(wire::WitmotionScanner(), head) > 3) return "--device gyro";
  if (messages_in<wire::GyroMessage>(wire::TextGyroScanner(TextColumns{}), head) > 3)
    return "--device gyro --gyro-protocol text";
  return "another baud rate when the dump is taken: wrong ones give bytes without sense";
}

[[noreturn]] void refuse_bytes(const DecodeOptions& options, const std::string& name, std::uint64_t bytes,
                               std::span<const std::uint8_t> head) {
  const std::string device(name_of(options.device));
  if (bytes == 0)
    throw Error(ExitCode::device_missing, "there are no bytes", name,
                "a dump that the " + device + " has sent");
  throw Error(ExitCode::device_missing,
              fmt::format("not one message of a {} in {} bytes", device, count_text(bytes)), name,
              advice(head));
}

void print_summary(const DecodeOptions& options, const std::string& name, const wire::Counters& counters,
                   const MessagePrinter& printer) {
  if (options.json) {
    print_json({{"event", "summary"},
                {"device", name_of(options.device)},
                {"file", name},
                {"messages_decoded", printer.count()},
                {"counters", json_of(counters)}});
    return;
  }
  if (printer.left_out() > 0)
    fmt::print("... and {} more (--all prints them)\n", count_text(printer.left_out()));
  fmt::print("\n{}", text_of(counters));
}

}  // namespace

ExitCode run(const DecodeOptions& options) {
  ByteSource source(options.file);
  MessagePrinter printer(options);
  std::vector<std::uint8_t> head;
  const wire::Counters counters = decode(options, source, printer, head);
  print_summary(options, source.name(), counters, printer);
  if (printer.count() == 0) refuse_bytes(options, source.name(), counters.bytes_received, head);
  return ExitCode::ok;
}

}  // namespace thermorig::app

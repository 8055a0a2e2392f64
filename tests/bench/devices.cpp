// SPDX-License-Identifier: MIT
// Whether the program reads what devices send that somebody may own (tests/bench/devices.sh): a line each.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <nlohmann/json.hpp>

#include "device_layouts.h"
#include "support/chunking.h"
#include "support/same_message.h"
#include "thermorig/rig/discovery/detect.h"
#include "thermorig/sensors/camera_protocol.h"
#include "thermorig/sensors/device_stream.h"
#include "thermorig/sensors/gyro_protocol.h"
#include "thermorig/sensors/gyro_sketch.h"

namespace thermorig::bench {
namespace {

using test::ByteSpan;
using test::ByteVector;

constexpr double share_needed = 0.95;

std::size_t messages_of(const DeviceLayout& layout) {
  return layout.device == Device::camera ? 8 : 30;
}

ByteVector stream_of(const DeviceLayout& layout) {
  std::string text = layout.above;
  for (std::size_t i = 0; i < messages_of(layout); ++i) text += layout.message(static_cast<int>(i));
  return {text.begin(), text.end()};
}

/// The message as one that was sent; -1: it is none of them.
int number_of(const DeviceLayout& layout, const wire::CameraMessage& message) {
  for (int i = 0; i < static_cast<int>(messages_of(layout)); ++i) {
    bool is_it = true;
    for (std::size_t pixel = 0; pixel < frame_pixels && is_it; ++pixel)
      is_it = std::abs(message.frame.temp_c[pixel] - temperature_c(i, pixel)) <= layout.tolerance;
    if (is_it) return i;
  }
  return -1;
}

int number_of(const DeviceLayout& layout, const wire::GyroMessage& message) {
  for (int i = 0; i < static_cast<int>(messages_of(layout)); ++i) {
    bool is_it = true;
    for (std::size_t axis = 0; axis < 3; ++axis)
      is_it &= std::abs(message.reading.rate_dps[axis] - rates_dps(i)[axis]) <= layout.tolerance;
    if (is_it) return i;
  }
  return -1;
}

struct Outcome {
  std::size_t read = 0, wrong = 0;
};

/// Each message has to be one that was sent, behind the one before.
template <typename Message>
Outcome judge(const DeviceLayout& layout, const std::vector<Message>& messages) {
  Outcome outcome;
  int before = -1;
  for (const Message& message : messages) {
    const int number = number_of(layout, message);
    ++(number > before ? outcome.read : outcome.wrong);
    before = std::max(before, number);
  }
  return outcome;
}

template <typename Message, typename Scanner>
std::vector<Message> scanned(Scanner scanner, const std::vector<ByteSpan>& chunks) {
  std::vector<Message> messages;
  for (const ByteSpan chunk : chunks) scanner.push(chunk, messages);
  scanner.finish(messages);
  return messages;
}

/// Whole, behind garbage, joined in the middle.
struct Verdict {
  std::string layout, said, trouble;
  Outcome whole, garbage, joined;
  std::size_t sent = 0;
  bool is_right() const { return trouble.empty(); }
};

template <typename Message, typename Scanner>
void decode(const DeviceLayout& layout, const ByteVector& bytes, const Scanner& scanner, Verdict& verdict) {
  const auto whole = scanned<Message>(scanner, {ByteSpan(bytes)});
  for (const std::size_t size : {std::size_t{1}, std::size_t{7}, std::size_t{64}, std::size_t{1000}}) {
    const auto pieces = scanned<Message>(scanner, test::even_chunks(bytes, size));
    bool are_same = pieces.size() == whole.size();
    for (std::size_t i = 0; i < whole.size() && are_same; ++i) are_same = test::same(pieces[i], whole[i]);
    if (!are_same) verdict.trouble = fmt::format("reads otherwise in pieces of {} bytes", size);
  }
  verdict.whole = judge(layout, whole);
  ByteVector behind_garbage = test::random_bytes(1777, 3);
  behind_garbage.insert(behind_garbage.end(), bytes.begin(), bytes.end());
  verdict.garbage = judge(layout, scanned<Message>(scanner, {ByteSpan(behind_garbage)}));
  const std::size_t cut = layout.above.size() + layout.message(0).size() * 4 / 10;
  verdict.joined = judge(layout, scanned<Message>(scanner, {ByteSpan(bytes).subspan(cut)}));
  const std::size_t sent = messages_of(layout);
  if (verdict.whole.wrong + verdict.garbage.wrong + verdict.joined.wrong > 0)
    verdict.trouble = "SILENTLY WRONG: messages that were not sent";
  else if (verdict.whole.read + 1 < sent || verdict.garbage.read + 2 < sent || verdict.joined.read + 2 < sent)
    verdict.trouble = "messages are missing";
}

/// The profile that its bytes, and where they ask for it a person, give.
std::optional<GyroProfile> profile_for(const DeviceLayout& layout, const rig::Evidence& evidence,
                                       Verdict& verdict) {
  GyroProfile profile;
  profile.protocol = evidence.protocol;
  profile.settings = evidence.found.settings;
  profile.output_rate_hz = layout.rate_hz;
  verdict.said = evidence.protocol;
  if (!evidence.found.text_format) return profile;
  const sensors::TextFormat& format = *evidence.found.text_format;
  if (format.is_known() == layout.answer.has_value()) {
    verdict.trouble = format.is_known() ? "takes a guess for known" : "asks what the lines say";
    return std::nullopt;
  }
  profile.text = layout.answer.value_or(format.columns);
  verdict.said = layout.answer ? "text, asked for" : "text";
  if (!format.sketch.empty()) verdict.said = format.sketch;
  if (format.sketch != layout.sketch)
    verdict.trouble = fmt::format("named \"{}\", not \"{}\"", format.sketch, layout.sketch);
  return profile;
}

Verdict verdict_on(const DeviceLayout& layout) {
  Verdict verdict{.layout = layout.name};
  const ByteVector bytes = stream_of(layout);
  rig::Evidence evidence = rig::classify(bytes, static_cast<double>(messages_of(layout)) / layout.rate_hz);
  if (!evidence.role && evidence.found.advice.empty())  // as `ports` and `decode` then do
    if (auto guess = sensors::recognise_unread(bytes)) evidence.found = *std::move(guess);
  verdict.sent = messages_of(layout);
  if (!layout.refusal.empty()) {
    verdict.said = "refused: " + evidence.found.text;
    const std::string all = evidence.found.text + " | " + evidence.found.advice;
    if (evidence.role)
      verdict.trouble = "SILENTLY WRONG: taken for a " + std::string(name_of(*evidence.role));
    else if (all.find(layout.refusal) == all.npos)
      verdict.trouble = fmt::format("the reason does not hold \"{}\"", layout.refusal);
    return verdict;
  }
  if (evidence.role != layout.device) {
    verdict.said = evidence.found.text;
    verdict.trouble = evidence.role ? "SILENTLY WRONG: another device" : "not recognised";
    return verdict;
  }
  if (layout.device == Device::camera) {
    verdict.said = evidence.protocol;
    decode<wire::CameraMessage>(layout, bytes, sensors::camera_scanner({.protocol = evidence.protocol}),
                                verdict);
  } else if (const auto profile = profile_for(layout, evidence, verdict)) {
    decode<wire::GyroMessage>(layout, bytes, sensors::gyro_scanner(*profile), verdict);
    if (sensors::find_gyro_sketch(layout.name) == nullptr) return verdict;
    GyroProfile named;  // as a person chooses it
    sensors::choose_gyro(layout.name, named);
    decode<wire::GyroMessage>(layout, bytes, sensors::gyro_scanner(named), verdict);
  }
  return verdict;
}

nlohmann::json json_of(const Verdict& verdict) {
  return {{"layout", verdict.layout},        {"right", verdict.is_right()},  {"said", verdict.said},
          {"trouble", verdict.trouble},      {"sent", verdict.sent},         {"whole", verdict.whole.read},
          {"garbage", verdict.garbage.read}, {"joined", verdict.joined.read}};
}

int run(bool json) {
  std::vector<DeviceLayout> layouts = camera_layouts();
  for (DeviceLayout& layout : gyro_layouts()) layouts.push_back(std::move(layout));
  std::size_t right = 0, silently_wrong = 0;
  nlohmann::json rows = nlohmann::json::array();
  if (!json) fmt::print("{:<34} {:>5} {:>5} {:>5}  {}\n", "layout", "whole", "garb.", "join", "read as");
  for (const DeviceLayout& layout : layouts) {
    const Verdict verdict = verdict_on(layout);
    right += verdict.is_right() ? 1U : 0U;
    silently_wrong += verdict.trouble.starts_with("SILENTLY") ? 1U : 0U;
    rows.push_back(json_of(verdict));
    if (json) continue;
    const bool is_refused = !layout.refusal.empty();
    fmt::print("{:<34} {:>5} {:>5} {:>5}  {:.28}\n", verdict.layout.substr(0, 34),
               is_refused ? "-" : std::to_string(verdict.whole.read),
               is_refused ? "-" : std::to_string(verdict.garbage.read),
               is_refused ? "-" : std::to_string(verdict.joined.read), verdict.said);
    if (!verdict.is_right()) fmt::print("  not right: {} ({})\n", verdict.trouble, verdict.said);
  }
  const double share = static_cast<double>(right) / static_cast<double>(layouts.size());
  if (json)
    fmt::print(
        "{}\n",
        nlohmann::json{{"layouts", rows}, {"right_share", share}, {"silently_wrong", silently_wrong}}.dump());
  else
    fmt::print("\n{} of {} right ({:.1f} %, at least 95 % needed), {} silently wrong (0 allowed)\n", right,
               layouts.size(), 100.0 * share, silently_wrong);
  return share >= share_needed && silently_wrong == 0 ? 0 : 1;
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** words) {
  return thermorig::bench::run(count > 1 && std::strcmp(words[1], "--json") == 0);
}

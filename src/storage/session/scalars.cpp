// SPDX-License-Identifier: MIT
#include "scalars.h"

#include <fmt/chrono.h>
#include <fmt/format.h>
#include <libdeflate.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <limits>
#include <optional>

#include "sync_attributes.h"
#include "thermorig/sensors/wire/counter_names.h"
#include "thermorig/storage/recording_header/header_json.h"

namespace thermorig::session {

std::string name_of(State state) {
  static constexpr std::array names{"complete", "recovered", "partial"};
  return names[static_cast<std::size_t>(state)];
}

std::string header_text(const RecordingHeader& header) {
  return recording_header::header_to_json_text(header, recording_header::ProfileAndPlan::elsewhere);
}

namespace {
/// Puts the values of attributes in a row.
struct AttributeText {
  std::string text;
  template <typename Value>
  void operator()(const char* /*name*/, const Value& value) {
    text += fmt::format(" {}", value);
  }
  void operator()(const char* name, bool value) { (*this)(name, value ? 1 : 0); }
  void operator()(const char* name, const std::optional<double>& value) {
    (*this)(name, value.value_or(std::numeric_limits<double>::quiet_NaN()));
  }
};

std::string sync_text(const SyncReport& sync, FormatVersion version) {
  AttributeText attributes;
  for (const Device device : all_devices) clock_attributes(attributes, sync.clock[device], version);
  sync_attributes(attributes, sync, version);
  return attributes.text;
}
}  // namespace

std::uint32_t scalars_crc32(const Session& session, const std::string& header_text, FormatVersion version) {
  std::string text =
      fmt::format("{} {} {} {} {} {}", name_of(session.state), session.raw.complete,
                  to_ns(session.raw.end_time), session.settle_s, session.camera_mode, session.frame_period_s);
  for (const Device device : all_devices)
    for (const auto& counter : wire::counter_names)
      text += fmt::format(" {}", session.counters[device].*counter.member);
  text += header_text;
  if (version >= with_sync_report) text += sync_text(session.sync, version);
  // So that a file whose /estimates is damaged is not taken for one that never had any.
  if (!session.raw.estimates.empty()) text += fmt::format(" {}", session.raw.estimates.size());
  if (!session.annotations.empty()) text += fmt::format(" annotations {}", session.annotations.size());
  // So that nobody takes it for a file of a version that had no check sums of other attributes.
  if (version >= with_attribute_sums)
    text += version.major == 1 ? fmt::format(" {}", version.minor) : fmt::format(" {}", version.text());
  return libdeflate_crc32(0, text.data(), text.size());
}

std::string utc_after(const std::string& start, double seconds) {
  std::tm date{};
  double second = 0;
  if (std::sscanf(start.c_str(), "%4d-%2d-%2dT%2d:%2d:%lfZ", &date.tm_year, &date.tm_mon, &date.tm_mday,
                  &date.tm_hour, &date.tm_min, &second) != 6)
    return "";
  date.tm_year -= 1900;
  date.tm_mon -= 1;
  const auto total_us = std::llround((second + seconds) * 1e6);
  const auto whole_s = static_cast<std::time_t>(std::floor(static_cast<double>(total_us) / 1e6));
  const auto rest_us = total_us - static_cast<long long>(whole_s) * 1'000'000;
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}.{:06}Z", fmt::gmtime(::timegm(&date) + whole_s), rest_us);
}

}  // namespace thermorig::session

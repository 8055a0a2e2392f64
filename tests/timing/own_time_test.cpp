// SPDX-License-Identifier: MIT
#include "thermorig/pipeline/timing/device_time.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <string>

namespace thermorig::timing {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr double rate_hz = 200.0;
constexpr double rate_error_max = 0.1;

HostTime at_s(double seconds) {
  return HostTime(from_s(seconds));
}

/// The time that the device says of sample `i`, or the one at which it arrives.
using TimeOf = std::function<double(int i)>;

double steady_s(int i) {
  return i / rate_hz;
}

std::vector<OwnStamp> stamped(const TimeOf& stamping, int samples = 1000, const TimeOf& arrival = steady_s) {
  std::vector<OwnStamp> times;
  for (int i = 0; i < samples; ++i) times.push_back({stamping(i), at_s(arrival(i))});
  return times;
}

double a_tenth_lacks_s(int i) {
  return (i + i / 9) / rate_hz;
}

double with_two_pauses_s(int i) {
  return i / rate_hz + (i > 300 ? 0.9 : 0.0) + (i > 320 ? 0.9 : 0.0);
}

/// Of samples that are read out of a FIFO `batch` at a time.
double batch_s(int i, int batch) {
  return (i / batch + 1) * batch / rate_hz;
}

TEST(OwnTimes, AreThoseOfSamplesOrNotByTheWayInWhichTheyGoOn) {
  const struct {
    const char* name;
    TimeOf stamping;
    bool of_samples;
    TimeOf arrival = steady_s;
  } kinds[] = {
      {"each sample its own", steady_s, true},
      {"a clock 3 % fast, in whole milliseconds", [](int i) { return 1e-3 * std::floor(5.15 * i); }, true},
      {"a loop that is late now and then", [](int i) { return i / rate_hz + (i % 7 ? 0.0 : 0.002); }, true},
      {"a tenth of all samples lack", a_tenth_lacks_s, true, a_tenth_lacks_s},
      {"nothing for 0.9 s, twice", with_two_pauses_s, true, with_two_pauses_s},
      {"a reset", [](int i) { return (i < 500 ? i : i - 500) / rate_hz; }, true},
      {"lines that are torn", [](int i) { return (i % 40 ? i : 0.1 * i) / rate_hz; }, true},
      {"pairs under one stamp", [](int i) { return batch_s(i, 2); }, false},
      {"a FIFO of 10 under one stamp", [](int i) { return batch_s(i, 10); }, false},
      {"a FIFO of 85 under one stamp", [](int i) { return batch_s(i, 85); }, false},
      {"stamps of printing", [](int i) { return batch_s(i, 10) + 3e-4 * (i % 10); }, false},
      {"the unit is larger", [](int i) { return 1e-3 * i / rate_hz; }, false},
      {"the unit is smaller", [](int i) { return 1e3 * i / rate_hz; }, false},
      {"it stands still", [](int) { return 7.0; }, false},
  };
  for (const auto& kind : kinds) {
    const auto times = stamped(kind.stamping, 1000, kind.arrival);
    EXPECT_EQ(why_no_sample_times(times, rate_hz, rate_error_max).empty(), kind.of_samples) << kind.name;
    OwnClock clock(rate_hz, rate_error_max);
    for (const OwnStamp& time : times) clock.place_s(std::llround(1e6 * time.own_s), time.arrived);
    EXPECT_EQ(clock.is_unused(), !kind.of_samples) << kind.name;
  }
}

TEST(OwnTimes, ThatLackMostSamplesAreBelievedWhereAsFewSamplesCame) {
  std::vector<OwnStamp> times;  // three in a row, then seven lack
  for (int i = 0; i < 1000; ++i)
    if (i % 10 < 3) times.push_back({i / rate_hz, at_s(i / rate_hz)});
  EXPECT_THAT(why_no_sample_times(times, rate_hz, rate_error_max), IsEmpty());
  EXPECT_THAT(why_no_sample_times(times, 0.3 * rate_hz, rate_error_max),
              HasSubstr("60 samples come a second"));
}

TEST(OwnTimes, OfWhichTooFewCameAreBelieved) {
  const auto times = stamped([](int i) { return batch_s(i, 10); }, 20);
  EXPECT_THAT(why_no_sample_times(times, rate_hz, rate_error_max), IsEmpty());
}

TEST(AnUnwrappedTime, GoesOnOverAWrapOf32BitsAndStepsBackAtAReset) {
  const struct {
    const char* name;
    std::int64_t before_us, after_us;
    double host_s, expected_step_s;
  } steps[] = {
      {"micros()", 4294967290, 4994, 0.005, 0.005},
      {"micros(), the reader was late", 4294967290, 4994, 0.9, 0.005},
      {"micros() over an outage", 4290000000, 5032704, 10.0, 10.0},
      {"millis()", 4294967295000, 4000, 0.005, 0.005},
      {"tenths of milliseconds", 429496729500, 4900, 0.005, 0.005},
      {"a reset", 3600000000, 1000, 2.0, -3599.999},
      {"a reset near the wrap", 4294000000, 1000000, 10.0, -4293.0},
      {"no step back", 1000, 6000, 0.005, 0.005},
  };
  for (const auto& step : steps) {
    UnwrappedTime time;
    const double before_s = time.unwrap_s(step.before_us, at_s(1.0));
    EXPECT_NEAR(time.unwrap_s(step.after_us, at_s(1.0 + step.host_s)) - before_s, step.expected_step_s, 2e-3)
        << step.name;
  }
}

}  // namespace
}  // namespace thermorig::timing

// SPDX-License-Identifier: MIT
#include "thermorig/core/bad_pixels.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>
#include <random>

namespace thermorig {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

constexpr float nan = std::numeric_limits<float>::quiet_NaN();
constexpr std::size_t place = 5 * frame_columns + 9;

/// What a camera sends that turns in a room of wide and narrow things, frame by frame, both halves new.
class TurningCamera {
 public:
  explicit TurningCamera(double dps = 60.0) : dps_(dps) {}

  TimedFrame next() {
    TimedFrame frame;
    frame.fresh_even = frame.fresh_odd = frame_pixels / 2;
    for (std::size_t row = 0; row < frame_rows; ++row)
      for (std::size_t column = 0; column < frame_columns; ++column) {
        const double azimuth = (dps_ * 0.125 * count_ + 1.72 * static_cast<double>(column)) / 57.3;
        const double lamp = std::abs(std::sin(0.5 * azimuth)) < 0.03 && row == 5 ? 60.0 : 0.0;
        const double room = 21.0 + std::sin(3.0 * azimuth) + 0.1 * static_cast<double>(row);
        frame.frame.temp_c[row * frame_columns + column] = static_cast<float>(room + lamp + noise_(random_));
      }
    ++count_;
    return frame;
  }

 private:
  double dps_;
  int count_ = 0;
  std::mt19937 random_{7};
  std::normal_distribution<double> noise_{0.0, 0.3};
};

PixelPlaces bad_after(int frames, const std::function<void(ThermalFrame&)>& spoil, double dps = 60.0) {
  TurningCamera camera(dps);
  PixelWatch watch;
  for (int i = 0; i < frames; ++i) {
    TimedFrame frame = camera.next();
    spoil(frame.frame);
    watch.add(frame);
  }
  return watch.bad();
}

TEST(PixelWatch, FindsPixelsOfEachKindThatAreBad) {
  const struct {
    const char* name;
    std::function<void(float&)> spoil;
  } kinds[] = {{"dead", [](float& pixel) { pixel = -10.0F; }},
               {"stuck at the temperature of the room", [](float& pixel) { pixel = 21.3F; }},
               {"hot", [](float& pixel) { pixel += 12.0F; }},
               {"cold", [](float& pixel) { pixel -= 5.0F; }},
               {"no number", [](float& pixel) { pixel = nan; }}};
  for (const auto& kind : kinds) {
    for (const std::size_t bad : {place, std::size_t{0}, frame_pixels - 1})
      EXPECT_THAT(bad_after(60, [&](ThermalFrame& frame) { kind.spoil(frame.temp_c[bad]); }),
                  ElementsAre(bad))
          << kind.name;
    EXPECT_THAT(bad_after(20, [&](ThermalFrame& frame) { kind.spoil(frame.temp_c[place]); }), IsEmpty());
  }
}

TEST(PixelWatch, FindsFourOfThemSideBySide) {
  const PixelPlaces four{place, place + 2, place + frame_columns + 1, place + 2 * frame_columns};
  EXPECT_EQ(bad_after(60,
                      [&](ThermalFrame& frame) {
                        for (const std::uint16_t bad : four) frame.temp_c[bad] = 80.0F;
                      }),
            four);
}

TEST(PixelWatch, FindsNoneInASoundCameraThatTurns) {
  for (const double dps : {5.0, 60.0, 200.0})
    EXPECT_THAT(bad_after(
                    200, [](ThermalFrame&) {}, dps),
                IsEmpty())
        << dps;
}

TEST(PixelWatch, TakesALampThatStandsStillForAHotPixelUntilItMoves) {
  PixelWatch watch;
  TurningCamera still(0.0), turning;
  for (int i = 0; i < 100; ++i) watch.add(still.next());
  EXPECT_THAT(watch.bad(), ElementsAre(5 * frame_columns, 5 * frame_columns + 1));
  for (int i = 0; i < 1000; ++i) watch.add(turning.next());
  EXPECT_THAT(watch.bad(), IsEmpty());
}

TEST(PixelWatch, CallsNoPixelBadWhereManySeemToBe) {
  EXPECT_THAT(bad_after(60,
                        [](ThermalFrame& frame) {
                          for (std::size_t i = 0; i < frame_pixels; i += 20) frame.temp_c[i] = 80.0F;
                        }),
              IsEmpty());
}

TEST(BadPixels, GetTheMeanOfTheGoodOnesAround) {
  ThermalFrame frame;
  frame.temp_c.fill(20.0F);
  const PixelPlaces bad{0, place, place + 2};
  for (const std::uint16_t one : bad) frame.temp_c[one] = nan;
  mend(frame, bad);
  for (const float temp_c : frame.temp_c) EXPECT_EQ(temp_c, 20.0F);
}

TEST(BadPixels, AreWrittenByRowAndColumnAndReadBack) {
  const PixelPlaces bad{0, 109, 767};
  EXPECT_EQ(text_of(bad), "0,0 3,13 23,31");
  EXPECT_EQ(pixel_places(text_of(bad)), bad);
  EXPECT_EQ(text_of({}), "");
  EXPECT_THAT(pixel_places("24,0 3 , -1,2 x,y 3,13"), ElementsAre(109));
}

}  // namespace
}  // namespace thermorig

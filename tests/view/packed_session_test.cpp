// SPDX-License-Identifier: MIT
#include "thermorig/storage/view/packed_session.h"

#include <gmock/gmock.h>
#include <libdeflate.h>

#include <algorithm>
#include <cstring>
#include <string>
#include <vector>

#include "columns_of.h"
#include "session/synthetic_session.h"
#include "session/temporary_folder.h"
#include "thermorig/core/error.h"
#include "thermorig/core/frame.h"

namespace thermorig::view {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr std::size_t plenty = 50'000'000;
constexpr std::uint8_t not_a_number = 255;

std::vector<std::uint8_t> bytes_of_base64(const std::string& text) {
  const std::string letters = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::vector<std::uint8_t> bytes;
  unsigned bits = 0, count = 0;
  for (const char letter : text) {
    if (letter == '=') break;
    bits = (bits << 6U) | static_cast<unsigned>(letters.find(letter));
    if ((count += 6) >= 8) bytes.push_back(static_cast<std::uint8_t>(bits >> (count -= 8)));
  }
  return bytes;
}

class PackedSessions : public session::InTemporaryFolder {
 protected:
  void write(std::size_t frames) {
    session_ = session::SyntheticSession(frames, 5).take();
    session::write_session(path(), session_);
  }

  static const PackedPart& part(const PackedSession& packed, const std::string& name) {
    const auto found = std::find_if(packed.parts.begin(), packed.parts.end(),
                                    [&](const PackedPart& one) { return one.name == name; });
    if (found == packed.parts.end()) throw std::runtime_error("no part " + name);
    return *found;
  }

  static std::string inflated(const PackedSession& packed, const std::string& name) {
    const std::vector<std::uint8_t> bytes = bytes_of_base64(part(packed, name).base64);
    std::string out(32U << 20U, '\0');
    std::size_t size = 0;
    libdeflate_decompressor* inflater = libdeflate_alloc_decompressor();
    const auto result =
        libdeflate_zlib_decompress(inflater, bytes.data(), bytes.size(), out.data(), out.size(), &size);
    libdeflate_free_decompressor(inflater);
    EXPECT_EQ(result, LIBDEFLATE_SUCCESS) << name;
    out.resize(size);
    return out;
  }

  /// The temperature of a pixel, as the page works it out.
  static float temperature(const std::string& block, std::size_t image, std::size_t pixel) {
    float least = 0.0F, step = 0.0F;
    std::memcpy(&least, block.data(), sizeof least);
    std::memcpy(&step, block.data() + sizeof least, sizeof step);
    std::uint8_t code = 0;
    for (std::size_t i = 0; i <= image; ++i)
      code = static_cast<std::uint8_t>(
          code + static_cast<std::uint8_t>(block.at(2 * sizeof(float) + i * frame_pixels + pixel)));
    EXPECT_NE(code, not_a_number);
    return least + static_cast<float>(code) * step;
  }

  session::Session session_;
};

std::size_t size_of(const PackedSession& packed) {
  std::size_t bytes = 0;
  for (const PackedPart& part : packed.parts) bytes += part.base64.size();
  return bytes;
}

TEST_F(PackedSessions, HoldAllFactsRowsAndImagesWhereThereIsRoom) {
  write(200);
  const PackedSession packed = packed_session(path(), plenty);
  EXPECT_EQ(packed.frames, 200U);
  EXPECT_EQ(packed.row_every, 1U);
  EXPECT_EQ(packed.image_every, 1U);
  EXPECT_EQ(packed.left_out, "");
  const nlohmann::json facts = nlohmann::json::parse(inflated(packed, "facts"));
  const ReadColumns columns(facts, inflated(packed, "rows"));
  ASSERT_EQ(columns.rows(), 200U);
  EXPECT_EQ(columns.at<float>("shaft_dps", 17), session_.samples[17].rate_shaft_dps);
  const std::vector<std::uint8_t> packing = bytes_of_base64(part(packed, "packing").base64);
  EXPECT_EQ(std::string(packing.begin(), packing.end()), R"({"every":1,"left_out":""})");
}

TEST_F(PackedSessions, QuantiseImagesWithinHalfAStep) {
  write(100);
  const std::string block = inflated(packed_session(path(), plenty), "images-1");
  float step = 0.0F;
  std::memcpy(&step, block.data() + sizeof step, sizeof step);
  EXPECT_GE(step, 0.00999F);
  for (const std::size_t frame : {64U, 70U, 99U})
    for (std::size_t pixel = 0; pixel < frame_pixels; pixel += 37) {
      const std::size_t row = pixel / frame_columns, column = pixel % frame_columns;
      const bool mirrored = session_.raw.header.profile.camera.mirrored;
      const float truth =
          session_.frames[frame]
              .frame.temp_c[row * frame_columns + (mirrored ? frame_columns - 1 - column : column)];
      EXPECT_NEAR(temperature(block, frame - 64, pixel), truth, 0.5F * step + 0.0051F) << frame;
    }
}

TEST_F(PackedSessions, LeaveOutImagesThenRowsWhereThereIsLittleRoomAndSayIt) {
  write(600);
  const std::size_t all = size_of(packed_session(path(), plenty));
  const PackedSession fewer = packed_session(path(), all / 2);
  EXPECT_LE(size_of(fewer), all / 2);
  EXPECT_EQ(fewer.row_every, 1U);
  EXPECT_GT(fewer.image_every, 1U);
  EXPECT_THAT(fewer.left_out, StartsWith("This file has all rows, and an image of every "));
  const PackedSession least = packed_session(path(), all / 40);
  EXPECT_LE(size_of(least), all / 40);
  EXPECT_GT(least.row_every, 1U);
  EXPECT_EQ(least.image_every % least.row_every, 0U);
  EXPECT_THAT(least.left_out, HasSubstr("a row of every "));
}

TEST_F(PackedSessions, AreRefusedWhereNotEvenTheFactsFit) {
  write(20);
  EXPECT_THROW(packed_session(path(), 1500), Error);
}

}  // namespace
}  // namespace thermorig::view

// SPDX-License-Identifier: MIT
// Any bytes as a map's file, and a sound map in which pieces differ, check sum and all: refused, or a map
// that comes back the same and with which an odometer can begin.
#include <zlib.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>

#include "fuzz_require.h"
#include "thermorig/estimators/map_file/map_file.h"
#include "thermorig/estimators/odometer/odometer.h"

namespace {

using namespace thermorig;
using test::fuzz_require;

const std::string& sound_map() {
  static const std::string bytes = [] {
    map_file::StoredMap stored;
    stored.environment = "kitchen";
    for (std::size_t i = 0; i < stored.map.temp_k.size(); ++i) {
      stored.map.temp_k[i] = static_cast<float>(i % 97) * 0.03F;
      stored.map.variance_k2[i] = 0.01F;
      stored.map.seen[i] = 1;
    }
    stored.map.offset_known.fill(2);
    stored.map.pixel_variance_k2.fill(0.3F);
    return map_file::bytes_of(stored);
  }();
  return bytes;
}

/// A frame a while, which the odometer looks for in the map.
void begin_with(const odometer::Map& map) {
  odometer::Odometer odometer({}, {}, std::make_shared<const odometer::Map>(map));
  TimedFrame frame;
  for (int i = 0; i < 40; ++i) {
    const HostTime end = HostTime() + std::chrono::seconds(10) + i * std::chrono::milliseconds(125);
    for (std::size_t pixel = 0; pixel < frame_pixels; ++pixel)
      frame.frame.temp_c[pixel] = 20.0F + static_cast<float>((pixel * 7 + static_cast<std::size_t>(i)) % 13);
    frame.exposure_begin = end - std::chrono::milliseconds(250);
    frame.exposure_end = end;
    frame.half[0] = {end - std::chrono::milliseconds(125), end};
    frame.fresh_even = 384;
    std::vector<TimedGyro> gyro(25);
    for (std::size_t k = 0; k < gyro.size(); ++k) {
      gyro[k].stamp.time = end - (24 - static_cast<int>(k)) * std::chrono::milliseconds(5);
      gyro[k].rate_dps = 20.0F + 0.01F * static_cast<float>(k % 5);
      gyro[k].reading.rate_dps = {0.0F, 0.0F, gyro[k].rate_dps};
    }
    const odometer::Report report = odometer.add(frame, gyro);
    fuzz_require(!(report.heading_sigma_deg < 0.0));
  }
}

void require_sound(const std::string& bytes, bool begins) {
  test::read_or_refuse(ExitCode::not_a_session, [&] {
    const map_file::StoredMap stored = map_file::map_from(bytes, "fuzz");
    fuzz_require(map_file::bytes_of(stored) == bytes);
    if (begins) begin_with(stored.map);
  });
}

/// As if whoever changed it had known how check sums are made.
std::string summed(std::string bytes) {
  bytes.resize(std::max<std::size_t>(bytes.size(), 4) - 4);
  const auto crc = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
  return bytes.append(reinterpret_cast<const char*>(&crc), sizeof(crc));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  require_sound({reinterpret_cast<const char*>(data), size}, false);
  require_sound(summed(test::spliced(sound_map(), data, size)), size % 16 == 0);
  return 0;
}

// SPDX-License-Identifier: MIT
#include "data_hash.h"

#include <sha2.h>

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <span>

namespace thermorig::dataset {

namespace {

static_assert(std::endian::native == std::endian::little, "the hash is defined over little-endian values");

class Sha256 {
 public:
  Sha256() { SHA256Init(&state_); }

  template <typename Value>
  void add(std::span<const Value> values) {
    SHA256Update(&state_, reinterpret_cast<const std::uint8_t*>(values.data()), values.size_bytes());
  }

  std::string hexadecimal() {
    std::array<char, SHA256_DIGEST_STRING_LENGTH> text{};
    SHA256End(&state_, text.data());
    return text.data();
  }

 private:
  SHA2_CTX state_{};
};

/// Processors differ in the sign of the NaN that they make.
void add_floats(Sha256& hash, std::vector<float> values) {
  for (float& value : values)
    if (std::isnan(value)) value = std::numeric_limits<float>::quiet_NaN();
  hash.add(std::span<const float>(values));
}

/// Nanoseconds, modulo 2^64: times from a file may lie further apart than a duration can tell.
std::vector<std::uint64_t> times_since_first(const std::vector<HostTime>& times) {
  std::vector<std::uint64_t> since;
  since.reserve(times.size());
  for (const HostTime time : times)
    since.push_back(static_cast<std::uint64_t>(to_ns(time)) -
                    static_cast<std::uint64_t>(to_ns(times.front())));
  return since;
}

}  // namespace

std::string data_hash(const network::Acquisition& acquisition) {
  Sha256 hash;
  const std::array<std::uint64_t, 1> frames{acquisition.frames()};
  hash.add(std::span<const std::uint64_t>(frames));
  add_floats(hash, acquisition.temp_c);
  add_floats(hash, acquisition.label_dps);
  add_floats(hash, acquisition.gyro_dps);
  hash.add(std::span<const std::uint64_t>(times_since_first(acquisition.time)));
  hash.add(std::span<const std::uint32_t>(acquisition.run));
  add_floats(hash, acquisition.leg_rate_dps);
  return hash.hexadecimal();
}

}  // namespace thermorig::dataset

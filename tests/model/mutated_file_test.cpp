// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "allocation_count.h"
#include "edited_file.h"
#include "mutation.h"
#include "thermorig/core/error.h"

namespace thermorig::model {
namespace {

/// THERMORIG_MUTATIONS=100000 for the long run.
std::uint64_t mutations() {
  const char* asked = std::getenv("THERMORIG_MUTATIONS");
  return asked == nullptr ? 2000 : std::strtoull(asked, nullptr, 10);
}

/// Without the checksum, which would refuse nearly everything before the rest is looked at.
std::string file_without_checksum(const Model& model) {
  EditedFile file(model);
  file.keep_scaling_alone();
  return file.bytes();
}

void expect_sound(const Model& model) {
  EXPECT_FALSE(network::fault_of(model.weights.shape).has_value());
  ASSERT_EQ(model.weights.values.size(), network::weight_count(model.weights.shape));
  for (const float value : model.weights.values) ASSERT_TRUE(std::isfinite(value));
  EXPECT_TRUE(std::isfinite(model.scaling.label_scale_dps) && model.scaling.label_scale_dps > 0.0F);
  EXPECT_TRUE(std::isfinite(model.scaling.temp_mean_c));
  EXPECT_TRUE(std::isfinite(model.scaling.temp_deviation_c) && model.scaling.temp_deviation_c > 0.0F);
}

/// Was it taken?
bool read_mutated(const std::string& file) {
  try {
    expect_sound(reread(file));
    return true;
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::not_a_session);
    return false;
  }
}

TEST(MutatedFile, IsRefusedOrSound) {
  const std::string plain = file_without_checksum(small_model()), whole = to_onnx(small_model());
  const std::string donor = to_onnx(sample_model({.frames = 2, .reduction = 3}));
  std::uint64_t taken = 0;
  for (std::uint64_t seed = 0; seed < mutations(); ++seed) {
    const std::string file = Mutation(seed).of(seed % 4 == 0 ? whole : plain, donor);
    const AllocationCount count;
    taken += read_mutated(file) ? 1 : 0;
    // Of sound files: the tensors as bytes and as weights, and little beside; of others never much more.
    ASSERT_LT(count.peak_bytes(), 4 * file.size() + (1U << 20U)) << "seed " << seed;
    ASSERT_FALSE(HasFailure()) << "seed " << seed;
  }
  EXPECT_GT(taken, mutations() / 50) << "most mutations never get past the first check";
  EXPECT_LT(taken, mutations());
  RecordProperty("taken", std::to_string(taken));
}

/// Two bytes each that become a message each.
TEST(SmallFields, TakeLessThanEightyTimesTheirBytes) {
  std::string nodes;
  for (int i = 0; i < 100'000; ++i) nodes += std::string("\x0a\x00", 2);
  std::string file = "\x3a";
  for (std::size_t rest = nodes.size(); rest > 0; rest >>= 7U)
    file += static_cast<char>((rest & 127U) | (rest > 127 ? 128U : 0U));
  file += nodes;
  const AllocationCount count;
  EXPECT_NE(refusal_of(file), "");
  EXPECT_LT(count.peak_bytes(), 80 * file.size());
}

}  // namespace
}  // namespace thermorig::model

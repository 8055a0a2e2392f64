// SPDX-License-Identifier: MIT
#include "fit/motion/contest.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace thermorig::motion {
namespace {

/// The lead of a panorama that is better by so much in each block of a second.
double lead_of(const std::vector<double>& better_by) {
  Contest contest(1.0);
  std::vector<FreshHalf> halves(better_by.size());
  std::vector<double> first, second;
  for (std::size_t i = 0; i < better_by.size(); ++i) {
    halves[i].begin_s = static_cast<double>(i) + 0.5;
    first.push_back(0.4);
    second.push_back(0.4 * std::exp(better_by[i]));
  }
  contest.add(halves, first, second);
  return contest.lead();
}

/// Chance: as often one way as the other.
std::vector<double> chance(std::size_t blocks, double size) {
  std::vector<double> differences;
  for (std::size_t i = 0; i < blocks; ++i)
    differences.push_back((i % 2 == 0 ? size : -size) * (1.0 + 0.01 * static_cast<double>(i)));
  return differences;
}

TEST(Contest, IsWonWhereAFewBlocksTellMuchAndAllOthersLittleButTheSame) {
  std::vector<double> differences(40, 0.01);
  for (std::size_t i = 0; i < differences.size(); ++i) differences[i] += 0.0001 * static_cast<double>(i);
  for (std::size_t i = 0; i < 5; ++i) differences[i * 8] = 0.3;
  EXPECT_GT(lead_of(differences), clear_lead);
  for (double& difference : differences) difference = -difference;
  EXPECT_LT(lead_of(differences), -clear_lead);
}

TEST(Contest, IsWonByEqualBlocksEvenIfTheyAreFew) {
  EXPECT_GT(lead_of({0.1, 0.11, 0.12, 0.1, 0.11, 0.09}), clear_lead);
}

TEST(Contest, IsNotWonByChanceNorByAFewBlocksAlone) {
  EXPECT_LT(std::abs(lead_of(chance(40, 0.01))), 1.0);
  std::vector<double> differences = chance(40, 0.01);
  for (std::size_t i = 0; i < 5; ++i) differences[i * 8] = 0.3;
  EXPECT_LT(lead_of(differences), clear_lead);
  EXPECT_EQ(lead_of({0.1, 0.1, 0.1}), 0.0);
  EXPECT_EQ(lead_of(std::vector<double>(20, 0.0)), 0.0);
}

}  // namespace
}  // namespace thermorig::motion

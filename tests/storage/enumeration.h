// SPDX-License-Identifier: MIT
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "judge.h"

namespace thermorig::storage_test {

/// What is left out on purpose, to see that the enumeration notices.
enum class Mutation : std::uint8_t { none, no_sync, no_folder_sync };

struct EnumerationSettings {
  double share = 1.0;  // of the crash points of the recording, drawn by the seed
  std::size_t error_stride =
      40;                    // every so many-th append of the recording fails, and all rare calls; 0: none
  double error_share = 1.0;  // of the errors, drawn likewise
  std::size_t starts = 24;   // disks that recovery is enumerated on
  std::size_t recover_stride = 10;  // every so many-th different recording is recovered whole
  std::uint64_t seed = 1;
  unsigned part = 0, parts = 1;  // this process does the points of its part
  Mutation mutation = Mutation::none;
  std::string samples;  // folder for sessions that a stock reader is to open; empty: none
};

/// One line of the table.
struct Tally {
  std::uint64_t points = 0;
  std::array<std::uint64_t, 4> outcomes{};  // by Outcome
  double worst_loss_ms = 0;                 // of time before the end, that nothing is left of
  std::string example;                      // the first that was silent or beyond
};

struct Enumeration {
  std::map<std::string, Tally> lines;
  std::uint64_t recoveries = 0;  // whole ones, of different disks
  std::uint64_t readings = 0;    // of different disks
};

/// Every kind of fault at every call of the recording and of its recovery, as far as `settings` draw it.
Enumeration enumerate(const RecordedSession& truth, const EnumerationSettings& settings);

/// Adds up what several processes have done.
void add(Enumeration& sum, const Enumeration& part);

std::uint64_t points_of(const Enumeration& enumeration);
std::uint64_t count_of(const Enumeration& enumeration, Outcome outcome);

}  // namespace thermorig::storage_test

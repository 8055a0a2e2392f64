// SPDX-License-Identifier: MIT
#include "left_out.h"

#include <fmt/format.h>

#include <algorithm>

#include "fingerprint.h"
#include "thermorig/core/error.h"

namespace thermorig::study {

namespace {

using network::Acquisition;

constexpr std::size_t kept_angle_points = 120;  // a result stays small

[[noreturn]] void refuse(const Job& job, const std::string& what) {
  throw Error(ExitCode::bad_usage, what, job.test,
              "name the sessions that the study was made of, all of them and no others");
}

}  // namespace

bool is_test_of(const Job& job, const Acquisition& acquisition) {
  return acquisition.name == job.test && acquisition.hash == job.test_hash;
}

const Acquisition& left_out_of(const Job& job, std::span<const Acquisition> acquisitions) {
  const auto found =
      std::find_if(acquisitions.begin(), acquisitions.end(),
                   [&](const Acquisition& acquisition) { return is_test_of(job, acquisition); });
  if (found == acquisitions.end()) refuse(job, "the acquisition to be tested on is not among the sessions");
  if (found->label != job.label)
    throw Error(ExitCode::bad_usage,
                fmt::format("the job learns from {}, and the sessions were read with {}",
                            column_of(job.label), column_of(found->label)),
                job.test, fmt::format("--label {}", name_of(job.label)));
  if (fingerprint_of(acquisitions) != job.data_hash) refuse(job, "the job is of other sessions");
  return *found;
}

std::vector<network::Window> test_windows(const Job& job, const Acquisition& left_out) {
  return network::find_windows({&left_out, 1}, job.frames, job.history);
}

Evaluation evaluation_of(std::span<const JudgedWindow> judged, const Acquisition& left_out,
                         double label_scale_dps) {
  return evaluate(judged, {&left_out, 1},
                  {.label_scale_dps = label_scale_dps, .angle_points = kept_angle_points});
}

}  // namespace thermorig::study

// SPDX-License-Identifier: MIT
#include "job_claims.h"
#include "result_file.h"

namespace thermorig::study {

namespace fs = std::filesystem;

fs::path claim_name(const fs::path& folder, const Job& job) {
  return folder / id_of(job);
}

bool is_held(const files::ClaimSight& claim) {
  return !claim.is_free() && !(claim.holder && files::has_ended(*claim.holder));
}

std::vector<JobStanding> standings_of(std::span<const Job> jobs, const fs::path& folder) {
  std::vector<JobStanding> standings(jobs.size());
  for (std::size_t i = 0; i < jobs.size(); ++i) {
    if (find_result(folder, jobs[i])) {
      standings[i].state = JobState::done;
      continue;
    }
    const files::ClaimSight claim = files::look_at_claim(claim_name(folder, jobs[i]));
    if (is_held(claim)) standings[i] = {JobState::claimed, claim};
  }
  return standings;
}

}  // namespace thermorig::study

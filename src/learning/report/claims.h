// SPDX-License-Identifier: MIT
#pragma once

#include <string>
#include <vector>

#include "study_view.h"

namespace thermorig::report {

enum class Verdict { holds, holds_in_part, too_close, fails, unknown };
/// "holds", "within the spread of seeds", ...; `seeds` says whether that spread is known.
std::string text_of(Verdict verdict, bool seeds);

/// A statement about the results, judged by them alone.
struct Claim {
  std::string key;  // for programs
  std::string statement;
  Verdict verdict = Verdict::unknown;
  std::string evidence;  // the numbers
  bool of_paper = true;  // false: asked beside the paper's claims
};

/// The paper's claims (section IV and its abstract) on these results, and what the paper does not ask.
std::vector<Claim> claims_of(const StudyView& view);

/// Are there two seeds to tell chance from differences?
bool seeds_known(const StudyView& view);

/// How claims are judged, in words, with the spread over seeds in numbers.
std::string judging_text(const StudyView& view);

// The parts of it.
Claim lower_median_claim(const StudyView& view);
Claim smaller_spread_claim(const StudyView& view);
Claim growth_claim(const StudyView& view, bool fusion);
Claim less_growth_claim(const StudyView& view);
Claim best_frames_claim(const StudyView& view, bool fusion);
Claim drift_claim(const StudyView& view);
Claim gain_peak_claim(const StudyView& view);
Claim beats_claim(const StudyView& view, const std::string& baseline);

}  // namespace thermorig::report

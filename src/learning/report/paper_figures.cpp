// SPDX-License-Identifier: MIT
#include "paper_figures.h"

#include <algorithm>

namespace thermorig::report {

std::optional<PaperRow> paper_row(int frames, int reduction) {
  const auto row = std::find_if(paper_rows.begin(), paper_rows.end(), [&](const PaperRow& candidate) {
    return candidate.frames == frames && candidate.reduction == reduction;
  });
  if (row == paper_rows.end()) return std::nullopt;
  return *row;
}

}  // namespace thermorig::report

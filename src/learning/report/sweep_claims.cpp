// SPDX-License-Identifier: MIT
// How the error goes with Nf and Nr.
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "claims.h"
#include "paper_figures.h"
#include "seed_spread.h"
#include "text.h"

namespace thermorig::report {
namespace {

struct Point {
  int at = 0;  // Nf or Nr
  double median = 0.0;
};

std::vector<Point> points_of(const StudyView& view, bool fusion, const std::vector<Setting>& sweep,
                             int Setting::*axis) {
  std::vector<Point> points;
  for (const Setting& setting : sweep) {
    const study::SettingSummary* summary = view.find(setting, fusion);
    if (summary != nullptr && complete(view, *summary) && median_of(*summary) > 0.0)
      points.push_back({setting.*axis, median_of(*summary)});
  }
  return points;
}

std::string text_of_points(const std::vector<Point>& points, const char* axis) {
  std::string text;
  for (const Point& point : points)
    text += fmt::format("{}{} = {}: {}", text.empty() ? "" : ", ", axis, point.at, mse_text(point.median));
  return text;
}

std::vector<Point> reductions_of(const StudyView& view, bool fusion) {
  return points_of(view, fusion, view.reduction_sweep(), &Setting::reduction);
}

const char* setup(bool fusion) {
  return fusion ? "fusion" : "thermal-only";
}

/// Median at the largest Nr over that at the smallest; nothing with fewer than two.
std::optional<double> growth_of(const std::vector<Point>& points) {
  if (points.size() < 2) return std::nullopt;
  return points.back().median / points.front().median;
}

bool rises(const std::vector<Point>& points) {
  return std::is_sorted(points.begin(), points.end(),
                        [](const Point& a, const Point& b) { return a.median < b.median; });
}

}  // namespace

Claim growth_claim(const StudyView& view, bool fusion) {
  Claim claim{fmt::format("grows_with_reduction_{}", fusion ? "fusion" : "thermal"),
              fmt::format("The error grows with Nr ({})", setup(fusion))};
  const auto points = reductions_of(view, fusion);
  const auto growth = growth_of(points);
  if (!growth) {
    claim.evidence = "fewer than two values of Nr have all folds";
    return claim;
  }
  const Order order = compare(1.0, *growth, seed_factor(view, fusion, median_of).value_or(1.0));
  if (order == Order::same) claim.verdict = Verdict::too_close;
  if (order == Order::larger) claim.verdict = Verdict::fails;
  if (order == Order::smaller) claim.verdict = rises(points) ? Verdict::holds : Verdict::holds_in_part;
  claim.evidence =
      fmt::format("median {}: {:.2f} times from Nr = {} to {}{}", text_of_points(points, "Nr"), *growth,
                  points.front().at, points.back().at, rises(points) ? "" : ", not step by step");
  return claim;
}

Claim less_growth_claim(const StudyView& view) {
  Claim claim{"grows_less_with_fusion", "The error grows less with Nr when fused"};
  const auto thermal = growth_of(reductions_of(view, false)), fused = growth_of(reductions_of(view, true));
  if (!thermal || !fused) {
    claim.evidence = "fewer than two values of Nr have all folds of both set-ups";
    return claim;
  }
  const Order order = compare(*fused, *thermal, larger_seed_factor(view, median_of).value_or(1.0));
  claim.verdict = order == Order::smaller ? Verdict::holds
                  : order == Order::same  ? Verdict::too_close
                                          : Verdict::fails;
  claim.evidence =
      fmt::format("the median grows {:.2f} times with fusion, {:.2f} times thermal-only", *fused, *thermal);
  return claim;
}

Claim best_frames_claim(const StudyView& view, bool fusion) {
  Claim claim{fmt::format("three_frames_best_{}", fusion ? "fusion" : "thermal"),
              fmt::format("Nf = 3 is best ({})", setup(fusion))};
  auto points = points_of(view, fusion, view.frame_sweep(), &Setting::frames);
  const std::string numbers = text_of_points(points, "Nf");
  std::sort(points.begin(), points.end(), [](const Point& a, const Point& b) { return a.median < b.median; });
  const auto three =
      std::find_if(points.begin(), points.end(), [](const Point& point) { return point.at == paper_frames; });
  if (points.size() < 2 || three == points.end()) {
    claim.evidence = "it takes all folds at Nf = 3 and at another Nf";
    return claim;
  }
  const Point& rival = three == points.begin() ? points[1] : points[0];
  const Order order =
      compare(three->median, rival.median, seed_factor(view, fusion, median_of).value_or(1.0));
  claim.verdict = order == Order::smaller ? Verdict::holds
                  : order == Order::same  ? Verdict::too_close
                                          : Verdict::fails;
  claim.evidence = fmt::format("lowest median at Nf = {}; {}", points.front().at, numbers);
  return claim;
}

}  // namespace thermorig::report

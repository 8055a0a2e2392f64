// SPDX-License-Identifier: MIT
#include <algorithm>
#include <array>
#include <cmath>

#include "evidence.h"
#include "thermorig/core/statistics.h"
#include "thermorig/fit/motion/panorama_fit.h"
#include "windows.h"

namespace thermorig::motion {
namespace {

constexpr std::size_t most_windows = 8;  // four thousand halves: more do not make it more certain
constexpr double worst_uncertainty_s = 0.005;
constexpr double least_offset_contrast = 0.15;
// Pixels follow the scene with a lag of some ten milliseconds. Fine structure that passes fast is delayed a
// little less by it than coarse structure: as much as the surroundings make of it is not known.
constexpr double lag_error_s = 0.0003;
// What a longer lag (to 40 ms) hides is three times what coarse structure comes later than fine: found on
// simulated rigs, two to five times. A difference as small as the error above says nothing.
constexpr double fine_bins = 0.4, coarse_bins = 2.0;  // of the usual ones
constexpr double hidden_per_difference = 3.0;
constexpr double most_hidden_s = 0.004;  // by a lag of 40 ms: no membrane is slower
constexpr std::size_t lag_windows = 2;   // so many tell of it

// Rows are looked at in bands, from the upper ones to the lower ones.
constexpr std::size_t bands = 4;
constexpr std::size_t band_rows = half_rows / bands;  // of a column of a half-frame
constexpr std::size_t row_windows = 2;                // so many tell how rows are read
constexpr double middle_row = 0.5 * (frame_rows - 1.0);
constexpr double row_error = 0.5;  // of the middle row of a band: what is seen there differs by angle
constexpr double least_leverage_rows2 = 4.0;

/// Both halves of a frame get its whole span where nobody knows which one came first.
bool is_order_unknown(const FreshHalf& half) {
  const auto& exposures = half.frame->half;
  return exposures[0].begin == exposures[1].begin && exposures[0].end == exposures[1].end;
}

/// Why those halves cannot tell a delay.
std::string refusal(std::span<const FreshHalf> halves) {
  const RateRange rates = rates_of(halves);
  if (fastest_dps(halves) < slowest_useful_dps) return "nothing turned";
  if (std::min(rates.positive_dps, -rates.negative_dps) < slowest_useful_dps)
    return "it turned one way only: a delay shows where the same surroundings pass in both directions";
  return {};
}

/// Some rows of a half-frame alone, by their number in a column (row_of()).
std::vector<HalfView> views_of_rows(const Window& window, std::size_t begin, std::size_t end) {
  std::vector<HalfView> views = views_of(window);
  for (HalfView& view : views)
    for (std::size_t column = 0; column < frame_columns; ++column)
      for (std::size_t k = 0; k < half_rows; ++k)
        if (k < begin || k >= end) view.trust[column * half_rows + k] = 0.0F;
  return views;
}

bool is_told(const Alignment& alignment) {
  return alignment.uncertainty(offset_s) < worst_uncertainty_s &&
         alignment.contrast() > least_offset_contrast &&
         std::abs(alignment.parameters()[offset_s]) < largest_offset_s;
}

/// The offset of a band of rows, and its middle row.
struct BandOffset {
  double row = 0.0;
  Estimate offset_s;
};

std::optional<BandOffset> offset_of_band(const Window& window, const Evidence& evidence, const Layout& layout,
                                         const Parameters& start, std::size_t band) {
  std::vector<HalfView> views = views_of_rows(window, band * band_rows, (band + 1) * band_rows);
  Alignment alignment(views, evidence.track, layout, evidence.prior);
  alignment.refine(start, offset_s);
  if (!is_told(alignment)) return std::nullopt;
  return BandOffset{
      alignment.middle_row(),
      {alignment.parameters()[offset_s], std::hypot(alignment.uncertainty(offset_s), lag_error_s)}};
}

/// A straight line through what the bands say.
struct RowLine {
  Estimate middle_s;  // offset of the middle row
  Estimate slope_s;   // from one row to the next
};

std::optional<RowLine> line_through(const std::vector<BandOffset>& told) {
  LineFit line;
  for (const BandOffset& band : told)
    line.add(band.row - middle_row, band.offset_s.value, std::pow(band.offset_s.uncertainty, -2));
  if (!(line.squares_x() > least_leverage_rows2 * line.weights())) return std::nullopt;
  const double degrees_of_freedom = std::max(1.0, static_cast<double>(told.size()) - 2.0);
  const double widened = std::sqrt(std::max(1.0, line.residual_squares() / degrees_of_freedom));
  const double slope_uncertainty_s = 1.0 / std::sqrt(line.squares_x());
  const double middle_uncertainty_s =
      std::hypot(1.0 / std::sqrt(line.weights()), line.mean_x() * slope_uncertainty_s);
  return RowLine{{line.at(0.0), widened * std::hypot(middle_uncertainty_s, row_error * line.slope())},
                 {line.slope(), widened * slope_uncertainty_s}};
}

/// How the rows of some windows follow one another. `offset_tried_s`: of all rows together.
std::optional<RowLine> offset_by_rows(const std::vector<Window>& windows, const Evidence& evidence,
                                      const Layout& layout, double offset_tried_s, const RunAll& run_all) {
  Parameters start = evidence.prior.mean;
  start[offset_s] = offset_tried_s;
  const std::size_t step = std::max<std::size_t>(1, windows.size() / row_windows);
  std::vector<std::optional<BandOffset>> offsets((windows.size() + step - 1) / step * bands);
  run_all(offsets.size(), [&](std::size_t i) {
    offsets[i] = offset_of_band(windows[i / bands * step], evidence, layout, start, i % bands);
  });
  std::vector<BandOffset> told;
  for (const auto& offset : offsets)
    if (offset) told.push_back(*offset);
  if (told.size() < bands) return std::nullopt;
  return line_through(told);
}

/// Rows that are read one after the other: the offset is that of the middle ones, whatever the scene shows
/// where.
void look_at_rows(const std::vector<Window>& windows, const Evidence& evidence, const Layout& layout,
                  const RunAll& run_all, CameraOffset& result) {
  const auto line = offset_by_rows(windows, evidence, layout, result.offset_s->value, run_all);
  if (!line) return;
  result.row_delay_s = Estimate{-line->slope_s.value, line->slope_s.uncertainty};  // later rows are less late
  if (are_rows_apart(result)) result.offset_s = line->middle_s;
}

/// `start`: nothing, where the offset is to be searched for.
std::optional<Estimate> offset_of(const Window& window, const Evidence& evidence, const Layout& layout,
                                  const std::optional<Parameters>& start) {
  std::vector<HalfView> views = views_of(window);
  Alignment alignment(views, evidence.track, layout, evidence.prior);
  alignment.refine(start ? *start : alignment.search_offset(), offset_s);
  if (!is_told(alignment)) return std::nullopt;
  return Estimate{alignment.parameters()[offset_s], alignment.uncertainty(offset_s)};
}

/// How far a long lag of the pixels may put the offset wrong: what is fine is less late by it than what is
/// coarse, and only what is coarser than a view would show the whole of it. 0 where nothing shows one.
double hidden_lag_s(const std::vector<Window>& windows, const Evidence& evidence, const Layout& layout,
                    double offset_tried_s, const RunAll& run_all) {
  Parameters start = evidence.prior.mean;
  start[offset_s] = offset_tried_s;
  const std::size_t step = std::max<std::size_t>(1, windows.size() / lag_windows);
  std::vector<std::array<std::optional<Estimate>, 2>> offsets((windows.size() + step - 1) / step);
  run_all(2 * offsets.size(), [&](std::size_t i) {
    Layout binned = layout;
    binned.bin_factor = i % 2 == 0 ? fine_bins : coarse_bins;
    offsets[i / 2][i % 2] = offset_of(windows[i / 2 * step], evidence, binned, start);
  });
  std::vector<Estimate> later;
  for (const auto& [fine, coarse] : offsets)
    if (fine && coarse) later.push_back({coarse->value - fine->value, coarse->uncertainty});
  if (later.empty()) return 0.0;
  const Estimate mean = weighted_mean(later);
  const double chance_s = std::hypot(lag_error_s, mean.uncertainty);
  if (!(mean.value > chance_s)) return 0.0;
  return std::min(most_hidden_s,
                  hidden_per_difference * std::sqrt(mean.value * mean.value - chance_s * chance_s));
}

}  // namespace

CameraOffset camera_offset(std::span<const TimedFrame> frames, std::span<const TimedGyro> gyro,
                           const View& view, const GyroErrors& errors, const RunAll& run_all) {
  CameraOffset result;
  Evidence evidence = gather(frames, gyro, view, errors);
  result.why_not = evidence.why_not.empty() ? refusal(evidence.halves) : evidence.why_not;
  std::erase_if(evidence.halves, is_order_unknown);
  if (result.why_not.empty() && evidence.halves.size() < fewest_halves)
    result.why_not = "which half of a frame is newer is not known";
  if (!result.why_not.empty()) return result;
  std::vector<Estimate> told;
  std::vector<Window> telling;
  const Layout layout = layout_of(view, false);
  std::optional<Parameters> start;
  for (Window& window : moving_windows(evidence.halves, most_windows)) {
    if (window.size() < fewest_halves || !refusal(window).empty()) continue;
    const auto offset = offset_of(window, evidence, layout, start);
    if (!offset) continue;
    told.push_back(*offset);
    result.halves += static_cast<std::uint32_t>(window.size());
    start = evidence.prior.mean;
    (*start)[offset_s] = offset->value;
    telling.push_back(std::move(window));
  }
  if (told.empty()) {
    result.why_not = "too little image detail, or the images do not turn with the gyro";
    return result;
  }
  result.offset_s = weighted_mean(told);
  result.offset_s->uncertainty = std::hypot(result.offset_s->uncertainty, lag_error_s);
  const double hidden_s = hidden_lag_s(telling, evidence, layout, result.offset_s->value, run_all);
  look_at_rows(telling, evidence, layout, run_all, result);
  result.offset_s->uncertainty = std::hypot(result.offset_s->uncertainty, hidden_s);
  return result;
}

}  // namespace thermorig::motion

// SPDX-License-Identifier: MIT
// Do the even and the odd chess halves of a camera's own bytes tell the same rate, each alone? And does the
// estimator, of all halves, tell of the reversed bytes the rate with the other sign? No truth is needed.
// Usage: halves_alone CAPTURE FRAMES_A_SECOND [--json]: bytes as a GY-MCU90640 sent them, both halves anew in
// each frame.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <string>
#include <string_view>
#include <vector>

#include "estimators/likelihood/pixel_errors.h"
#include "estimators/likelihood/scene_prior.h"
#include "estimators/likelihood/window_lines.h"
#include "thermorig/estimators/likelihood/camera_rate.h"
#include "thermorig/sensors/wire/camera_scanner.h"

namespace thermorig::bench {
namespace {

using likelihood::HalfLines;

constexpr std::size_t halves = 3;  // of one parity: every second one
constexpr double largest_speed = 16.0, speed_step = 0.1, trusted = 0.7;
constexpr double seen_variance = 0.05;  // of a pattern, in the noise's

/// Patterns of every second half at one speed, exactly: eigenvectors of their covariance.
struct Patterns {
  double speed = 0.0;
  Eigen::MatrixXd vectors;
  Eigen::VectorXd variances;
};

Patterns patterns_at(double speed, bool is_centred) {
  constexpr auto pixels = static_cast<Eigen::Index>(likelihood::line_pixels);
  constexpr auto lines = static_cast<Eigen::Index>(halves) * pixels;
  const auto place = [&](Eigen::Index i) {
    return 2.0 * static_cast<double>(i % pixels) + 2.0 * speed * static_cast<double>(i / pixels);
  };
  Eigen::MatrixXd covariance(lines, lines);
  for (Eigen::Index i = 0; i < lines; ++i)
    for (Eigen::Index k = 0; k < lines; ++k)
      covariance(i, k) = likelihood::swept_covariance(place(i) - place(k), speed);
  for (int side = 0; side < 2 && is_centred; ++side) {
    for (Eigen::Index half = 0; half < lines; half += pixels) {
      auto rows = covariance.middleRows(half, pixels);
      rows.rowwise() -= rows.colwise().mean().eval();
    }
    covariance.transposeInPlace();
  }
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> solver(covariance);
  return {speed, solver.eigenvectors(), solver.eigenvalues().cwiseMax(0.0)};
}

class Speeds {
 public:
  Speeds() {
    for (double speed = -largest_speed; speed < largest_speed + 0.5 * speed_step; speed += speed_step) {
      plain_.push_back(patterns_at(speed, false));
      centred_.push_back(patterns_at(speed, true));
    }
  }

  struct Found {
    double speed = 0.0, sigma = 0.0;
  };
  /// Widened by what no speed explains, as the estimator does it.
  Found find(unsigned parity, const std::array<const HalfLines*, halves>& seen, double noise_variance) const {
    likelihood::WindowLines window(halves);
    window.set(parity, seen);
    std::vector<Fit> fits;
    for (std::size_t k = 0; k < plain_.size(); ++k) fits.push_back(fit(window, k, noise_variance));
    const auto top = std::max_element(fits.begin(), fits.end(),
                                      [](const Fit& a, const Fit& b) { return a.logarithm < b.logarithm; });
    const double best = plain_[static_cast<std::size_t>(top - fits.begin())].speed;
    double mass = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < plain_.size(); ++k) {
      const double own = std::exp(trusted * (fits[k].logarithm - top->logarithm)),
                   off = plain_[k].speed - best;
      mass += own;
      squares += own * off * off;
    }
    const double misfit = top->unexplained / std::max(1.0, top->freedom);
    return {best, std::hypot(std::sqrt(squares / mass), speed_step) * std::max(1.0, misfit)};
  }

 private:
  struct Fit {
    double logarithm = 0.0;  // of the likelihood
    double unexplained = 0.0,
           freedom = 0.0;  // along patterns of which nothing is seen; in the noise's variance
  };

  Fit fit(const likelihood::WindowLines& window, std::size_t place, double noise_variance) const {
    Fit fit;
    for (std::size_t row_class = 0; row_class < 2; ++row_class) {
      const std::size_t at = row_class == 0 ? place : plain_.size() - 1 - place;
      for (std::size_t wave = 0; wave < likelihood::half_rows; ++wave) {
        const Patterns& patterns = (wave == 0 ? centred_ : plain_)[at];
        const auto freedom = static_cast<double>(window.lines() - (wave == 0 ? halves : 0));
        const double contrast = std::max(0.0, window.energy(wave) / (2.0 * freedom * noise_variance) - 1.0) *
                                freedom / patterns.variances.sum();
        Eigen::VectorXd values(static_cast<Eigen::Index>(window.lines()));
        for (std::size_t i = 0; i < window.lines(); ++i)
          values[static_cast<Eigen::Index>(i)] =
              double{wave == 0 ? window.longest(row_class)[i]
                               : window.waves(row_class)[i * likelihood::half_rows + wave]};
        const Eigen::ArrayXd ratio = contrast * patterns.variances.array();
        const Eigen::ArrayXd energy =
            (patterns.vectors.transpose() * values).array().square() / noise_variance;
        fit.logarithm += 0.5 * (energy * ratio / (1.0 + ratio)).sum() - 0.5 * (1.0 + ratio).log().sum();
        const Eigen::ArrayXd unseen = (ratio < seen_variance).cast<double>();
        fit.unexplained += (energy * unseen).sum();
        fit.freedom += unseen.sum() - (wave == 0 ? halves : 0);
      }
    }
    return fit;
  }

  std::vector<Patterns> plain_, centred_;
};

/// `first`: the half that was exposed before the other.
TimedFrame timed(const wire::CameraMessage& message, std::size_t index, double period_s, unsigned first) {
  TimedFrame frame;
  frame.frame = message.frame;
  frame.fresh_even = frame.fresh_odd = frame_pixels / 2;
  const HostTime begin = host_time_ns(0) + from_s(period_s * static_cast<double>(index));
  frame.half[first] = {begin, begin + from_s(0.5 * period_s)};
  frame.half[first ^ 1U] = {begin + from_s(0.5 * period_s), begin + from_s(period_s)};
  frame.exposure_begin = begin;
  frame.exposure_end = frame.stamp.time = begin + from_s(period_s);
  return frame;
}

using Messages = std::vector<wire::CameraMessage>;

/// What the estimator itself says of all four halves of two frames, frame by frame.
std::vector<likelihood::CameraRateReport> reports_of(const Messages& messages, double period_s,
                                                     unsigned first) {
  likelihood::CameraRate rate({}, 2);
  std::vector<likelihood::CameraRateReport> reports;
  for (std::size_t i = 0; i < messages.size(); ++i)
    reports.push_back(rate.add(timed(messages[i], i, period_s, first)));
  return reports;
}

/// How often two rates of the same window agree.
struct Agreement {
  int windows = 0, told = 0, agree = 0;
  std::vector<std::string> apart;

  void add(std::size_t window, const likelihood::CameraRateReport& a, const likelihood::CameraRateReport& b) {
    ++windows;
    if (std::max(a.sigma_dps, b.sigma_dps) >= likelihood::told_sigma_dps) return;
    ++told;
    if (std::abs(a.rate_dps - b.rate_dps) <= 2.0 * std::hypot(a.sigma_dps, b.sigma_dps)) {
      ++agree;
      return;
    }
    apart.push_back(fmt::format("window {}: {:+.1f} +- {:.1f} and {:+.1f} +- {:.1f} deg/s", window,
                                a.rate_dps, a.sigma_dps, b.rate_dps, b.sigma_dps));
  }
  double percent() const { return 100.0 * agree / std::max(1, told); }
};

Agreement of_halves(const Messages& messages, double period_s, const Speeds& speeds, unsigned first) {
  likelihood::PixelErrors errors;
  std::vector<std::array<HalfLines, 2>> seen(messages.size());
  for (std::size_t i = 0; i < messages.size(); ++i)
    for (const unsigned parity : {0U, 1U}) errors.clean(messages[i].frame, parity, seen[i][parity]);
  const auto reports = reports_of(messages, period_s, first);
  const double speed_dps = CameraProfile{}.field_of_view_deg / double{frame_columns} / (0.5 * period_s);
  Agreement agreement;
  for (std::size_t i = halves - 1; i < messages.size(); ++i) {
    if (!reports[i].is_complete) continue;
    std::array<likelihood::CameraRateReport, 2> alone;
    for (const unsigned parity : {0U, 1U}) {
      const Speeds::Found found =
          speeds.find(parity, {&seen[i - 2][parity], &seen[i - 1][parity], &seen[i][parity]},
                      reports[i].noise_c * reports[i].noise_c);
      alone[parity].rate_dps = speed_dps * found.speed;
      alone[parity].sigma_dps = speed_dps * found.sigma;
    }
    agreement.add(i, alone[0], alone[1]);
  }
  return agreement;
}

/// Window i of the bytes as they came is window `count - i` of the reversed ones.
Agreement of_times(const std::vector<likelihood::CameraRateReport>& forward,
                   const std::vector<likelihood::CameraRateReport>& reversed) {
  Agreement agreement;
  for (std::size_t i = 1; i < forward.size(); ++i) {
    likelihood::CameraRateReport back = reversed[forward.size() - i];
    if (!forward[i].is_complete || !back.is_complete) continue;
    back.rate_dps = -back.rate_dps;
    agreement.add(i, forward[i], back);
  }
  return agreement;
}

struct Figure {
  const char *name, *what;
  Agreement agreement;
};

void print(const std::vector<Figure>& figures) {
  for (const Figure& figure : figures) {
    const Agreement& all = figure.agreement;
    fmt::print(
        "{}: {} windows, {} cannot tell; of the others {:.1f} % agree within two combined sigmas (90 "
        "wanted)\n",
        figure.what, all.windows, all.windows - all.told, all.percent());
    for (const std::string& one : all.apart) fmt::print("  {}\n", one);
  }
}

void print_json(const std::vector<Figure>& figures) {
  const char* separator = "{";
  for (const Figure& figure : figures) {
    const Agreement& all = figure.agreement;
    fmt::print("{0}\"{1}_windows\": {2}, \"{1}_cannot_tell\": {3}, \"{1}_agree_percent\": {4:.1f}", separator,
               figure.name, all.windows, all.windows - all.told, all.percent());
    separator = ", ";
  }
  fmt::print("}}\n");
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** arguments) {
  using namespace thermorig;
  const double rate_hz = count >= 3 ? std::strtod(arguments[2], nullptr) : 0.0;
  const bool is_json = count == 4 && std::string_view(arguments[3]) == "--json";
  if (!(rate_hz > 0.0) || (count > 3 && !is_json)) {
    fmt::print(stderr, "usage: halves_alone CAPTURE FRAMES_A_SECOND [--json]\n");
    return 2;
  }
  std::ifstream file(arguments[1], std::ios::binary);
  const std::vector<char> read{std::istreambuf_iterator<char>(file), {}};
  const std::vector<std::uint8_t> bytes(read.begin(), read.end());
  wire::CameraScanner scanner;
  bench::Messages forward;
  scanner.push(bytes, forward);
  if (forward.size() < bench::halves) {
    fmt::print(stderr, "{}: {} frames, {} are needed\n", arguments[1], forward.size(), bench::halves);
    return 1;
  }
  const bench::Messages reversed(forward.rbegin(), forward.rend());
  const double period_s = 1.0 / rate_hz;
  const bench::Speeds speeds;
  const std::vector<bench::Figure> figures{
      {"halves_forward", "even and odd halves, each alone", bench::of_halves(forward, period_s, speeds, 0)},
      {"halves_reversed", "the same, time reversed", bench::of_halves(reversed, period_s, speeds, 1)},
      {"times", "both halves, forward and reversed",
       bench::of_times(bench::reports_of(forward, period_s, 0), bench::reports_of(reversed, period_s, 1))}};
  is_json ? print_json(figures) : print(figures);
  return 0;
}

// SPDX-License-Identifier: MIT
// Do the even and the odd chess halves of a camera's own bytes tell the same rate, each alone? No truth is
// needed. Usage: halves_alone CAPTURE FRAMES_A_SECOND: bytes as a GY-MCU90640 sent them, both halves anew in
// each frame.
#include <fmt/format.h>

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <iterator>
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
constexpr double told_sigma_dps = 20.0;

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
  Found find(unsigned parity, const std::array<const HalfLines*, halves>& seen, double noise_variance) const {
    likelihood::WindowLines window(halves);
    window.set(parity, seen);
    std::vector<double> logarithms;
    for (std::size_t k = 0; k < plain_.size(); ++k)
      logarithms.push_back(logarithm(window, k, noise_variance));
    const auto top = std::max_element(logarithms.begin(), logarithms.end());
    const double best = plain_[static_cast<std::size_t>(top - logarithms.begin())].speed;
    double mass = 0.0, squares = 0.0;
    for (std::size_t k = 0; k < plain_.size(); ++k) {
      const double own = std::exp(trusted * (logarithms[k] - *top)), off = plain_[k].speed - best;
      mass += own;
      squares += own * off * off;
    }
    return {best, std::hypot(std::sqrt(squares / mass), speed_step)};
  }

 private:
  double logarithm(const likelihood::WindowLines& window, std::size_t place, double noise_variance) const {
    double sum = 0.0;
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
        const Eigen::ArrayXd along = (patterns.vectors.transpose() * values).array();
        sum += 0.5 * (along.square() * ratio / (1.0 + ratio)).sum() / noise_variance -
               0.5 * (1.0 + ratio).log().sum();
      }
    }
    return sum;
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

/// What the estimator itself says of all four halves of two frames.
void tell_estimator(const std::vector<wire::CameraMessage>& messages, double period_s, unsigned first) {
  likelihood::CameraRate rate({}, 2);
  int told = 0, count = 0;
  double fastest_dps = 0.0, noise_c = 0.0;
  std::vector<double> sigmas;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const auto report = rate.add(timed(messages[i], i, period_s, first));
    if (!report.is_complete) continue;
    ++count;
    noise_c = report.noise_c;
    sigmas.push_back(report.sigma_dps);
    if (!report.is_told) continue;
    ++told;
    fastest_dps = std::max(fastest_dps, std::abs(report.rate_dps));
  }
  std::sort(sigmas.begin(), sigmas.end());
  fmt::print(
      "both together, {} first: {} of {} windows told, fastest {:.0f} deg/s, unexplained {:.2f} K, median "
      "sigma "
      "{:.2f} deg/s\n",
      first == 0 ? "even" : "odd", told, count, fastest_dps, noise_c,
      sigmas.empty() ? 0.0 : sigmas[sigmas.size() / 2]);
}

void tell_halves(const std::vector<wire::CameraMessage>& messages, double period_s, const Speeds& speeds,
                 unsigned first, const char* name) {
  likelihood::PixelErrors errors;
  std::vector<std::array<HalfLines, 2>> seen(messages.size());
  for (std::size_t i = 0; i < messages.size(); ++i)
    for (const unsigned parity : {0U, 1U}) errors.clean(messages[i].frame, parity, seen[i][parity]);
  likelihood::CameraRate rate({}, 2);
  const double speed_dps = 55.0 / 32.0 / (0.5 * period_s);
  int agree = 0, told = 0, count = 0;
  double squares = 0.0;
  for (std::size_t i = 0; i < messages.size(); ++i) {
    const auto report = rate.add(timed(messages[i], i, period_s, first));
    if (i + 1 < halves || !report.is_complete) continue;
    const double noise_variance = report.noise_c * report.noise_c;
    std::array<Speeds::Found, 2> found;
    for (const unsigned parity : {0U, 1U})
      found[parity] =
          speeds.find(parity, {&seen[i - 2][parity], &seen[i - 1][parity], &seen[i][parity]}, noise_variance);
    const double sigma_dps = speed_dps * std::hypot(found[0].sigma, found[1].sigma);
    const double differ_dps = speed_dps * std::abs(found[0].speed - found[1].speed);
    ++count;
    if (speed_dps * std::max(found[0].sigma, found[1].sigma) >= told_sigma_dps) continue;
    ++told;
    agree += differ_dps <= 2.0 * sigma_dps ? 1 : 0;
    squares += (differ_dps / sigma_dps) * (differ_dps / sigma_dps);
  }
  fmt::print(
      "{}: {} windows, both told in {}; they agree within two combined sigmas in {:.1f} % of these "
      "(mean square {:.2f})\n",
      name, count, told, 100.0 * agree / std::max(1, told), squares / std::max(1, told));
}

}  // namespace
}  // namespace thermorig::bench

int main(int count, char** arguments) {
  using namespace thermorig;
  const double rate_hz = count == 3 ? std::strtod(arguments[2], nullptr) : 0.0;
  if (!(rate_hz > 0.0)) {
    fmt::print(stderr, "usage: halves_alone CAPTURE FRAMES_A_SECOND\n");
    return 2;
  }
  std::ifstream file(arguments[1], std::ios::binary);
  const std::vector<char> read{std::istreambuf_iterator<char>(file), {}};
  const std::vector<std::uint8_t> bytes(read.begin(), read.end());
  wire::CameraScanner scanner;
  std::vector<wire::CameraMessage> messages;
  scanner.push(bytes, messages);
  fmt::print("{} frames\n", messages.size());
  if (messages.size() < bench::halves) return 1;
  const bench::Speeds speeds;
  for (const unsigned first : {0U, 1U}) bench::tell_estimator(messages, 1.0 / rate_hz, first);
  bench::tell_halves(messages, 1.0 / rate_hz, speeds, 0, "forward");
  std::reverse(messages.begin(), messages.end());
  bench::tell_halves(messages, 1.0 / rate_hz, speeds, 1, "reversed");
  return 0;
}

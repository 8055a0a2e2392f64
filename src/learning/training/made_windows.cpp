// SPDX-License-Identifier: MIT
#include "made_windows.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace thermorig::training {

namespace {

constexpr std::uint64_t steps_a_round = 32;  // between two times that something new is made
constexpr std::uint64_t places_a_round = 8;
constexpr std::uint64_t windows_a_round = 192;
constexpr std::uint64_t rounds_a_block = 8;  // of textures
constexpr double period_s = 0.125;           // between frames; a network speaks in degrees a period

/// About normal, deviation 1, from one number: noise of a pixel need not be better.
class QuickNoise {
 public:
  explicit QuickNoise(Draw& draw) : draw_(draw) {}
  float operator()() {
    const std::uint64_t bits = draw_.bits();
    const auto sum = static_cast<std::int32_t>((bits & 0xFFFFU) + (bits >> 16U & 0xFFFFU) +
                                               (bits >> 32U & 0xFFFFU) + (bits >> 48U));
    return static_cast<float>(sum - 2 * 0xFFFF) * (1.7320508F / 65536.0F);
  }

 private:
  Draw& draw_;
};

/// What the axis does while a window is seen, half by half.
struct Motion {
  static constexpr std::size_t most_halves = 2 * network::max_frames;
  std::array<double, most_halves> rate_dps{};
  std::size_t halves;
  double half_s;
  double heading_deg;

  Motion(Draw& draw, int frames, bool half_frames)
      : halves(static_cast<std::size_t>(half_frames ? frames + 1 : 2 * frames)),
        half_s(half_frames ? period_s : 0.5 * period_s),
        heading_deg(draw.uniform(0.0, 360.0)) {
    const double middle_dps = draw.happens(0.1) ? 15.0 * draw.normal() : draw.uniform(-215.0, 215.0);
    const double acceleration = draw.happens(0.25) ? 150.0 * draw.normal() : 0.0;  // deg/s^2
    const double unsteady = draw.happens(0.5) ? 0.012 * draw.normal() : 0.003;
    for (std::size_t half = 0; half < halves; ++half) {
      const double from_middle_s =
          (static_cast<double>(half) - 0.5 * static_cast<double>(halves - 1)) * half_s;
      rate_dps[half] = (middle_dps + acceleration * from_middle_s) * (1.0 + unsteady * draw.normal()) +
                       0.2 * draw.normal();
    }
  }

  /// Which half a frame begins with; its other one comes next.
  std::size_t first_half(std::size_t frame) const { return half_s == period_s ? frame : 2 * frame; }

  /// Mean over the frames of what each was exposed to.
  double mean_dps(std::size_t frames) const {
    double sum = 0.0;
    for (std::size_t frame = 0; frame < frames; ++frame)
      sum += 0.5 * (rate_dps[first_half(frame)] + rate_dps[first_half(frame) + 1]);
    return sum / static_cast<double>(frames);
  }
};

/// The pixels of each half, of a chess pattern: (halves, 24, 32), those of the other colour untouched.
using Halves = std::vector<float>;

void see(const MadePanorama& panorama, const MadeCamera& camera, const Motion& motion, bool odd_first,
         Draw& draw, Halves& halves_c) {
  QuickNoise noise(draw);
  double heading_deg = motion.heading_deg;
  for (std::size_t half = 0; half < motion.halves; ++half) {
    const double rate_dps = motion.rate_dps[half], swept_deg = rate_dps * motion.half_s;
    const double lag = camera.lag_s / motion.half_s;
    const double middle_deg = heading_deg + 0.5 * swept_deg - rate_dps * camera.lag_s;
    heading_deg += swept_deg;
    const auto middle = static_cast<float>(middle_deg / MadePanorama::column_deg);
    const double width_deg = std::hypot(swept_deg * std::sqrt(1.0 + 12.0 * lag * lag), 0.5);
    const auto reach = static_cast<float>(0.5 * width_deg / MadePanorama::column_deg);
    const auto offset_c = static_cast<float>(camera.half_offset_c * draw.normal());
    const std::size_t colour = (half + (odd_first ? 1U : 0U)) % 2;
    float* const out = halves_c.data() + half * frame_pixels;
    for (std::size_t y = 0; y < frame_rows; ++y)
      for (std::size_t x = (y + colour) % 2; x < frame_columns; x += 2) {
        const std::size_t pixel = y * frame_columns + x;
        const float at = middle + camera.column[pixel];
        out[pixel] = panorama.mean(camera.row[pixel], at - reach, at + reach) + camera.pattern_c[pixel] +
                     camera.noise_c[pixel] * noise() + offset_c;
      }
  }
}

/// A frame of the window: each pixel from that of its two halves which has it.
void join(const Halves& halves_c, const Motion& motion, std::size_t frame, bool odd_first,
          std::span<float> temp_c) {
  const std::size_t first = motion.first_half(frame);
  for (std::size_t y = 0; y < frame_rows; ++y)
    for (std::size_t x = 0; x < frame_columns; ++x) {
      const std::size_t colour = (x + y) % 2, of_first = (first + (odd_first ? 1U : 0U)) % 2;
      const std::size_t half = colour == of_first ? first : first + 1;
      temp_c[y * frame_columns + x] = halves_c[half * frame_pixels + y * frame_columns + x];
    }
}

}  // namespace

MadeWindows::MadeWindows(const MadeRooms& rooms, const network::Shape& shape, std::uint64_t seed,
                         std::uint64_t step, network::Workers& workers)
    : rooms_(rooms),
      shape_(shape),
      seed_(seed),
      step_(step),
      workers_(workers),
      rounds_kept_(static_cast<std::uint64_t>(rooms.rounds_kept)),
      made_(round_of(step)),
      places_(rounds_kept_ * places_a_round),
      frames_(rounds_kept_ * windows_a_round * shape.inputs()),
      label_(rounds_kept_ * windows_a_round),
      gyro_(label_.size()) {
  const std::uint64_t now = made_;
  for (std::uint64_t round = now - 2 * rounds_kept_ + 1; round < now - rounds_kept_ + 1; ++round)
    make_places(round);
  for (std::uint64_t round = now - rounds_kept_ + 1; round <= now; ++round) make_round(round);
}

MadeWindows::~MadeWindows() = default;

/// The first steps look at windows that were made before, and these at places before them.
std::uint64_t MadeWindows::round_of(std::uint64_t step) const {
  return step / steps_a_round + 2 * rounds_kept_;
}

/// Calls `work` with 0 .. count - 1, each once.
template <class Work>
void MadeWindows::share_out(std::uint64_t count, Work work) {
  std::atomic<std::uint64_t> next = 0;
  workers_.run([&](int) {
    for (std::uint64_t i = next++; i < count; i = next++) work(i);
  });
}

void MadeWindows::make_round(std::uint64_t round) {
  make_places(round);
  make_windows(round);
}

const std::vector<MadePanorama::Values>& MadeWindows::textures_of(std::uint64_t round) {
  if (const std::uint64_t block = round / rounds_a_block; block != texture_block_) {
    textures_ = MadePanorama::textures(seed_, block);
    texture_block_ = block;
  }
  return textures_;
}

void MadeWindows::make_places(std::uint64_t round) {
  const auto& textures = textures_of(round);
  share_out(places_a_round, [&](std::uint64_t i) {
    const std::uint64_t number = round * places_a_round + i;
    Draw draw(seed_, "room", number);
    MadePanorama panorama(draw, textures, rooms_.view.width_deg);
    places_[number % places_.size()] =
        std::make_unique<Place>(Place{std::move(panorama), MadeCamera(draw, rooms_.view)});
  });
}

void MadeWindows::make_windows(std::uint64_t round) {
  share_out(windows_a_round, [&](std::uint64_t i) { make_window(round * windows_a_round + i); });
}

void MadeWindows::make_window(std::uint64_t number) {
  Draw draw(seed_, "made window", number);
  // Counted from the oldest place on, so that it does not matter where in the ring that is.
  const std::uint64_t newest = (number / windows_a_round + 1) * places_a_round - 1;
  const Place& place = *places_[(newest - draw.below(places_.size())) % places_.size()];
  const auto frames = static_cast<std::size_t>(shape_.frames);
  const Motion motion(draw, shape_.frames, rooms_.view.half_frames);
  const bool odd_first = draw.happens(0.5);
  Halves halves_c(motion.halves * frame_pixels);
  see(place.panorama, place.camera, motion, odd_first, draw, halves_c);

  const std::size_t slot = number % label_.size();
  const std::span<float> window = std::span(frames_).subspan(slot * shape_.inputs(), shape_.inputs());
  std::array<float, frame_pixels> temp_c;
  for (std::size_t frame = 0; frame < frames; ++frame) {
    join(halves_c, motion, frame, odd_first, temp_c);
    network::prepare_frame(temp_c, shape_, {}, window.subspan(frame * shape_.pixels(), shape_.pixels()));
  }
  network::scale_window(window, shape_);
  const network::Scaling scaling = network::scaling_by_window();
  label_[slot] = static_cast<float>(motion.mean_dps(frames)) / scaling.speed_scale_dps(period_s);
  gyro_[slot] = label_[slot] + static_cast<float>(network::gate_gyro_sigma * draw.normal());
}

void MadeWindows::add_to(BatchBuffer& batch, std::size_t windows) {
  for (const std::uint64_t round = round_of(step_); made_ < round;) make_round(++made_);
  Draw draw(seed_, "made order", step_);
  for (std::size_t i = 0; i < windows; ++i) {
    const std::uint64_t slot = draw.below(label_.size());
    batch.add({frames_.data() + slot * shape_.inputs(), label_[slot], gyro_[slot]},
              network::Turn(draw.turn(network::Turn::all)));
  }
  ++step_;
}

}  // namespace thermorig::training

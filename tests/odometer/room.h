// SPDX-License-Identifier: MIT
#pragma once

#include <functional>
#include <vector>

#include "thermorig/core/sample.h"
#include "thermorig/estimators/odometer/map.h"

namespace thermorig::odometer {

/// A camera and a gyro on a shaft that turns as one likes, in a room of smooth random temperatures. Its own
/// optics and noise: nothing of the product's simulation.
struct Room {
  double duration_s = 60.0;
  std::function<double(double)> angle_deg = [](double) { return 0.0; };  // of the shaft at a time
  double bias_dps = 4.0;
  double scale = 1.01;
  double latency_s = 0.004;  // by which the camera saw earlier than its stamps say
  double noise_k = 0.5, gyro_noise_dps = 0.05;
  double contrast_k = 0.8;
  unsigned walls = 7;     // another number: another room
  unsigned noise = 11;    // of the devices
  double wider = 0.0;     // the lens, by this share
  double rolling = 0.0;   // rows are exposed over so much of a period: 1 from the first on, -1 from the last
  double roll_deg = 0.0;  // of the camera about its optical axis
};

/// What came with one frame.
struct Seen {
  TimedFrame frame;
  std::vector<TimedGyro> gyro;
};

std::vector<Seen> seen_in(const Room& room);

/// In which order its rows are exposed.
RowOrder rows_of(const Room& room);

/// To and fro over `reach_deg`, about `rate_dps` at most, never at the same speed for long.
std::function<double(double)> to_and_fro(double reach_deg, double rate_dps);

/// The same room, where the shaft rests for a while, from a time on.
Room with_rest(Room room, double from_s, double rest_s);

/// The same room, where the shaft turns on at one speed from a time on.
Room with_steady_speed(Room room, double from_s, double rate_dps);

/// From a time on the walls show, by a share of 0 to 1, what those of another room do.
void change_walls(Room room, double from_s, float share, std::vector<Seen>& all);

/// Someone who walks around the rig, 14 degrees wide and 6 K warmer than the walls.
void let_walk(const Room& room, double rate_dps, std::vector<Seen>& all, double from_s = 0.25);

/// What was seen between two times is taken for exposed a frame's period earlier.
void make_early(std::vector<Seen>& all, double from_s, double until_s);

/// A room of which nothing is special, seen to and fro at up to 60 deg/s.
Room turning_room(double duration_s = 70.0);

/// Walls that show little, seen to and fro at up to 120 deg/s.
Room faint_room(double duration_s, double contrast_k);

}  // namespace thermorig::odometer

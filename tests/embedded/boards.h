// SPDX-License-Identifier: MIT
#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <string>
#include <vector>

#include "thermorig/network/embedded/c_source.h"
#include "thermorig/network/estimator.h"

namespace thermorig::tests {

/// deg/s, as the exported C gives it.
struct Speeds {
  float fusion_dps = 0.0F, thermal_dps = 0.0F, gain = 0.0F;
};

/// What a run of exported C printed.
struct BoardRun {
  std::string failure;  // what went wrong, empty: nothing
  std::size_t state_bytes = 0;
  std::vector<Speeds> windows;
  std::vector<Speeds> first_again;  // the first window, by the function that takes one at once
  std::uint64_t instructions = 0, stack_bytes = 0;  // of a window, on a board that counts them
  std::uint64_t flash_bytes = 0;                    // code and constants of the network, with Board::object
};

/// How C becomes a program, and how that is run.
struct Board {
  std::string compiler;  // command and options
  std::string runner;    // put before the program's name; empty: it runs as it is
  std::string
      object;  // command and options that compile the network alone; empty: its size is of no interest
};

/// A core, as the compiler's options name it, and its board in QEMU.
struct Core {
  const char* name;
  const char* options;
  const char* machine;
};

// The M0+ program runs on the M3's board: QEMU has no MPS2 with an M0+, and an M3 runs all that an M0+ does.
inline constexpr std::array<Core, 3> cores{
    {{"Cortex-M4F", "-mcpu=cortex-m4 -mfloat-abi=hard -mfpu=fpv4-sp-d16", "mps2-an386"},
     {"Cortex-M3", "-mcpu=cortex-m3 -mfloat-abi=soft", "mps2-an385"},
     {"Cortex-M0+", "-mcpu=cortex-m0plus -mfloat-abi=soft", "mps2-an385"}}};

/// It counts instructions and stack, and gives up after `timeout_s`.
Board board_of(const Core& core, int timeout_s = 120);

inline constexpr const char* strict_c99 =
    " -std=c99 -O2 -Wall -Wextra -Wconversion -Wshadow -Wundef -Wdouble-promotion -Werror -pedantic";
inline constexpr int frames_to_push = 9;

/// Writes the source into a folder of its own, compiles it with board_main.c and runs it over
/// `frames_to_push` frames that a generator makes.
BoardRun run_on(const Board& board, const embedded::CSource& source, int frames);

/// The same frames through network::prepare_frame and network::Estimator.
std::vector<Speeds> expected_speeds(const model::Model& model);

/// First weights of a network, made a little larger, with a scaling that suits the generator's frames.
model::Model random_model(const network::Shape& shape, std::uint64_t seed);

/// Largest difference of any two speeds (divided by the label scale) and gains; infinite where the numbers of
/// windows differ.
float largest_difference(const std::vector<Speeds>& one, const std::vector<Speeds>& other, float scale_dps);

/// Is there such a command on this machine?
bool has_command(const std::string& name);

}  // namespace thermorig::tests

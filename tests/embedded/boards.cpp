// SPDX-License-Identifier: MIT
#include "boards.h"
#include "support/file_text.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <deque>
#include <fstream>
#include <limits>
#include <sstream>

namespace thermorig::tests {

namespace {

constexpr std::size_t frame_size = 24 * 32;

/// A folder that goes with the test.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "thermorig-c99-XXXXXX").string();
    if (mkdtemp(name.data()) == nullptr) std::abort();
    path_ = name;
  }
  ~Folder() {
    std::error_code ignored;
    std::filesystem::remove_all(path_, ignored);
  }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

/// Standard output and error of a command are in `out`; false if it failed.
bool succeeded(const std::string& command, const std::filesystem::path& out) {
  return std::system((command + " >" + out.string() + " 2>&1").c_str()) == 0;
}

BoardRun parsed(const std::string& text) {
  BoardRun run;
  std::istringstream words(text);
  std::string word;
  bool ended = false;
  while (!ended && words >> word) {
    Speeds speeds;
    if (word == "state") words >> run.state_bytes;
    if (word == "took" && run.first_again.empty()) words >> run.instructions >> run.stack_bytes;
    const bool again = word == "again";
    if ((again || word == "window") && words >> speeds.fusion_dps >> speeds.thermal_dps >> speeds.gain)
      (again ? run.first_again : run.windows).push_back(speeds);
    ended = word == "end";
  }
  if (!ended) run.failure = "did not come to its end: " + text;
  return run;
}

/// Code, constants and initialised data, from the table that `size` prints.
std::uint64_t flash_of(const std::string& table) {
  std::istringstream lines(table);
  std::string heading;
  std::uint64_t text = 0, data = 0;
  std::getline(lines, heading);
  lines >> text >> data;
  return text + data;
}

/// Of the source file of that name, without its libraries.
std::uint64_t compiled_flash(const Board& board, const std::filesystem::path& folder,
                             const std::string& name) {
  const std::filesystem::path out = folder / "out.txt";
  const std::string size = fmt::format("cd {} && {} -c {}.c -o network.o && arm-none-eabi-size network.o",
                                       folder.string(), board.object, name);
  return succeeded(size, out) ? flash_of(file_text(out)) : 0;
}

/// As in board_main.c.
class Frames {
 public:
  float between(float least, float most) {
    state_ = state_ * 1664525U + 1013904223U;
    return least + (most - least) * (static_cast<float>(state_ >> 16) / 65536.0F);
  }
  std::vector<float> next() {
    std::vector<float> temp_c(frame_size);
    for (float& pixel : temp_c) pixel = between(10.0F, 30.0F);
    return temp_c;
  }

 private:
  std::uint32_t state_ = 1;
};

struct Prepared {
  std::vector<float> pixels;
  float gyro_dps = 0.0F;
};

Speeds speeds_of(const std::deque<Prepared>& window, const model::Model& model,
                 network::Estimator& estimator) {
  std::vector<float> frames;
  float gyro_dps = 0.0F;
  for (const Prepared& frame : window) {
    frames.insert(frames.end(), frame.pixels.begin(), frame.pixels.end());
    gyro_dps += frame.gyro_dps / static_cast<float>(window.size());
  }
  if (model.scaling.by_window) network::scale_window(frames, model.weights.shape);
  const float scale = model.scaling.speed_scale_dps(0.125);
  const network::Output output = estimator.estimate(frames, gyro_dps / scale);
  return {output.fusion * scale, output.thermal * scale, output.gain};
}

}  // namespace

Board board_of(const Core& core, int timeout_s) {
  const std::string folder = THERMORIG_SOURCE_DIR "/tests/embedded/cortex_m";
  return {
      fmt::format("arm-none-eabi-gcc{} -mthumb {} --specs=rdimon.specs -T {}/mps2.ld -DMEASURED {}/start.c",
                  strict_c99, core.options, folder, folder),
      fmt::format("timeout {} qemu-system-arm -M {} -nographic -monitor none -serial none -icount shift=0 "
                  "-semihosting-config enable=on,target=native -kernel",
                  timeout_s, core.machine),
      fmt::format("arm-none-eabi-gcc -std=c99 -O2 -mthumb {}", core.options)};
}

BoardRun run_on(const Board& board, const embedded::CSource& source, int frames) {
  const Folder folder;
  for (const embedded::SourceFile& file : source.files) std::ofstream(folder.path() / file.name) << file.text;
  const std::string header = source.files.front().name, name = header.substr(0, header.size() - 2);
  const auto out = folder.path() / "out.txt", program = folder.path() / "program";
  const std::string compile = fmt::format(
      "cd {} && {} -I. -DNETWORK_HEADER='\"{}\"' -DNETWORK_NAME={} -DFRAMES_A_WINDOW={} -DFRAMES_TO_PUSH={} "
      "{}.c {}/board_main.c -o program -lm",
      folder.path().string(), board.compiler, header, name, frames, frames_to_push, name,
      THERMORIG_SOURCE_DIR "/tests/embedded");
  if (!succeeded(compile, out)) return {.failure = compile + "\n" + file_text(out)};
  if (!succeeded(board.runner + " " + program.string(), out))
    return {.failure = "it failed: " + file_text(out)};
  BoardRun run = parsed(file_text(out));
  if (board.object.empty() || !run.failure.empty()) return run;
  run.flash_bytes = compiled_flash(board, folder.path(), name);
  return run;
}

std::vector<Speeds> expected_speeds(const model::Model& model) {
  const network::Shape& shape = model.weights.shape;
  network::Estimator estimator(model.weights);
  Frames frames;
  std::deque<Prepared> window;
  std::vector<Speeds> all;
  for (int frame = 0; frame < frames_to_push; ++frame) {
    Prepared next{std::vector<float>(shape.pixels()), frames.between(-200.0F, 200.0F)};
    network::prepare_frame(frames.next(), shape, model.scaling, next.pixels);
    window.push_back(std::move(next));
    if (window.size() > static_cast<std::size_t>(shape.frames)) window.pop_front();
    if (window.size() == static_cast<std::size_t>(shape.frames))
      all.push_back(speeds_of(window, model, estimator));
  }
  return all;
}

model::Model random_model(const network::Shape& shape, std::uint64_t seed) {
  model::Model model;
  model.weights = network::initial_weights(shape, seed);
  for (float& weight : model.weights.values) weight *= 1.5F;
  model.scaling = {.label_scale_dps = 200.0F, .temp_mean_c = 19.3F, .temp_deviation_c = 5.1F};
  model.provenance.simulated = true;
  return model;
}

float largest_difference(const std::vector<Speeds>& one, const std::vector<Speeds>& other, float scale_dps) {
  if (one.size() != other.size()) return std::numeric_limits<float>::infinity();
  float largest = 0.0F;
  for (std::size_t i = 0; i < one.size(); ++i)
    for (const float difference :
         {(one[i].fusion_dps - other[i].fusion_dps) / scale_dps,
          (one[i].thermal_dps - other[i].thermal_dps) / scale_dps, one[i].gain - other[i].gain})
      largest = std::isnan(difference) ? std::numeric_limits<float>::infinity()
                                       : std::max(largest, std::abs(difference));
  return largest;
}

bool has_command(const std::string& name) {
  return std::system(("command -v " + name + " >/dev/null 2>&1").c_str()) == 0;
}

}  // namespace thermorig::tests

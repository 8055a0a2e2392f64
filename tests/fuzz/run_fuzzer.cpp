// SPDX-License-Identifier: MIT
// Any text as a run's description, and a run's checkpoint in which bytes differ though its check sum is
// right: refused, or a checkpoint that is within what its training can have done and comes back the same.
#include <zlib.h>

#include <cstdint>
#include <cstring>
#include <nlohmann/json.hpp>
#include <string>

#include "fuzz_require.h"
#include "learning/training/checkpoint_bytes.h"
#include "learning/training/run_json.h"

namespace {

using namespace thermorig;
using test::fuzz_require;

constexpr std::size_t crc_bytes = 4;

const training::RunDescription& sound_run() {
  static const training::RunDescription run = [] {
    training::RunDescription description;
    description.config.shape = {.frames = 2, .reduction = 3, .fusion = false};
    description.config.epochs = 3;
    description.data = {{.name = "garden/1", .hash = "00ff"}};
    return description;
  }();
  return run;
}

const std::string& sound_checkpoint() {
  static const std::string bytes = [] {
    const network::Shape& shape = sound_run().config.shape;
    const std::vector<float> values(network::weight_count(shape), 0.5F);
    training::Checkpoint checkpoint;
    checkpoint.epoch = 2;
    checkpoint.weights = checkpoint.kept = {shape, values};
    checkpoint.optimiser.first = checkpoint.optimiser.second = values;
    checkpoint.epochs = {{.epoch = 1}, {.epoch = 2}};
    return training::checkpoint_bytes(checkpoint);
  }();
  return bytes;
}

/// The script changes the head and what stands behind the weights, or pieces anywhere.
std::string edited(test::FuzzScript& script) {
  std::string bytes = sound_checkpoint().substr(0, sound_checkpoint().size() - crc_bytes);
  while (!script.done() && !bytes.empty()) {
    const std::size_t from_end = script.number<std::uint16_t>();
    const std::size_t at = script.byte() % 2 == 0 ? from_end % 64 : bytes.size() - 1 - from_end % 256;
    const std::size_t removed = script.byte() % 4;
    if (at < bytes.size()) bytes.replace(at, removed, script.text(removed + script.byte() % 2));
  }
  const auto crc = static_cast<std::uint32_t>(
      crc32_z(0, reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size()));
  bytes.append(reinterpret_cast<const char*>(&crc), sizeof(crc));
  return bytes;
}

void read_checkpoint(const std::string& bytes) {
  const training::TrainingConfig& config = sound_run().config;
  const auto checkpoint = training::checkpoint_from(bytes, config);
  if (!checkpoint) return;
  fuzz_require(checkpoint->epoch >= 1 && checkpoint->epoch <= config.epochs);
  fuzz_require(checkpoint->epochs.size() == static_cast<std::size_t>(checkpoint->epoch));
  const std::string written = training::checkpoint_bytes(*checkpoint);
  const auto again = training::checkpoint_from(written, config);
  fuzz_require(again && training::checkpoint_bytes(*again) == written);
}

void read_description(const std::string& text) {
  static const nlohmann::json now = training::to_json(sound_run());
  const auto then = training::description_from(text);
  if (!then) return;
  const std::string differences = training::differences(*then, now);
  fuzz_require(!differences.empty() ||
               (then->at("settings") == now["settings"] && then->at("data") == now["data"]));
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static const std::string sound = training::to_json(sound_run()).dump();
  read_description({reinterpret_cast<const char*>(data), size});
  read_description(test::spliced(sound, data, size));
  test::FuzzScript script(data, size);
  read_checkpoint(edited(script));
  return 0;
}

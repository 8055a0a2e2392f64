// SPDX-License-Identifier: MIT
#include "facts_text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <vector>

namespace thermorig::embedded {

namespace {

constexpr std::size_t longest_comment = 100;

/// Text from outside, which anybody may have written, as a part of a comment of C: it can neither end the
/// comment nor begin a line.
std::string comment_safe(std::string_view text) {
  std::string safe;
  for (char c : text.substr(0, longest_comment)) {
    const bool harmless = c >= ' ' && c <= '~' && c != '\\' && c != '?' && c != '@';
    const bool end_or_begin =
        !safe.empty() && ((safe.back() == '*' && c == '/') || (safe.back() == '/' && c == '*'));
    if (end_or_begin) safe += ' ';
    safe += harmless ? c : '_';
  }
  return safe;
}

/// Lines of a comment.
std::string comment(const std::vector<std::string>& lines) {
  return fmt::format(" * {}", fmt::join(lines, "\n * "));
}

std::string stated(std::string_view text) {
  return text.empty() ? "not stated" : comment_safe(text);
}

std::string training_text(const model::Provenance& provenance) {
  return fmt::format("Model: made by {}, preset {}, label {}, seed {}, weights of epoch {} of {}.",
                     stated(provenance.producer), stated(provenance.preset),
                     provenance.label ? name_of(*provenance.label) : stated(""), provenance.seed,
                     provenance.epoch_kept, provenance.epochs);
}

std::string network_text(const network::Shape& shape, WeightKind kind) {
  return fmt::format("Network: Nf {}, Nr {}, {}, {} weights as {}.", shape.frames, shape.reduction,
                     shape.fusion ? "thermal and gyro" : "thermal-only", network::weight_count(shape),
                     kind == WeightKind::int8 ? "int8" : "float32");
}

void add_list(std::vector<std::string>& lines, std::string_view title,
              const std::vector<model::Provenance::Data>& data) {
  if (data.empty()) return;
  lines.push_back(fmt::format("{}, each with the SHA-256 of what was used of it:", title));
  for (const model::Provenance::Data& acquisition : data)
    lines.push_back(fmt::format("  {} {}", comment_safe(acquisition.name), comment_safe(acquisition.hash)));
}

}  // namespace

std::string facts_text(const model::Model& model, WeightKind kind) {
  const model::Provenance& provenance = model.provenance;
  std::vector<std::string> lines{
      "Rotational speed from a thermal camera and a gyro, for small boards. Written by "
      "thermorig " THERMORIG_VERSION ".",
      network_text(model.weights.shape, kind), training_text(provenance)};
  if (provenance.simulated)
    lines.emplace_back("TRAINED ON SIMULATED DATA: what it is worth on a real camera is not known.");
  lines.push_back("Licence of the training data: " + stated(provenance.data_licence) + ".");
  return comment(lines);
}

std::string data_text(const model::Provenance& provenance) {
  std::vector<std::string> lines;
  add_list(lines, "Trained on", provenance.training);
  add_list(lines, "Epoch chosen on", provenance.held_out);
  if (lines.empty()) lines.emplace_back("Training data: not stated.");
  return comment(lines);
}

}  // namespace thermorig::embedded

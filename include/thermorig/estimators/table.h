// SPDX-License-Identifier: MIT
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "thermorig/core/measurement.h"
#include "thermorig/core/profile.h"
#include "thermorig/estimators/estimator.h"
#include "thermorig/network/estimator.h"
#include "thermorig/network/model/model.h"

namespace thermorig::estimators {

class NetworkWindow;

/// What an estimator looks at.
struct Inputs {
  bool image = false;
  bool gyro = false;
  bool rest = false;  // whether the servo is told to stand still, or to move
};

/// What an estimator is made of.
struct Setup {
  int frames = 1;  // of the run's window: rates are means over so many exposures
  GyroProfile gyro;
  CameraProfile camera;
  std::shared_ptr<NetworkWindow> network;    // of the run, where it has one
  std::shared_ptr<const odometer::Map> map;  // of a run before, where there is one
};

/// An estimator that there is.
struct Entry {
  std::string_view name;   // e.g. "gyro-rest": in files, messages and on the command line
  std::string_view title;  // for people: "gyro, bias of the opening rest removed"
  Inputs inputs;
  bool needs_network = false;
  bool needs_fusion = false;  // a network that has a gate
  bool needs_sigma = false;   // a network whose gate states the sigma of its speed from the images
  bool keeps_map = false;     // that a later run can begin with
  int most_frames =
      1;  // of a window over which it finds one rate; else it finds one a frame, and says the mean
  std::span<const std::string_view> values;  // names of RateEstimate::values, at most most_estimate_values
  std::unique_ptr<Estimator> (*make)(const Setup& setup) = nullptr;
};

/// All that there are, in the order in which they are shown.
std::span<const Entry> all_entries();

std::vector<std::string> names();

/// Throws Error(bad_usage) for a name that there is not: it lists those there are, the nearest first.
const Entry& entry(std::string_view name);

/// The names of those that can run with this model, or without one.
std::vector<std::string> names_for(const std::optional<model::Model>& model);

/// How a network is run.
struct NetworkRun {
  network::Precision precision = network::Precision::fp32;
  int turned = 1;  // 8: the mean over each window's eight turns, of a network that has learnt those
};

/// Several estimators of one run.
class Bank {
 public:
  /// Without names: all that can run. Throws Error(bad_usage) for a name that there is not, and for one that
  /// needs a network, or one with fusion, that `model` is not. The model may have learnt mirror images of
  /// what this camera sends. `frames`: of the window, without a model.
  /// `map`: of a run before, with such a lens.
  Bank(std::span<const std::string> names, const std::optional<model::Model>& model,
       const RigProfile& profile, NetworkRun run = {}, int frames = 1,
       std::shared_ptr<const odometer::Map> map = nullptr);
  ~Bank();
  Bank(Bank&&) noexcept;
  Bank& operator=(Bank&&) noexcept;

  std::span<const Entry* const> entries() const;
  int frames() const;  // of the window

  /// One estimate an entry, in their order, until the next call. Allocates nothing.
  std::span<const RateEstimate> add(const Measurement& measurement);

  /// Gyro samples and frames so far that no estimator was shown, since something of them is no number.
  std::uint64_t ignored() const;

  /// That of the estimator that keeps a map; null: none does.
  const odometer::Odometer* odometer() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

}  // namespace thermorig::estimators

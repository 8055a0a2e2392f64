// SPDX-License-Identifier: MIT
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <thread>

#include "build_information.h"
#include "commands.h"
#include "frame_memory.h"
#include "general_model.h"
#include "interrupts.h"
#include "options.h"
#include "session_data.h"
#include "thermorig/core/error.h"
#include "thermorig/io/files/replaced_file.h"
#include "thermorig/io/port.h"
#include "thermorig/learning/training/run_folder.h"
#include "thermorig/learning/training/thread_pool.h"
#include "train_output.h"

namespace thermorig::app {

namespace {

namespace fs = std::filesystem;

bool same_bytes(const fs::path& one, const fs::path& other) {
  std::error_code missing;
  const auto size = fs::file_size(one, missing);
  if (missing || size != fs::file_size(other, missing) || missing) return false;
  std::ifstream first(one, std::ios::binary), second(other, std::ios::binary);
  return first && second &&
         std::equal(std::istreambuf_iterator<char>(first), {}, std::istreambuf_iterator<char>(second));
}

/// The run folder that was asked for, or the one beside the model: "model.onnx" has "model.run".
fs::path run_folder_of(const TrainOptions& options) {
  if (!options.run_folder.empty()) return options.run_folder;
  fs::path folder = options.output;
  return folder.replace_extension(".run");
}

/// May a model be written there? Not over a file, unless it is the one that a run wrote that now goes on: the
/// same bytes as `written`. Throws Error(bad_usage) for a folder.
bool is_free(const fs::path& output, const fs::path& written) {
  std::error_code hidden;
  if (fs::is_directory(output, hidden))
    throw Error(ExitCode::bad_usage, "is a folder", output.string(), "name a file: -o model.onnx");
  return !fs::exists(output, hidden) || same_bytes(output, written);
}

/// Throws Error(bad_usage) if it may not, and Error(storage) where a folder that is there takes none.
void require_free(const fs::path& output, const fs::path& written) {
  if (is_free(output, written)) {
    std::error_code hidden;
    if (!fs::is_directory(files::folder_of(output), hidden)) return;  // it will be made
    files::PartFile part(files::ReplacedFile(output, "the model"));   // hours later it would be too late
    return;
  }
  throw Error(ExitCode::bad_usage, "there is a file already, and a model is never overwritten",
              output.string(), "another name with -o, or move that one away");
}

using network::Acquisition;
using training::RunFolder;
using training::TrainingConfig;

/// The preset with what the command line changes. Throws Error(bad_usage) for what cannot be.
TrainingConfig training_config(const TrainOptions& options) {
  TrainingConfig config = training::preset(options.preset);
  config.shape.frames = options.frames.value_or(config.shape.frames);
  config.shape.reduction = options.reduction.value_or(config.shape.reduction);
  config.shape.fusion = options.fusion;
  config.epochs = options.epochs.value_or(config.epochs);
  config.batch = options.batch.value_or(config.batch);
  if (options.rate) config.adam.rate = static_cast<float>(*options.rate);
  if (options.auxiliary_thermal)
    config.loss.auxiliary_thermal = static_cast<float>(*options.auxiliary_thermal);
  if (options.label_scale_dps) config.label_scale_dps = static_cast<float>(*options.label_scale_dps);
  config.symmetries = options.symmetries.value_or(config.symmetries);
  config.choose_epoch = options.choose_epoch.value_or(config.choose_epoch);
  config.seed = options.seed;
  config.preset = training::preset_of(config);
  training::check(config);
  return config;
}

/// The camera of the sessions; none: they have several, or there is none.
std::optional<network::CameraView> view_of(const std::vector<Acquisition>& acquisitions) {
  if (acquisitions.empty()) return std::nullopt;
  const std::optional<network::CameraView> view = acquisitions.front().view;
  for (const Acquisition& acquisition : acquisitions)
    if (!view || !acquisition.view || !view->fits(*acquisition.view)) return std::nullopt;
  return view;
}

/// Can this training go on with that network?
bool goes_on(const model::Model& model, const TrainOptions& options, const TrainingConfig& config) {
  const network::Shape& shape = model.weights.shape;
  return model.scaling.by_window && config.window_scaling &&
         model.scaling.label_scale_dps == config.label_scale_dps && shape.fusion == options.fusion &&
         shape.frames == options.frames.value_or(shape.frames) &&
         shape.reduction == options.reduction.value_or(shape.reduction);
}

/// The network that was asked for. Throws Error(bad_usage) for one that this training cannot go on with.
model::Model named_beginning(const TrainOptions& options, const TrainingConfig& config,
                             const network::CameraView& view) {
  model::Model model = named_model(options.from, view.width_deg).model;
  if (goes_on(model, options, config)) return model;
  throw Error(ExitCode::bad_usage, "a training goes on only with a network of its own kind", options.from,
              "one that scales each window by itself (preset best), with the same --nf, --nr, --label-scale "
              "and --fusion or --thermal-only; or --from none");
}

void begin_with(TrainingConfig& config, const model::Model& model, const std::string& name) {
  config.shape = model.weights.shape;
  config.from = std::make_shared<training::Beginning>(
      training::Beginning{fmt::format("{}, weights {}", name, model::sum_of(model.weights)), model.weights});
}

/// What depends on the sessions: the made-up rooms beside them, and the network to begin with.
TrainingConfig completed(TrainingConfig config, const TrainOptions& options,
                         const std::vector<Acquisition>& acquisitions) {
  const std::optional<network::CameraView> view = view_of(acquisitions);
  if (options.made_rooms) {
    if (!view && !acquisitions.empty() && !options.lens_deg)
      throw Error(ExitCode::bad_usage, "the sessions have several cameras, and a made-up room is seen by one",
                  "", "--lens 55, or the sessions of one camera");
    config.made.windows = acquisitions.empty() ? config.batch : std::max(1, config.batch / 2);
    config.made.view = view.value_or(network::CameraView{});
    config.made.view.width_deg = options.lens_deg.value_or(config.made.view.width_deg);
  }
  if (options.from == "none") return config;
  if (!options.from.empty())
    begin_with(config, named_beginning(options, config, view.value_or(config.made.view)),
               fs::path(options.from).filename().string());
  else if (view)
    if (const auto general = general_model(*view); general && goes_on(*general, options, config))
      begin_with(config, *general, general_model_name);
  training::check(config);
  return config;
}

std::string producer() {
  return std::string("thermorig ") + build_information::version;
}

training::RunDescription description_of(const TrainingConfig& config, Label label,
                                        const std::vector<Acquisition>& acquisitions) {
  training::RunDescription description{
      .config = config,
      .label = label,
      .data = {},
      .instruction_set = std::string(network::name_of(network::best_instruction_set())),
      .producer = producer()};
  for (const Acquisition& acquisition : acquisitions)
    description.data.push_back({acquisition.name, acquisition.learnt_hash()});
  return description;
}

int thread_count(const TrainOptions& options) {
  return options.threads.value_or(std::clamp(static_cast<int>(std::thread::hardware_concurrency()), 1, 64));
}

/// One call of `train`: reads, trains, writes.
class Run {
 public:
  Run(const TrainOptions& options, const TrainingConfig& config)
      : options_(options),
        memory_(options.frame_memory, run_folder_of(options)),
        data_(read(config)),
        config_(completed(config, options, data_.acquisitions)),
        description_(description_of(config_, label_named(options.label), data_.acquisitions)),
        folder_(options.resume ? RunFolder::reopen(run_folder_of(options), description_)
                               : RunFolder::create(run_folder_of(options), description_)),
        output_(make_train_output(config_, options.json)) {
    training::check_data(config_, data_.acquisitions);
  }

  ExitCode run() {
    const int threads = thread_count(options_);
    output_->start({config_, description_.label, data_, memory_, run_folder_of(options_).string(),
                    description_.instruction_set, threads, epochs_before()});
    training::ThreadPool workers(threads);
    watch_interrupts();
    begin_ = io::now();
    training::TrainingResult result =
        training::train(config_, data_.acquisitions, workers, observer(), folder_.checkpoint());
    result.model.provenance.producer = producer();
    return finish(result);
  }

 private:
  /// Refused before there is a run folder.
  dataset::Acquisitions read(const TrainingConfig& config) {
    if (options_.paths.empty()) return {};
    dataset::Acquisitions data = memory_.read({.paths = options_.paths,
                                               .accept_bad = options_.accept_bad,
                                               .json = options_.json,
                                               .label = label_named(options_.label)},
                                              config.shape.pixels() * sizeof(float));
    training::check_data(config, data.acquisitions);
    return data;
  }

  int epochs_before() const { return folder_.checkpoint() ? folder_.checkpoint()->epoch : 0; }
  double elapsed_s() const { return to_s(io::now() - begin_); }

  training::Observer observer() {
    training::Observer observer;
    observer.step = [this](std::size_t step, std::size_t steps, int epoch, double loss) {
      standing_ = {epochs_before(), epoch, step, steps, loss, elapsed_s()};
      output_->step(standing_);
    };
    observer.epoch = [this](const training::EpochReport& report, const training::Checkpoint& checkpoint) {
      standing_.elapsed_s = elapsed_s();
      folder_.save(checkpoint, seconds_before_ + standing_.elapsed_s);
      output_->epoch(report, standing_);
    };
    observer.stop = [] { return interrupted(); };
    return observer;
  }

  /// In the run folder first: there it is safe, whatever became of the place that was asked for.
  void write(const model::Model& model) const {
    const bool free = is_free(options_.output, folder_.model_path());
    model::write_model(folder_.model_path(), model);
    if (!free)
      throw Error(ExitCode::storage, "another program wrote this file meanwhile; it is not overwritten",
                  options_.output.string(), "take the model from " + folder_.model_path().string());
    model::write_model(options_.output, model);
  }

  ExitCode finish(const training::TrainingResult& result) {
    TrainEnd end{.config = config_, .result = result};
    end.exit = result.stopped ? ExitCode::interrupted : ExitCode::ok;
    end.seconds = seconds_before_ + elapsed_s();
    end.labelled_by_gyro =
        std::any_of(data_.acquisitions.begin(), data_.acquisitions.end(),
                    [](const network::Acquisition& acquisition) { return acquisition.is_labelled_by_gyro; });
    training::Fits fits;
    if (result.model.provenance.epoch_kept > 0) {
      write(result.model);
      if (!data_.acquisitions.empty()) {
        fits = training::fits_of(result.model, config_, data_.acquisitions);
        end.fits = &fits;
      }
      end.model = options_.output.string();
    }
    output_->end(end);
    return end.exit;
  }

  const TrainOptions& options_;
  FrameMemory memory_;
  dataset::Acquisitions data_;
  const TrainingConfig config_;
  training::RunDescription description_;
  RunFolder folder_;
  std::unique_ptr<TrainOutput> output_;
  double seconds_before_ = folder_.seconds();
  HostTime begin_{};
  TrainStanding standing_;
};

}  // namespace

ExitCode run(const TrainOptions& options) {
  const TrainingConfig config = training_config(options);
  label_named(options.label);  // refuses before sessions are read
  if (options.paths.empty() && !options.made_rooms)
    throw Error(ExitCode::bad_usage, "train needs sessions, or --made-rooms", "",
                "thermorig train recordings -o model.onnx");
  require_free(options.output, options.resume ? run_folder_of(options) / "model.onnx" : "");
  return Run(options, config).run();
}

}  // namespace thermorig::app

// SPDX-License-Identifier: MIT
#include "study_view.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <map>
#include <set>
#include <tuple>

#include "paper_figures.h"
#include "text.h"
#include "thermorig/core/error.h"

namespace thermorig::report {
namespace {

using study::JobResult;
using study::SettingSummary;

std::uint64_t commonest_seed(std::span<const JobResult> results) {
  std::map<std::uint64_t, std::size_t> count;
  for (const JobResult& result : results) ++count[result.job.seed];
  const auto most = std::max_element(count.begin(), count.end(),
                                     [](const auto& a, const auto& b) { return a.second < b.second; });
  return most->first;
}

Setting reference_of(const std::vector<SettingSummary>& summaries) {
  const auto is_papers = [](const SettingSummary& summary) {
    return summary.frames == paper_frames && summary.reduction == paper_reduction;
  };
  auto chosen = std::find_if(summaries.begin(), summaries.end(), is_papers);
  if (chosen == summaries.end())
    chosen =
        std::max_element(summaries.begin(), summaries.end(),
                         [](const SettingSummary& a, const SettingSummary& b) { return a.folds < b.folds; });
  return {chosen->frames, chosen->reduction};
}

std::vector<std::string> baselines_in(const std::vector<JobResult>& results) {
  std::vector<std::string> names;
  std::copy_if(study::baselines().begin(), study::baselines().end(), std::back_inserter(names),
               [&](const std::string& name) {
                 return std::any_of(results.begin(), results.end(), [&](const JobResult& result) {
                   return result.evaluation.errors[name].windows > 0;
                 });
               });
  return names;
}

StudyView view_of(std::vector<JobResult> results) {
  std::sort(results.begin(), results.end(),
            [](const JobResult& a, const JobResult& b) { return a.job < b.job; });
  const auto same_job = [](const JobResult& a, const JobResult& b) { return a.job == b.job; };
  results.erase(std::unique(results.begin(), results.end(), same_job), results.end());
  StudyView view;
  const study::Job& first = results.front().job;
  view.label_scale_dps = results.front().label_scale_dps;
  view.label = first.label;
  view.preset = first.preset, view.data_hash = first.data_hash;
  view.epochs = first.epochs, view.history = first.history, view.settings_text = first.settings;
  std::set<std::string> folds;
  std::set<std::uint64_t> seeds;
  for (const JobResult& result : results) {
    folds.insert(result.job.test);
    seeds.insert(result.job.seed);
    view.simulated = view.simulated || result.simulated;
  }
  view.folds.assign(folds.begin(), folds.end());
  view.seeds.assign(seeds.begin(), seeds.end());
  view.table_seed = commonest_seed(results);
  view.baselines = baselines_in(results);
  view.estimators = {std::string(study::thermal_name), std::string(study::fusion_name)};
  view.estimators.insert(view.estimators.end(), view.baselines.begin(), view.baselines.end());
  view.summaries = study::summarise(results);
  view.reference = reference_of(view.summaries);
  view.results = std::move(results);
  return view;
}

std::vector<Setting> sweep_of(const StudyView& view, const std::function<bool(const Setting&)>& belongs) {
  std::set<Setting> settings;
  for (const PaperRow& row : paper_rows) settings.insert({row.frames, row.reduction});
  for (const SettingSummary& summary : view.summaries) settings.insert({summary.frames, summary.reduction});
  std::vector<Setting> chosen;
  std::copy_if(settings.begin(), settings.end(), std::back_inserter(chosen), belongs);
  return chosen;
}

}  // namespace

std::string StudyView::reference_text() const {
  return setting_text(reference.frames, reference.reduction);
}

std::string StudyView::ours() const {
  return simulated ? "ours, SIMULATED rig" : "ours, real data";
}

std::vector<Setting> StudyView::frame_sweep() const {
  return sweep_of(*this, [&](const Setting& setting) { return setting.reduction == reference.reduction; });
}

std::vector<Setting> StudyView::reduction_sweep() const {
  return sweep_of(*this, [&](const Setting& setting) { return setting.frames == reference.frames; });
}

std::vector<Setting> StudyView::settings() const {
  return sweep_of(*this, [&](const Setting& setting) {
    return setting.reduction == reference.reduction || setting.frames == reference.frames;
  });
}

const SettingSummary* StudyView::find(Setting setting, bool fusion, std::uint64_t seed) const {
  const auto found = std::find_if(summaries.begin(), summaries.end(), [&](const SettingSummary& summary) {
    return summary.frames == setting.frames && summary.reduction == setting.reduction &&
           summary.fusion == fusion && summary.seed == seed;
  });
  return found == summaries.end() ? nullptr : &*found;
}

const SettingSummary* StudyView::find_any(Setting setting) const {
  const SettingSummary* thermal = find(setting, false);
  const SettingSummary* fusion = find(setting, true);
  if (thermal == nullptr || fusion == nullptr) return thermal == nullptr ? fusion : thermal;
  return thermal->folds > fusion->folds ? thermal : fusion;
}

std::vector<const JobResult*> StudyView::jobs(Setting setting, bool fusion, std::uint64_t seed) const {
  std::vector<const JobResult*> found;
  for (const JobResult& result : results)
    if (result.job.frames == setting.frames && result.job.reduction == setting.reduction &&
        result.job.fusion == fusion && result.job.seed == seed)
      found.push_back(&result);
  std::sort(found.begin(), found.end(), [](const JobResult* a, const JobResult* b) {
    return std::tie(a->job.test, a->job.test_hash) < std::tie(b->job.test, b->job.test_hash);
  });
  return found;
}

const JobResult* StudyView::job(Setting setting, bool fusion, const std::string& fold) const {
  for (const JobResult* result : jobs(setting, fusion))
    if (result->job.test == fold) return result;
  return nullptr;
}

const JobResult* StudyView::job_of(std::string_view estimator, const std::string& fold) const {
  if (estimator == study::thermal_name) return job(reference, false, fold);
  const JobResult* fused = job(reference, true, fold);
  return fused != nullptr || estimator == study::fusion_name ? fused : job(reference, false, fold);
}

std::string StudyView::folds_text(const SettingSummary& summary) const {
  return fmt::format("{} of {} folds", summary.folds, folds.size());
}

std::vector<StudyView> views_of(std::span<const JobResult> results) {
  if (results.empty())
    throw Error(ExitCode::bad_usage, "there is no result to report", "the folder of results",
                "run the study first: thermorig evaluate --study");
  using Key = std::tuple<std::string, Label, std::string, std::string, int, int, int, double>;
  std::map<Key, std::vector<JobResult>> groups;
  for (const JobResult& result : results) {
    const study::Job& job = result.job;
    groups[Key(job.data_hash, job.label, job.preset, job.settings, job.epochs, job.history, job.engine,
               result.label_scale_dps)]
        .push_back(result);
  }
  std::vector<StudyView> views;
  for (auto& [key, group] : groups) views.push_back(view_of(std::move(group)));
  return views;
}

double rmse_of(double mse, double label_scale_dps) {
  return std::sqrt(mse) * label_scale_dps;
}

}  // namespace thermorig::report

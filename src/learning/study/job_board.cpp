// SPDX-License-Identifier: MIT
#include "job_board.h"

#include <algorithm>
#include <limits>
#include <thread>
#include <utility>

#include "job_claims.h"
#include "result_file.h"

namespace thermorig::study {

namespace {

double work_of(const Job& job) {
  network::Shape shape;
  shape.frames = job.frames;
  shape.reduction = job.reduction;
  shape.fusion = job.fusion;
  return static_cast<double>(network::multiply_adds(shape)) * job.epochs;
}

}  // namespace

JobBoard::JobBoard(const std::vector<Job>& jobs, std::size_t reused, std::filesystem::path folder,
                   const RunObserver& observer, const files::ClaimTiming& timing)
    : reused_(reused),
      folder_(std::move(folder)),
      observer_(observer),
      timing_(timing),
      begin_(std::chrono::steady_clock::now()) {
  for (const Job& job : jobs) places_.push_back({.job = job, .watch = files::ClaimWatch(timing)});
  if (observer_.started) observer_.started(progress(nullptr));
}

std::optional<TakenJob> JobBoard::take() {
  constexpr std::chrono::milliseconds pause{50};
  while (true) {
    {
      const std::lock_guard lock(mutex_);
      if (stopping_locked()) return std::nullopt;
      if (auto taken = take_any(std::chrono::steady_clock::now())) return taken;
      if (!is_any_open()) return std::nullopt;
      tell_of_holders();
    }
    std::this_thread::sleep_for(pause);
  }
}

std::optional<TakenJob> JobBoard::take_any(Time now) {
  for (std::size_t i = 0; i < places_.size(); ++i) {
    Place& place = places_[i];
    if (place.state != State::open || place.next_look > now) continue;
    if (auto claimed = claim(place, now)) return TakenJob{i, std::move(claimed)};
  }
  return std::nullopt;
}

/// Nothing where it is done meanwhile, or another program has it.
std::unique_ptr<files::BeatingClaim> JobBoard::claim(Place& place, Time now) {
  if (take_result(place)) return nullptr;
  const std::filesystem::path name = claim_name(folder_, place.job);
  place.claim = files::look_at_claim(name);
  if (!place.claim.is_free() && !files::is_stale(place.claim, place.watch, now)) {
    place.next_look = now + timing_.beat / 2;
    return nullptr;
  }
  std::optional<files::Claim> claim = files::Claim::take(name, place.claim);
  if (!claim) return nullptr;
  // Its result may have come, and its claims have gone, after the first look.
  if (take_result(place)) {
    claim->remove();
    return nullptr;
  }
  place.state = State::running;
  return std::make_unique<files::BeatingClaim>(*std::move(claim), timing_);
}

bool JobBoard::is_any_open() const {
  return std::ranges::any_of(places_, [](const Place& place) { return place.state == State::open; });
}

void JobBoard::tell_of_holders() {
  for (Place& place : places_) {
    if (place.state != State::open || place.claim.is_free() || place.told == place.claim.number) continue;
    place.told = place.claim.number;
    if (observer_.held) observer_.held(place.job, place.claim);
  }
}

/// Has another program finished it? It may have been killed before it removed its claim.
bool JobBoard::take_result(Place& place) {
  if (!find_result(folder_, place.job)) return false;
  files::remove_claim(claim_name(folder_, place.job));
  done_locked(place);
  return true;
}

void JobBoard::done_locked(Place& place) {
  place.state = State::done;
  place.share = 1.0;
  ++done_;
  if (observer_.job_done) observer_.job_done(progress(&place.job));
}

void JobBoard::epoch_done(std::size_t index, int epoch) {
  const std::lock_guard lock(mutex_);
  Place& place = places_[index];
  place.share = static_cast<double>(epoch) / place.job.epochs;
  if (observer_.epoch_done) observer_.epoch_done(progress(&place.job));
}

void JobBoard::job_done(std::size_t index) {
  const std::lock_guard lock(mutex_);
  done_locked(places_[index]);
}

void JobBoard::lost(std::size_t index) {
  const std::lock_guard lock(mutex_);
  places_[index].state = State::open;
  places_[index].share = 0.0;
}

void JobBoard::failed(const std::exception_ptr& failure) {
  const std::lock_guard lock(mutex_);
  if (!failure_) failure_ = failure;
}

bool JobBoard::stopping() {
  const std::lock_guard lock(mutex_);
  return stopping_locked();
}

bool JobBoard::stopping_locked() {
  if (!stopped_ && observer_.stop) stopped_ = observer_.stop();
  return stopped_ || failure_;
}

bool JobBoard::concluded() {
  if (failure_) std::rethrow_exception(failure_);
  return done_ == places_.size();
}

Progress JobBoard::progress(const Job* last) const {
  double all = 0.0, done = 0.0;
  for (const Place& place : places_) {
    all += work_of(place.job);
    done += work_of(place.job) * place.share;
  }
  Progress progress;
  progress.all = reused_ + places_.size();
  progress.done = reused_ + done_;
  progress.reused = reused_;
  progress.share = all > 0.0 ? done / all : 1.0;
  progress.elapsed_s = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin_).count();
  progress.eta_s = progress.share > 0.0 ? progress.elapsed_s * (1.0 - progress.share) / progress.share
                                        : std::numeric_limits<double>::quiet_NaN();
  if (last != nullptr) progress.last = description_of(*last);
  return progress;
}

}  // namespace thermorig::study

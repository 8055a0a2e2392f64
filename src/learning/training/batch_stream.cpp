// SPDX-License-Identifier: MIT
#include "batch_stream.h"

#include <algorithm>
#include <cassert>

namespace thermorig::training {

BatchStream::BatchStream(const WindowSet& set, const EpochPlan& plan, std::size_t windows_a_batch,
                         network::Workers& workers)
    : set_(set),
      plan_(plan),
      windows_a_batch_(windows_a_batch),
      workers_(workers),
      buffer_(set),
      batches_(windows_a_batch == 0 ? 0 : (plan.order.size() + windows_a_batch - 1) / windows_a_batch) {}

void BatchStream::add_made(MadeWindows& made, std::size_t windows_a_batch, std::size_t batches) {
  made_ = &made;
  made_a_batch_ = windows_a_batch;
  if (plan_.order.empty()) batches_ = batches;
}

std::size_t BatchStream::batches() const {
  return batches_;
}

const BatchBuffer& BatchStream::next() {
  begin_ = end_;
  end_ = std::min(plan_.order.size(), begin_ + windows_a_batch_);
  buffer_.clear();
  for (std::size_t place = begin_; place < end_; ++place)
    buffer_.add(plan_.order[place], network::Turn(plan_.turns[place]));
  if (made_ != nullptr) made_->add_to(buffer_, made_a_batch_);
  assert(buffer_.size() > 0);
  if (buffer_.has_unprepared()) workers_.run(share_);
  return buffer_;
}

void BatchStream::prepare_share(int worker) {
  const auto workers = static_cast<std::size_t>(workers_.size());
  for (std::size_t place = static_cast<std::size_t>(worker); place < buffer_.size(); place += workers)
    buffer_.prepare(place);
}

}  // namespace thermorig::training

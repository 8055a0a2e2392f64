// SPDX-License-Identifier: MIT
#include "fault_disk.h"

#include <cerrno>
#include <stdexcept>

namespace thermorig::storage_test {

using files::Answer;
using files::OpenFile;

namespace {

void append_bytes(MemoryDisk& disk, OpenFile file, std::span<const std::byte> bytes) {
  if (disk.append(file, {&bytes, 1}).error_number == EBADF)
    throw std::logic_error("a logged call appends to a file that is not open");
}

Bytes joined(std::span<const std::span<const std::byte>> parts) {
  Bytes bytes;
  for (const auto part : parts) bytes.insert(bytes.end(), part.begin(), part.end());
  return bytes;
}

int error_of(FaultKind kind) {
  switch (kind) {
    case FaultKind::no_space:
      return ENOSPC;
    case FaultKind::not_supported:
      return EOPNOTSUPP;
    default:
      return EIO;
  }
}

}  // namespace

void apply(MemoryDisk& disk, const Call& call) {
  switch (call.kind) {
    case CallKind::create:
      disk.create(call.path, static_cast<unsigned>(call.number));
      return;
    case CallKind::open:
      disk.open(call.path);
      return;
    case CallKind::append:
      append_bytes(disk, call.file, call.bytes);
      return;
    case CallKind::sync:
      disk.sync(call.file);
      return;
    case CallKind::reserve:
      disk.reserve(call.file, call.number);
      return;
    case CallKind::truncate:
      disk.truncate(call.file, call.number);
      return;
    case CallKind::close:
      disk.close(call.file);
      return;
    case CallKind::lock:
      disk.lock(call.file, files::Disk::Wait::no);
      return;
    case CallKind::rename:
      disk.rename(call.path, call.other_path);
      return;
    case CallKind::rename_to_new:
      disk.rename_to_new(call.path, call.other_path);
      return;
    case CallKind::link:
      disk.link(call.path, call.other_path);
      return;
    case CallKind::remove:
      disk.remove(call.path);
      return;
    case CallKind::make_folder:
      disk.make_folder(call.path);
      return;
    case CallKind::remove_folder:
      disk.remove_folder(call.path);
      return;
    case CallKind::sync_folder:
      disk.sync_folder(call.path);
      return;
    case CallKind::read:
    case CallKind::size:
    case CallKind::look:
    case CallKind::list:
    case CallKind::free_bytes:
      return;
  }
}

bool can_fail(CallKind call, FaultKind fault) {
  using enum CallKind;
  switch (fault) {
    case FaultKind::io_error:
      return call != lock;
    case FaultKind::no_space:
      return call == create || call == append || call == sync || call == reserve || call == rename ||
             call == rename_to_new || call == make_folder;
    case FaultKind::short_write:
      return call == append;
    case FaultKind::done_but_error:
      return call == close || call == truncate || call == rename || call == rename_to_new || call == remove ||
             call == sync_folder || call == create;
    case FaultKind::not_supported:
      return call == reserve || call == lock || call == free_bytes;
  }
  return false;
}

int FaultDisk::with_fault(Call call, const Make& make) {
  const std::size_t index = count_++;
  if (clock_ != nullptr) call.time = *clock_;
  const CallKind kind = call.kind;
  if (keeps_) calls_.push_back(std::move(call));
  const bool is_hit = fault_ && can_fail(kind, fault_->kind) &&
                      (index == fault_->call || (fault_->lasting && index > fault_->call));
  if (!is_hit) return make({});
  if (!hit_) {
    hit_ = true;
    kind_hit_ = kind;
    if (clock_ != nullptr) time_hit_ = *clock_;
  }
  switch (fault_->kind) {
    case FaultKind::short_write:
      return make(FaultKind::short_write);
    case FaultKind::done_but_error:
      make({});
      return EIO;
    default:
      if (kind == CallKind::close) make({});  // closed all the same
      if (kind == CallKind::sync) make(FaultKind::io_error);
      return error_of(fault_->kind);
  }
}

Answer<std::size_t> FaultDisk::append(OpenFile file, std::span<const std::span<const std::byte>> parts) {
  Bytes bytes = joined(parts);
  Answer<std::size_t> answer;
  answer.error_number =
      with_fault({.kind = CallKind::append, .file = file, .bytes = keeps_ ? bytes : Bytes()},
                 [&](std::optional<FaultKind> kind) {
                   if (kind == FaultKind::short_write) bytes.resize(bytes.size() / 2);
                   const std::span<const std::byte> whole(bytes);
                   answer = disk_.append(file, {&whole, 1});
                   return answer.error_number;
                 });
  return answer;
}

int FaultDisk::sync(OpenFile file) {
  return with_fault({.kind = CallKind::sync, .file = file}, [&](std::optional<FaultKind> kind) {
    if (kind == FaultKind::io_error) {
      disk_.drop_unsynced(file);
      return EIO;
    }
    return disk_.sync(file);
  });
}

}  // namespace thermorig::storage_test

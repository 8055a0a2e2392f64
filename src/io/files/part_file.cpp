// SPDX-License-Identifier: MIT
#include "thermorig/io/files/part_file.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/io/files/process.h"

namespace thermorig::files {

std::string usual_advice(int error_number) {
  switch (error_number) {
    case ENOSPC:
    case EDQUOT:
    case EFBIG:
      return "free some space or choose another disk";
    case EACCES:
    case EPERM:
    case EROFS:
      return "choose a folder that you may write to";
    case EEXIST:
    case EISDIR:
      return "choose another name";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first, or choose another";
    default:
      return "check the disk (dmesg)";
  }
}

std::filesystem::path part_path_of(const std::filesystem::path& path) {
  return fmt::format("{}.{}.{}.part", path.string(), this_process().host, ::getpid());
}

std::optional<std::uint64_t> process_of_part(const std::filesystem::path& part,
                                             const std::filesystem::path& path) {
  constexpr std::string_view end = ".part";
  const std::string name = part.filename().string(), stem = path.filename().string() + ".";
  if (!name.starts_with(stem) || !name.ends_with(end) || name.size() <= stem.size() + end.size())
    return std::nullopt;
  std::string_view digits(name.data() + stem.size(), name.size() - stem.size() - end.size());
  const std::string host = this_process().host + ".";
  if (digits.starts_with(host)) digits.remove_prefix(host.size());
  std::uint64_t process = 0;
  const auto [at, error] = std::from_chars(digits.data(), digits.data() + digits.size(), process);
  if (error != std::errc() || at != digits.data() + digits.size()) return std::nullopt;
  return process;
}

bool remove_unless_held(const std::filesystem::path& part, Disk& disk) {
  const auto opened = disk.open_to_lock(part);
  if (!opened.good()) return false;
  const ClosedOnExit file(disk, opened.value);
  return disk.size(file.get()).good() && disk.lock(file.get(), Disk::Wait::no) == 0 && disk.remove(part) == 0;
}

PartFile::PartFile(std::filesystem::path path, std::string noun, Advice advice, Disk& disk)
    : disk_(disk),
      path_(std::move(path)),
      part_path_(part_path_of(path_)),
      noun_(std::move(noun)),
      advice_(advice) {
  auto created = disk_.create(part_path_, 0644);
  // Of a program of our process number that was killed: in a container it is often the same.
  if (created.error_number == EEXIST && remove_unless_held(part_path_, disk_))
    created = disk_.create(part_path_, 0644);
  if (!created.good()) refuse("cannot create " + noun_, created.error_number, part_path_);
  file_ = created.value;
  disk_.lock(file_, Disk::Wait::no);  // tells the next of this number that it is being written
}

PartFile::~PartFile() {
  if (file_ != OpenFile::none) disk_.close(file_);
  if (!published_) disk_.remove(part_path_);
}

void PartFile::refuse(const std::string& action, int error_number, const std::filesystem::path& where) const {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(error_number)), where.string(),
              advice_(error_number));
}

void PartFile::write(std::span<const std::byte> bytes) {
  const auto written = append_all(disk_, file_, bytes);
  if (written.good()) return;
  is_whole_ = false;
  refuse(fmt::format("cannot write {} ({} bytes missing)", noun_, bytes.size() - written.value),
         written.error_number, part_path_);
}

std::uint64_t PartFile::size() const {
  const auto size = disk_.size(file_);
  if (!size.good()) refuse("cannot read back " + noun_, size.error_number, part_path_);
  return size.value;
}

void PartFile::read_back(std::uint64_t offset, std::span<std::byte> out) const {
  const auto count = disk_.read(file_, offset, out);
  if (!count.good()) refuse("cannot read back " + noun_, count.error_number, part_path_);
  if (count.value < out.size()) refuse("cannot read back " + noun_, EIO, part_path_);
}

void PartFile::sync() {
  const int error_number = disk_.sync(file_);
  is_whole_ = is_whole_ && error_number == 0;
  if (error_number != 0) refuse("cannot sync " + noun_, error_number, part_path_);
}

int PartFile::rename_unless_taken() {
  const auto taken = disk_.look(path_);
  if (!taken.good()) return taken.error_number;
  return taken.value == FileKind::missing ? disk_.rename(part_path_, path_) : EEXIST;
}

int PartFile::rename_to_new() {
  const int result = disk_.rename_to_new(part_path_, path_);
  if (result != EINVAL && result != ENOSYS) return result;
  // A file system without such a rename: a hard link refuses an existing name as well.
  const int linked = disk_.link(part_path_, path_);
  if (linked == EPERM || linked == EOPNOTSUPP || linked == ENOSYS) return rename_unless_taken();
  if (linked == 0) disk_.remove(part_path_);  // the file has its name: an older one beside it does no harm
  return linked;
}

/// The error of naming it, 0 for none. Whatever else fails is refused.
int PartFile::name_it(bool overwrite) {
  if (!is_whole_) refuse("cannot name " + noun_, EIO, path_);  // a later sync that succeeds proves nothing
  const int closed = disk_.close(std::exchange(file_, OpenFile::none));
  if (closed != 0) refuse("cannot close " + noun_, closed, part_path_);
  const int named = overwrite ? disk_.rename(part_path_, path_) : rename_to_new();
  if (named != 0) return named;
  published_ = true;
  const int synced = disk_.sync_folder(folder_of(path_));
  if (synced != 0) refuse("cannot sync the folder", synced, folder_of(path_));
  return 0;
}

void PartFile::publish(bool overwrite) {
  const int named = name_it(overwrite);
  if (named != 0) refuse("cannot name " + noun_, named, path_);
}

bool PartFile::publish_if_free() {
  const int named = name_it(false);
  if (named != 0 && named != EEXIST) refuse("cannot name " + noun_, named, path_);
  return named == 0;
}

}  // namespace thermorig::files

// SPDX-License-Identifier: MIT
#include "thermorig/io/files/part_file.h"

#include <fmt/format.h>
#include <signal.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <charconv>
#include <cstring>
#include <utility>

#include "thermorig/core/error.h"
#include "thermorig/io/files/holder.h"
#include "thermorig/io/files/replaced_file.h"

namespace thermorig::files {

namespace {

constexpr unsigned mode_of_new = 0644, mode_of_nobody_else = 0600;

/// Is there no process of that number on this machine, as far as the calling one's space goes?
bool is_unused(std::uint64_t process) {
  constexpr std::uint64_t most = 1ULL << 30U;  // the system gives at most 2^22
  if (process == 0 || process > most) return false;
  return ::kill(static_cast<pid_t>(process), 0) != 0 && errno == ESRCH;
}

}  // namespace

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
    case ENAMETOOLONG:
      return "choose a shorter name";
    case ELOOP:
      return "see where the symbolic links lead (ls -l)";
    case ENOENT:
    case ENOTDIR:
      return "create the folder first, or choose another";
    default:
      return "check the disk (dmesg)";
  }
}

std::string host_name() {
  std::array<char, 65> name{};
  if (::gethostname(name.data(), name.size()) != 0 || name[0] == '\0') return "unknown";
  std::string text = name.data();
  std::replace_if(
      text.begin(), text.end(),
      [](char c) {
        const bool letter = (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z');
        return !letter && !(c >= '0' && c <= '9') && c != '-' && c != '_' && c != '.';
      },
      '_');
  return text;
}

std::filesystem::path part_path_of(const std::filesystem::path& path) {
  return fmt::format("{}.{}.{}.part", path.string(), host_name(), ::getpid());
}

std::optional<std::filesystem::path> left_part_of(const std::filesystem::path& path) {
  constexpr std::string_view end = ".part";
  const std::string name = path.string(), host = fmt::format(".{}.", host_name());
  const std::size_t host_at = name.rfind(host);
  if (!name.ends_with(end) || host_at == std::string::npos || host_at == 0) return std::nullopt;
  const char* const digits = name.data() + host_at + host.size();
  const char* const digits_end = name.data() + name.size() - end.size();
  std::uint64_t process = 0;
  if (digits >= digits_end) return std::nullopt;
  const auto [at, error] = std::from_chars(digits, digits_end, process);
  if (error != std::errc() || at != digits_end) return std::nullopt;
  if (process != static_cast<std::uint64_t>(::getpid()) && !is_unused(process)) return std::nullopt;
  return name.substr(0, host_at);
}

bool remove_unless_held(const std::filesystem::path& part, Disk& disk) {
  const auto opened = disk.open_to_lock(part);
  if (!opened.good()) return false;
  const ClosedOnExit file(disk, opened.value);
  return disk.size(file.get()).good() && disk.lock(file.get(), Disk::Wait::no) == 0 && disk.remove(part) == 0;
}

PartFile::PartFile(std::filesystem::path path, std::string noun, Advice advice, Disk& disk, unsigned mode)
    : disk_(disk),
      path_(std::move(path)),
      part_path_(part_path_of(path_)),
      noun_(std::move(noun)),
      advice_(advice) {
  create(mode);
}

PartFile::PartFile(std::filesystem::path path, std::string noun, Advice advice, Disk& disk)
    : PartFile(std::move(path), std::move(noun), advice, disk, mode_of_new) {}

PartFile::PartFile(ReplacedFile replaced)
    : PartFile(replaced.path_, replaced.noun_, replaced.advice_, *replaced.disk_,
               replaced.exists() ? mode_of_nobody_else : mode_of_new) {
  replaced_ = std::make_unique<ReplacedFile>(std::move(replaced));
  take_access_of(*replaced_);
  reserve(replaced_->bytes());
}

PartFile::PartFile(std::filesystem::path path, const ReplacedFile& like)
    : PartFile(std::move(path), like.noun_, like.advice_, *like.disk_, mode_of_nobody_else) {
  take_access_of(like);
  reserve(like.bytes());
}

void PartFile::create(unsigned mode) {
  auto created = disk_.create(part_path_, mode);
  // Of a program of our process number that was killed: in a container it is often the same.
  if (created.error_number == EEXIST && remove_unless_held(part_path_, disk_))
    created = disk_.create(part_path_, mode);
  if (!created.good()) refuse("cannot create " + noun_, created.error_number, part_path_);
  file_ = created.value;
  disk_.lock(file_, Disk::Wait::no);  // tells the next of this number that it is being written
}

void PartFile::take_access_of(const ReplacedFile& file) {
  if (!file.file_) return;
  const int refused = disk_.copy_access(file.file_->get(), file_);
  if (refused != 0)
    throw Error(ExitCode::no_permission,
                fmt::format("the permissions of {} cannot be kept: {}", noun_, std::strerror(refused)),
                file.path_.string(), "ask its owner to do it (ls -l), or work on a copy");
}

PartFile::~PartFile() {
  if (file_ != OpenFile::none) disk_.close(file_);
  if (!published_) disk_.remove(part_path_);
}

void PartFile::refuse(const std::string& action, int error_number, const std::filesystem::path& where) const {
  throw Error(ExitCode::storage, fmt::format("{}: {}", action, std::strerror(error_number)), where.string(),
              advice_(error_number));
}

void PartFile::reserve(std::uint64_t bytes) {
  if (bytes <= reserved_) return;
  int error_number = disk_.reserve(file_, bytes);
  if (error_number == EOPNOTSUPP ||
      error_number == ENOSYS) {  // some file systems of the network and of sticks
    const auto free_bytes = disk_.free_bytes(folder_of(path_));
    error_number = free_bytes.good() && free_bytes.value < bytes ? ENOSPC : 0;
  }
  if (error_number != 0)
    refuse(fmt::format("there is no room for {} ({} bytes)", noun_, bytes), error_number, path_);
  reserved_ = bytes;
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
  // What was reserved beyond its end goes back to the disk; where it does not, room is lost and nothing else.
  if (const auto bytes = disk_.size(file_); bytes.good() && bytes.value < reserved_)
    disk_.truncate(file_, bytes.value);
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

/// Takes the place of what is to be replaced. EEXIST: that is not what it was.
int PartFile::replace() {
  const FileLock folder(folder_of(path_), Disk::Wait::yes, disk_);  // from the look to the rename
  if (!replaced_->try_lock() || !replaced_->is_unchanged()) return EEXIST;
  return disk_.rename(part_path_, path_);
}

bool PartFile::publish_unless_taken() {
  if (!is_whole_) refuse("cannot name " + noun_, EIO, path_);  // a later sync that succeeds proves nothing
  if (replaced_) take_access_of(*replaced_);                   // somebody may have changed it meanwhile
  const int closed = disk_.close(std::exchange(file_, OpenFile::none));
  if (closed != 0) refuse("cannot close " + noun_, closed, part_path_);
  const int named = replaced_ && replaced_->exists() ? replace() : rename_to_new();
  if (named == EEXIST) return false;
  if (named != 0) refuse("cannot name " + noun_, named, path_);
  published_ = true;
  const int synced = disk_.sync_folder(folder_of(path_));
  if (synced != 0) refuse("cannot sync the folder", synced, folder_of(path_));
  return true;
}

void PartFile::publish() {
  if (publish_unless_taken()) return;
  if (!replaced_) refuse("cannot name " + noun_, EEXIST, path_);
  throw Error(ExitCode::no_permission,
              fmt::format("{} was changed meanwhile, or is being written, by {}", noun_, holder_of(path_)),
              path_.string(), "it is as that program left it: try again");
}

}  // namespace thermorig::files

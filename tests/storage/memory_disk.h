// SPDX-License-Identifier: MIT
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "thermorig/io/files/disk.h"

namespace thermorig::storage_test {

using Bytes = std::vector<std::byte>;

/// What lies on a disk, and nothing else: files and folders by their paths.
struct DiskImage {
  std::map<std::string, std::shared_ptr<const Bytes>> files;
  std::set<std::string> folders;

  /// Equal images have equal numbers; others practically never.
  std::uint64_t hash() const;
};

/// What becomes of what was not synced when the power goes. Synced bytes and names always stay.
struct PowerLoss {
  enum class Data : std::uint8_t {
    lost,          // none of it reaches the disk
    zeros,         // the length does, the bytes do not
    some_sectors,  // each sector of 512 bytes does or does not; what does not is zero
    garbage,       // each sector does or does not; what does not is what was on the disk before
    torn,          // everything up to some byte
    kept           // all of it does
  };
  enum class Names : std::uint8_t { lost, kept, some };
  Data data = Data::lost;
  Names names = Names::lost;
};

/// A disk in memory that knows what programs see, what a loss of power leaves, and what a folder says. A
/// file's bytes are durable after sync() of the file, its name after sync_folder() of its folder.
class MemoryDisk : public files::Disk {
 public:
  explicit MemoryDisk(const DiskImage& image = {}, std::uint64_t capacity = std::uint64_t{1} << 40U);

  using Path = std::filesystem::path;
  files::Answer<files::OpenFile> create(const Path& path, unsigned mode) override;
  files::Answer<files::OpenFile> open(const Path& path) override;
  files::Answer<std::size_t> append(files::OpenFile file,
                                    std::span<const std::span<const std::byte>> parts) override;
  files::Answer<std::size_t> read(files::OpenFile file, std::uint64_t offset,
                                  std::span<std::byte> out) override;
  files::Answer<std::uint64_t> size(files::OpenFile file) override;
  int sync(files::OpenFile file) override;
  int reserve(files::OpenFile file, std::uint64_t bytes) override;
  int truncate(files::OpenFile file, std::uint64_t bytes) override;
  int close(files::OpenFile file) override;
  int lock(files::OpenFile file, Wait wait) override;
  files::Answer<files::FileIdentity> identity(files::OpenFile file) override;
  int copy_access(files::OpenFile from, files::OpenFile to) override;
  files::Answer<files::FileKind> look(const Path& path) override;
  files::Answer<std::vector<files::FolderEntry>> list(const Path& folder) override;
  int rename(const Path& from, const Path& to) override;
  int rename_to_new(const Path& from, const Path& to) override;
  int link(const Path& from, const Path& to) override;
  int remove(const Path& file) override;
  int make_folder(const Path& folder) override;
  int remove_folder(const Path& folder) override;
  int sync_folder(const Path& folder) override;
  files::Answer<std::uint64_t> free_bytes(const Path& path) override;

  int next_open() const { return next_open_; }  // the id of the file that is opened next

  /// Who may read a file.
  unsigned mode(const Path& path) const { return at(path)->mode; }

  /// A sync that fails: what it was for is dropped, and the next sync says nothing of it.
  void drop_unsynced(files::OpenFile file);

  /// What the next process finds when this one ends now.
  DiskImage after_end() const;
  /// What is there when the power comes back. Seeded by `random` where `loss` leaves a choice.
  DiskImage after_power_loss(PowerLoss loss, std::mt19937_64& random) const;

 private:
  struct Node {
    Bytes seen, durable;
    std::vector<std::pair<std::size_t, std::size_t>> dropped;  // begin and end of what a failed sync dropped
    std::uint64_t reserved = 0;
    bool is_folder = false;
    int locked_by = -1;
    unsigned mode = 0644;
    std::int64_t changes = 0;
  };
  using NodePtr = std::shared_ptr<Node>;
  using Names = std::map<std::string, NodePtr>;
  struct NameChange {  // of one call, all or nothing
    std::string folder;
    std::vector<std::pair<std::string, NodePtr>> names;  // null: gone
  };

  NodePtr at(const Path& path) const;
  Node* open_node(files::OpenFile file);
  files::Answer<files::OpenFile> opened(const NodePtr& node);
  void change(const Path& folder, std::vector<std::pair<std::string, NodePtr>> names);
  bool has_folder_of(const Path& path) const;
  std::uint64_t used() const;
  static Bytes what_stays(const Node& node, PowerLoss::Data data, std::mt19937_64& random);

  Names seen_, durable_;
  std::vector<NameChange> unsynced_;  // of names, in their order
  std::map<int, NodePtr> open_;
  int next_open_ = 3;
  std::uint64_t capacity_;
};

}  // namespace thermorig::storage_test

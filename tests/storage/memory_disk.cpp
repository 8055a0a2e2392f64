// SPDX-License-Identifier: MIT
#include "memory_disk.h"

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace thermorig::storage_test {

namespace {

using files::Answer;
using files::FileKind;
using files::FolderEntry;
using files::OpenFile;

constexpr std::size_t sector_bytes = 512;

std::uint64_t with_word(std::uint64_t hash, std::uint64_t word) {
  hash = (hash ^ word) * 0x9E3779B97F4A7C15U;
  return hash ^ (hash >> 29U);
}

std::uint64_t hash_of(const std::byte* bytes, std::size_t size, std::uint64_t hash) {
  hash = with_word(hash, size);
  for (; size >= 8; bytes += 8, size -= 8) {
    std::uint64_t word = 0;
    std::memcpy(&word, bytes, 8);
    hash = with_word(hash, word);
  }
  std::uint64_t word = 0;
  if (size > 0) std::memcpy(&word, bytes, size);
  return with_word(hash, word);
}

std::string folder_name(const std::filesystem::path& path) {
  return files::folder_of(path).string();
}

}  // namespace

std::uint64_t DiskImage::hash() const {
  std::uint64_t hash = 1;
  const auto add = [&](const std::string& text) {
    hash = hash_of(reinterpret_cast<const std::byte*>(text.data()), text.size(), hash);
  };
  for (const auto& [path, bytes] : files) {
    add(path);
    hash = hash_of(bytes->data(), bytes->size(), hash);
  }
  for (const auto& folder : folders) add(folder);
  return hash;
}

MemoryDisk::MemoryDisk(const DiskImage& image, std::uint64_t capacity) : capacity_(capacity) {
  for (const auto& folder : image.folders) {
    seen_[folder] = std::make_shared<Node>();
    seen_[folder]->is_folder = true;
  }
  for (const auto& [path, bytes] : image.files) {
    auto node = std::make_shared<Node>();
    node->seen = node->durable = *bytes;
    seen_[path] = node;
  }
  durable_ = seen_;
}

// ---- files --------------------------------------------------------------------------------------------

MemoryDisk::NodePtr MemoryDisk::at(const Path& path) const {
  const auto found = seen_.find(path.string());
  return found == seen_.end() ? nullptr : found->second;
}

MemoryDisk::Node* MemoryDisk::open_node(OpenFile file) {
  const auto found = open_.find(static_cast<int>(file));
  return found == open_.end() ? nullptr : found->second.get();
}

Answer<OpenFile> MemoryDisk::opened(const NodePtr& node) {
  open_[next_open_] = node;
  return {static_cast<OpenFile>(next_open_++), 0};
}

bool MemoryDisk::has_folder_of(const Path& path) const {
  const auto folder = at(files::folder_of(path));
  return folder && folder->is_folder;
}

void MemoryDisk::change(const Path& folder, std::vector<std::pair<std::string, NodePtr>> names) {
  for (const auto& [name, node] : names) {
    if (node)
      seen_[name] = node;
    else
      seen_.erase(name);
  }
  unsynced_.push_back({folder.string(), std::move(names)});
}

Answer<OpenFile> MemoryDisk::create(const Path& path, unsigned mode) {
  if (at(path)) return {OpenFile::none, EEXIST};
  if (!has_folder_of(path)) return {OpenFile::none, ENOENT};
  const auto node = std::make_shared<Node>();
  node->mode = mode;
  change(files::folder_of(path), {{path.string(), node}});
  return opened(node);
}

Answer<OpenFile> MemoryDisk::open(const Path& path) {
  const auto node = at(path);
  if (!node) return {OpenFile::none, ENOENT};
  return opened(node);
}

std::uint64_t MemoryDisk::used() const {
  std::uint64_t used = 0;
  for (const auto& [name, node] : seen_) used += std::max<std::uint64_t>(node->seen.size(), node->reserved);
  return used;
}

Answer<std::size_t> MemoryDisk::append(OpenFile file, std::span<const std::span<const std::byte>> parts) {
  Node* const node = open_node(file);
  if (node == nullptr) return {0, EBADF};
  std::size_t total = 0;
  for (const auto part : parts) total += part.size();
  const std::uint64_t free_bytes = capacity_ - std::min(capacity_, used());
  const std::uint64_t room =
      std::max<std::uint64_t>(node->reserved, node->seen.size()) - node->seen.size() + free_bytes;
  std::size_t left = static_cast<std::size_t>(std::min<std::uint64_t>(room, total));
  if (left == 0 && total > 0) return {0, ENOSPC};
  ++node->changes;
  const std::size_t written = left;
  for (const auto part : parts) {
    const std::size_t count = std::min(left, part.size());
    node->seen.insert(node->seen.end(), part.begin(), part.begin() + static_cast<std::ptrdiff_t>(count));
    left -= count;
  }
  return {written, 0};
}

Answer<std::size_t> MemoryDisk::read(OpenFile file, std::uint64_t offset, std::span<std::byte> out) {
  const Node* const node = open_node(file);
  if (node == nullptr || node->is_folder) return {0, node == nullptr ? EBADF : EISDIR};
  if (offset >= node->seen.size()) return {0, 0};
  const std::size_t count = std::min<std::size_t>(out.size(), node->seen.size() - offset);
  std::copy_n(node->seen.begin() + static_cast<std::ptrdiff_t>(offset), count, out.begin());
  return {count, 0};
}

Answer<std::uint64_t> MemoryDisk::size(OpenFile file) {
  const Node* const node = open_node(file);
  if (node == nullptr) return {0, EBADF};
  return {node->seen.size(), node->is_folder ? EINVAL : 0};
}

int MemoryDisk::sync(OpenFile file) {
  Node* const node = open_node(file);
  if (node == nullptr) return EBADF;
  const std::size_t before = std::min(node->durable.size(), node->seen.size());
  node->durable.resize(before);
  node->durable.insert(node->durable.end(), node->seen.begin() + static_cast<std::ptrdiff_t>(before),
                       node->seen.end());
  for (const auto& [begin, end] : node->dropped)
    for (std::size_t i = begin; i < std::min(end, node->durable.size()); ++i) node->durable[i] = {};
  return 0;
}

void MemoryDisk::drop_unsynced(OpenFile file) {
  Node* const node = open_node(file);
  if (node != nullptr && node->durable.size() < node->seen.size())
    node->dropped.emplace_back(node->durable.size(), node->seen.size());
}

int MemoryDisk::reserve(OpenFile file, std::uint64_t bytes) {
  Node* const node = open_node(file);
  if (node == nullptr) return EBADF;
  const std::uint64_t has = std::max<std::uint64_t>(node->reserved, node->seen.size());
  if (bytes > has && bytes - has > capacity_ - std::min(capacity_, used())) return ENOSPC;
  node->reserved = std::max(node->reserved, bytes);
  return 0;
}

int MemoryDisk::truncate(OpenFile file, std::uint64_t bytes) {
  Node* const node = open_node(file);
  if (node == nullptr) return EBADF;
  node->seen.resize(bytes);
  ++node->changes;
  node->reserved = bytes;
  return 0;
}

int MemoryDisk::close(OpenFile file) {
  const auto found = open_.find(static_cast<int>(file));
  if (found == open_.end()) return EBADF;
  if (found->second->locked_by == found->first) found->second->locked_by = -1;
  open_.erase(found);
  return 0;
}

int MemoryDisk::lock(OpenFile file, Wait wait) {
  Node* const node = open_node(file);
  if (node == nullptr) return EBADF;
  const int self = static_cast<int>(file);
  // One thread alone: who would wait, waits for ever.
  if (node->locked_by >= 0 && node->locked_by != self) return wait == Wait::no ? EWOULDBLOCK : EDEADLK;
  node->locked_by = self;
  return 0;
}

Answer<files::FileIdentity> MemoryDisk::identity(OpenFile file) {
  const Node* const node = open_node(file);
  if (node == nullptr) return {{}, EBADF};
  return {{1, reinterpret_cast<std::uintptr_t>(node), static_cast<std::int64_t>(node->seen.size()),
           node->changes},
          0};
}

int MemoryDisk::copy_access(OpenFile from, OpenFile to) {
  const Node* const source = open_node(from);
  Node* const target = open_node(to);
  if (source == nullptr || target == nullptr) return EBADF;
  target->mode = source->mode;
  return 0;
}

// ---- names --------------------------------------------------------------------------------------------

Answer<FileKind> MemoryDisk::look(const Path& path) {
  const auto node = at(path);
  if (!node) return {FileKind::missing, 0};
  return {node->is_folder ? FileKind::folder : FileKind::file, 0};
}

Answer<std::vector<FolderEntry>> MemoryDisk::list(const Path& folder) {
  const auto node = at(folder);
  if (!node || !node->is_folder) return {{}, node ? ENOTDIR : ENOENT};
  Answer<std::vector<FolderEntry>> entries;
  for (const auto& [name, entry] : seen_)
    if (folder_name(name) == folder.string() && name != folder.string())
      entries.value.push_back({name, entry->is_folder ? FileKind::folder : FileKind::file});
  return entries;
}

int MemoryDisk::rename(const Path& from, const Path& to) {
  const auto node = at(from);
  if (!node) return ENOENT;
  change(files::folder_of(to), {{from.string(), nullptr}, {to.string(), node}});
  return 0;
}

int MemoryDisk::rename_to_new(const Path& from, const Path& to) {
  return at(to) ? EEXIST : rename(from, to);
}

int MemoryDisk::link(const Path& from, const Path& to) {
  const auto node = at(from);
  if (!node || at(to)) return node ? EEXIST : ENOENT;
  change(files::folder_of(to), {{to.string(), node}});
  return 0;
}

int MemoryDisk::remove(const Path& file) {
  const auto node = at(file);
  if (!node || node->is_folder) return node ? EISDIR : ENOENT;
  change(files::folder_of(file), {{file.string(), nullptr}});
  return 0;
}

int MemoryDisk::make_folder(const Path& folder) {
  if (at(folder)) return EEXIST;
  if (!has_folder_of(folder)) return ENOENT;
  const auto node = std::make_shared<Node>();
  node->is_folder = true;
  change(files::folder_of(folder), {{folder.string(), node}});
  return 0;
}

int MemoryDisk::remove_folder(const Path& folder) {
  const auto entries = list(folder);
  if (!entries.good() || !entries.value.empty()) return entries.good() ? ENOTEMPTY : entries.error_number;
  change(files::folder_of(folder), {{folder.string(), nullptr}});
  return 0;
}

int MemoryDisk::sync_folder(const Path& folder) {
  if (!at(folder)) return ENOENT;
  const auto in_it = [&](const NameChange& change) { return change.folder == folder.string(); };
  for (const NameChange& change : unsynced_) {
    if (!in_it(change)) continue;
    for (const auto& [name, node] : change.names) {
      if (node)
        durable_[name] = node;
      else
        durable_.erase(name);
    }
  }
  std::erase_if(unsynced_, in_it);
  return 0;
}

Answer<std::uint64_t> MemoryDisk::free_bytes(const Path&) {
  return {capacity_ - std::min(capacity_, used()), 0};
}

// ---- ends ---------------------------------------------------------------------------------------------

DiskImage MemoryDisk::after_end() const {
  DiskImage image;
  for (const auto& [name, node] : seen_) {
    if (node->is_folder)
      image.folders.insert(name);
    else
      image.files[name] = std::make_shared<const Bytes>(node->seen);
  }
  return image;
}

Bytes MemoryDisk::what_stays(const Node& node, PowerLoss::Data data, std::mt19937_64& random) {
  using Data = PowerLoss::Data;
  const std::size_t safe = std::min(node.durable.size(), node.seen.size());
  Bytes left = node.durable;
  if (data == Data::lost || node.seen.size() <= safe) {
    if (data != Data::lost && node.seen.size() < node.durable.size() && random() % 2 == 0)
      left.resize(node.seen.size());  // a truncation that was not synced either
    return left;
  }
  left.resize(safe);
  const std::size_t whole = node.seen.size();
  const std::size_t length = data == Data::torn ? safe + random() % (whole - safe + 1) : whole;
  left.insert(left.end(), node.seen.begin() + static_cast<std::ptrdiff_t>(safe),
              node.seen.begin() + static_cast<std::ptrdiff_t>(length));
  if (data == Data::torn || data == Data::kept) return left;
  for (std::size_t begin = safe; begin < length;) {
    const std::size_t end = std::min(length, (begin / sector_bytes + 1) * sector_bytes);
    const bool reached = data != Data::zeros && random() % 2 == 0;
    for (std::size_t i = begin; i < end && !reached; ++i)
      left[i] = data == Data::garbage ? static_cast<std::byte>(random()) : std::byte{0};
    begin = end;
  }
  return left;
}

DiskImage MemoryDisk::after_power_loss(PowerLoss loss, std::mt19937_64& random) const {
  using Kept = PowerLoss::Names;
  Names names = durable_;
  for (const NameChange& change : unsynced_) {
    const bool kept = loss.names == Kept::kept || (loss.names == Kept::some && random() % 2 == 0);
    if (!kept) continue;
    for (const auto& [name, node] : change.names) {
      if (node)
        names[name] = node;
      else
        names.erase(name);
    }
  }
  DiskImage image;
  for (const auto& [name, node] : names)
    if (node->is_folder) image.folders.insert(name);
  for (const auto& [name, node] : names)
    if (!node->is_folder && image.folders.contains(folder_name(name)))
      image.files[name] = std::make_shared<const Bytes>(what_stays(*node, loss.data, random));
  return image;
}

}  // namespace thermorig::storage_test

// SPDX-License-Identifier: MIT
// HDF5 reads a file through a driver. Its own take a path, which may lead to another file by then, or the
// whole file in memory.
#include "file_driver.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

namespace thermorig::session {

namespace {

/// The library reads headers and indexes in pieces of some bytes: what lies around them is read at once, and
/// kept until four other places were.
class Blocks {
 public:
  void read(const StoredFile& file, std::uint64_t from, std::span<std::byte> out) {
    while (!out.empty()) {
      const std::uint64_t begin = from - from % block_bytes;
      const std::size_t at = from - begin, size = std::min(out.size(), block_bytes - at);
      const Block& block = block_at(file, begin);
      std::copy_n(block.bytes.begin() + static_cast<std::ptrdiff_t>(at), size, out.begin());
      from += size;
      out = out.subspan(size);
    }
  }
  static constexpr std::size_t block_bytes = 1 << 16;

 private:
  struct Block {
    std::uint64_t begin = 0;
    std::vector<std::byte> bytes;  // empty: not read
  };

  const Block& block_at(const StoredFile& file, std::uint64_t begin) {
    for (const Block& block : blocks_)
      if (!block.bytes.empty() && block.begin == begin) return block;
    Block& block = blocks_[next_++ % blocks_.size()];
    std::vector<std::byte> bytes(block_bytes);
    block.bytes.clear();
    file.read(begin, bytes);
    block = {begin, std::move(bytes)};
    return block;
  }

  std::array<Block, 4> blocks_;
  std::size_t next_ = 0;
};

struct File {
  H5FD_t of_library;  // first: the library knows a file by the address of this
  DriverSource* source;
  Blocks blocks;
};

File* file_of(H5FD_t* file) {
  return reinterpret_cast<File*>(file);
}
const File* file_of(const H5FD_t* file) {
  return reinterpret_cast<const File*>(file);
}

H5FD_t* open(const char* /*name*/, unsigned /*flags*/, hid_t access, haddr_t /*most*/) {
  const auto* info = static_cast<DriverSource* const*>(H5Pget_driver_info(access));
  return info == nullptr ? nullptr : &(new File{{}, *info, {}})->of_library;
}

herr_t close(H5FD_t* file) {
  delete file_of(file);
  return 0;
}

/// As the library's own drivers for files have it.
herr_t query(const H5FD_t* /*file*/, unsigned long* flags) {
  *flags = H5FD_FEAT_ACCUMULATE_METADATA | H5FD_FEAT_DATA_SIEVE | H5FD_FEAT_AGGREGATE_SMALLDATA;
  return 0;
}

haddr_t used_end(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return file_of(file)->source->used;
}

herr_t set_used_end(H5FD_t* file, H5FD_mem_t /*type*/, haddr_t end) {
  file_of(file)->source->used = end;
  return 0;
}

haddr_t end_of_file(const H5FD_t* file, H5FD_mem_t /*type*/) {
  return file_of(file)->source->end;
}

herr_t read(H5FD_t* file, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t from, size_t size, void* to) {
  DriverSource& source = *file_of(file)->source;
  try {
    const std::span out(static_cast<std::byte*>(to), size);
    if (size < Blocks::block_bytes)
      file_of(file)->blocks.read(*source.file, from, out);
    else
      source.file->read(from, out);
    return 0;
  } catch (...) {  // nothing may be thrown through the library
    if (!source.failure) source.failure = std::current_exception();
    return -1;
  }
}

herr_t write(H5FD_t* /*file*/, H5FD_mem_t /*type*/, hid_t /*transfer*/, haddr_t /*to*/, size_t /*size*/,
             const void* /*from*/) {
  return -1;
}

/// For the life of the program, as the library's own drivers are.
hid_t driver() {
  static const hid_t id = [] {
    H5FD_class_t made{};
#if defined(H5FD_CLASS_VERSION)
    made.version = H5FD_CLASS_VERSION;
    made.value = static_cast<H5FD_class_value_t>(H5_VFD_RESERVED + 1);
#endif
    made.name = "thermorig";
    made.maxaddr = StoredFile::bytes_max;
    made.fc_degree = H5F_CLOSE_WEAK;
    made.fapl_size = sizeof(DriverSource*);
    made.open = open;
    made.close = close;
    made.query = query;
    made.get_eoa = used_end;
    made.set_eoa = set_used_end;
    made.get_eof = end_of_file;
    made.read = read;
    made.write = write;
    constexpr H5FD_mem_t usual[] = H5FD_FLMAP_DICHOTOMY;
    std::copy(std::begin(usual), std::end(usual), std::begin(made.fl_map));
    return H5FDregister(&made);
  }();
  return id;
}

}  // namespace

Handle open_to_read(DriverSource& source, const std::string& action) {
  if (source.end == 0) throw Hdf5Failure(action + ": it is empty");
  const Handle access(H5Pcreate(H5P_FILE_ACCESS), "make properties");
  DriverSource* const info = &source;
  check(H5Pset_driver(access.get(), driver(), &info), "make properties");
  return Handle(H5Fopen("session", H5F_ACC_RDONLY, access.get()), action);
}

}  // namespace thermorig::session

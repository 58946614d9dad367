// The answers to one chunk of a packed batch, in one file: DIR/chunks/00001.sqlite. Tables: `plans`, a row for each
// request; `files`, what `fjr plan` would have written for it, deflated; `runs`, who has planned how many, and where.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "common/descriptor.h"
#include "planner/batch/manifest.h"
#include "planner/batch/table.h"
#include "planner/store/database.h"

namespace fjr {

// Held by whoever plans a chunk: a job that is started again while its first process lives on, on a machine that was
// given up, waits for that. One file for all chunks, DIR/chunks/locks, with a byte for each: locks of the kind that
// network file systems know, too, and that end with their process.
class ChunkLock {
 public:
  // None where another process holds it.
  static std::optional<ChunkLock> take(const Manifest& manifest, std::size_t chunk);
  static bool is_held(const Manifest& manifest, std::size_t chunk);  // by another process

 private:
  explicit ChunkLock(Descriptor file) : file_(std::move(file)) {}
  Descriptor file_;
};

// To add answers: by whoever holds the chunk's lock. Each is on the disk when the function returns.
class ChunkWriter {
 public:
  ChunkWriter(const Manifest& manifest, std::size_t chunk);  // a run begins
  ~ChunkWriter();                                            // it ends

  // What is in a file of the current answer. None where it has no such file, or one that is damaged.
  std::optional<std::string> file(const std::string& name, const std::string& file) const;
  // That the current answer is one to the request as it is now.
  void confirm(const ManifestItem& item) const;
  // In place of an earlier answer. folder: what `fjr plan` has written, if anything. A certified plan that is replaced
  // stays, as `previous`, until another certified one is replaced.
  void answer(const ManifestItem& item, const Row& row, const std::optional<std::filesystem::path>& folder) const;
  // Likewise, of what was not planned: a request that is refused.
  void refuse(const ManifestItem& item, const nlohmann::ordered_json& plan) const;

 private:
  void put(const ManifestItem& item, const Row& row) const;

  Database database_;
  std::int64_t run_;
};

struct ChunkAnswer {
  std::string name, digest, status;
  std::string row;  // JSON, where rows were asked for
};

struct ChunkRuns {
  std::size_t runs = 0, planned = 0;  // how often it was worked on, and how many requests were planned in all of them
};

// To read them, whoever is adding to them meanwhile.
class ChunkReader {
 public:
  // None where nothing was planned yet.
  static std::optional<ChunkReader> open(const Manifest& manifest, std::size_t chunk);

  void for_each(const std::function<void(const ChunkAnswer&)>& take, bool rows) const;
  ChunkRuns runs() const;
  bool has(const std::string& name, bool previous) const;                                          // files of an answer
  void unpack(const std::string& name, bool previous, const std::filesystem::path& folder) const;  // into the folder

 private:
  explicit ChunkReader(const std::filesystem::path& file) : database_(file, Database::Access::kRead) {}
  Database database_;
};

}  // namespace fjr

// The answers to one chunk of a packed batch, in one file: DIR/chunks/00001.sqlite. It has the tables `plans` (one row
// per request), `files` (the files `fjr plan` would have written for it, deflated) and `runs` (who planned how many,
// where).
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

// The lock on a chunk, held by the process that plans it. If a job is restarted while its first process still runs on a
// machine that was given up, the second process waits. All locks are in one file, DIR/chunks/locks, with one byte per
// chunk. They are byte-range locks of fcntl(), which network file systems support, too, and which end with their
// process.
class ChunkLock {
 public:
  // Returns nothing if another process holds the lock.
  static std::optional<ChunkLock> take(const Manifest& manifest, std::size_t chunk);
  static bool is_held(const Manifest& manifest, std::size_t chunk);  // by another process

 private:
  explicit ChunkLock(Descriptor file) : file_(std::move(file)) {}
  Descriptor file_;
};

// Adds answers to a chunk. The caller must hold the chunk's lock. Each answer is on the disk when the function returns.
class ChunkWriter {
 public:
  ChunkWriter(const Manifest& manifest, std::size_t chunk);  // a run begins
  ~ChunkWriter();                                            // it ends

  // Returns the content of a file of the current answer; nothing if there is no such file or it is damaged.
  std::optional<std::string> file(const std::string& name, const std::string& file) const;
  // Records that the current answer is valid for the present version of the request.
  void confirm(const ManifestItem& item) const;
  // Stores an answer, replacing an earlier one. folder: the files that `fjr plan` has written, if any. A certified plan
  // that is replaced is kept as `previous` until another certified plan is replaced.
  void answer(const ManifestItem& item, const Row& row, const std::optional<std::filesystem::path>& folder) const;
  // Stores the answer to a request that was refused and therefore not planned.
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

// Reads the answers of a chunk. Another process may add answers at the same time.
class ChunkReader {
 public:
  // Returns nothing if nothing was planned yet.
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

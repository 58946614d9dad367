// The manifest of a packed batch, DIR/manifest.sqlite: every request as text, in chunks that can be planned
// independently on any machine. `fjr batch prepare` creates it; the processes that plan a chunk only read it.
#pragma once

#include <cstddef>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "planner/batch/items.h"
#include "planner/store/database.h"

namespace fjr {

struct Prepared {
  std::size_t unchanged = 0, changed = 0, added = 0;  // numbers of the given requests
  std::size_t kept = 0;                               // number of earlier requests that were not given this time
};

struct ManifestItem {
  BatchItem item;
  // Hash over everything that the answer depends on: the request, its robot file, and the version of fjr. An answer
  // with another digest is checked again.
  std::string digest;
};

class Manifest {
 public:
  // Throws InputError if the folder has no manifest.
  explicit Manifest(std::filesystem::path folder);

  const std::filesystem::path& folder() const { return folder_; }
  std::filesystem::path chunk_file(std::size_t chunk) const;
  std::filesystem::path results_file() const { return folder_ / "results.sqlite"; }

  std::vector<std::string> options() const;  // words for `fjr plan`, the same for all
  bool asks_for(const std::string& option) const;
  std::size_t chunks() const;  // numbered from 1
  std::vector<ManifestItem> items(std::size_t chunk) const;
  // Calls back for the requests of a chunk: name and digest only.
  void for_each(std::size_t chunk, const std::function<void(std::string name, std::string digest)>& take) const;
  std::vector<std::string> names() const;                             // all, by name_order.h
  BatchItem item(const std::string& name, std::size_t& chunk) const;  // InputError: there is none

 private:
  std::filesystem::path folder_;
  Database database_;
};

// Creates the manifest of a folder or adds to it. Existing requests stay in their chunks with their text updated; new
// ones get new chunks. If it throws, nothing has changed. chunk_size: largest number of requests per chunk, at least 1.
// Throws InputError if the batch was begun with other options, or if the folder cannot be created.
Prepared prepare(const std::filesystem::path& folder, const std::vector<BatchItem>& items,
                 const std::vector<std::string>& options, std::size_t chunk_size);

}  // namespace fjr

// What a packed batch is to plan, DIR/manifest.sqlite: every request as text, in chunks that are planned by themselves,
// on whatever machine. Made once by `fjr batch prepare`; whoever plans a chunk only reads it.
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
  std::size_t unchanged = 0, changed = 0, added = 0;  // of the requests given
  std::size_t kept = 0;                               // not given this time, but before
};

struct ManifestItem {
  BatchItem item;
  // Over all that the answer depends on: the request, its robot's file, the version of fjr. An answer with another one
  // is looked at again.
  std::string digest;
};

class Manifest {
 public:
  // Throws InputError where the folder holds none.
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

// Makes the folder's manifest, or adds to it: requests that are there already stay in their chunks, with what they say
// now, and new ones get chunks of their own. All at once, or nothing if it throws. chunk_size: at most so many requests
// in a chunk, from 1. Throws InputError for a batch that was begun with other options, and where the folder cannot be
// made.
Prepared prepare(const std::filesystem::path& folder, const std::vector<BatchItem>& items,
                 const std::vector<std::string>& options, std::size_t chunk_size);

}  // namespace fjr

// A plan library: stored plans from which neighbouring requests are warm-started. `fjr library build` fills it with a
// batch, and a service with the plans it makes. `fjr plan --library` and the service look requests up in it.
//
// Plans belong to one family if their requests differ only in the joint angles of start and goal. The distance of two
// plans in a family is the largest of the four differences of these angles.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "planner/plan.h"
#include "planner/store/database.h"

namespace fjr {

struct Collocated;  // planner/ocp/collocate.h

// [rad] largest distance for a warm start, including rounding. From a plan farther away, a warm start takes as long as
// a start from scratch (bench/README.md, Races).
inline constexpr double kNearby = 0.02 + 1e-9;

// Returns the SHA-256 hash of everything that a plan depends on except the angles of start and goal, the seed, and the
// thoroughness of the search. Returns nothing if not all of these angles are given, or if there are several goals; such
// requests are never looked up.
std::optional<std::string> family_of(const Problem& problem);

// A plan of the library for display.
struct LibraryEntry {
  std::string name;            // of its request
  Joints<double> start, goal;  // [rad] link angles
  double objective = 0;        // the plan's
  std::string request;         // YAML; a robot that it names is named by an absolute path
};

struct LibraryNeighbour {
  LibraryEntry entry;
  double away = 0;  // [rad]
  std::shared_ptr<const Collocated> solution;
};

struct LibraryFamily {
  std::string id;          // family_of()
  std::string robot_hash;  // model/parameters.h
  std::size_t plans = 0;
  Joints<double> start_from, start_to, goal_from, goal_to;  // [rad] ranges of the angles
};

// [rad] the largest difference of an angle of start or goal.
double distance(const Problem& a, const Problem& b);

class PlanLibrary {
 public:
  enum class Access { kRead, kWrite };

  // Opens DIR/library.sqlite. kWrite creates it, and DIR, if necessary. Throws InputError if kRead finds none, or if
  // the file is not a plan library. Several processes may use one library at the same time.
  PlanLibrary(const std::filesystem::path& folder, Access access);

  // Returns the nearest plan that is at most `within` [rad] away, or nothing if there is none or the request has no
  // family. Throws InputError if its solution cannot be read.
  std::optional<LibraryNeighbour> nearest(const Problem& problem, double within = kNearby) const;

  // Returns whether there is a plan at most `within` [rad] away.
  bool any_within(const Problem& problem, double within) const;

  // Returns whether there is a plan of exactly this problem.
  bool has(const Problem& problem) const;

  // Adds a certified plan with its solution. Of two plans of the same problem the better one is kept. Returns false if
  // the problem has no family. request: YAML with absolute paths.
  bool add(const Problem& problem, const std::string& request, double objective, const Collocated& solution);

  std::vector<LibraryFamily> families() const;
  // Returns at most `most` random plans, drawn without replacement; the same ones for the same seed and library.
  std::vector<LibraryEntry> sample(std::size_t most, std::uint64_t seed) const;

 private:
  struct Row;
  std::optional<Row> nearest_row(const Problem& problem, double within) const;

  std::filesystem::path file_;
  Database database_;
};

WarmStart warm_start_from(const LibraryNeighbour& neighbour);

}  // namespace fjr

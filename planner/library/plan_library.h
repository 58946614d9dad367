// A plan library: plans that were kept so that requests beside them start from theirs. `fjr library build` fills it
// with a batch, a service with what it plans; `fjr plan --library` and the service look requests up in it.
//
// Plans are comparable when their requests differ by nothing but the joint angles of start and goal: those are one
// family. The nearest in its family is the one whose four angles differ least, by the largest of the four differences.
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

// [rad] of every angle of start and goal, roundings included: farther away a start from the neighbour takes as long as
// one from scratch (bench/README.md, Races).
inline constexpr double kNearby = 0.02 + 1e-9;

// SHA-256 over all that a plan depends on but the angles of start and goal, the seed and how thoroughly is searched.
// None where these angles are not all told, or more than one goal is: such requests are never looked up.
std::optional<std::string> family_of(const Problem& problem);

// A plan of the library as it is told to people.
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

  // DIR/library.sqlite; kWrite makes it, and DIR, where there is none. Throws InputError where kRead finds none, and
  // for a file that is none of fjr's. Several processes may use one library at the same time.
  PlanLibrary(const std::filesystem::path& folder, Access access);

  // The nearest plan that is at most `within` [rad] away; none: there is none, or the request has no family. A
  // solution that cannot be read throws InputError.
  std::optional<LibraryNeighbour> nearest(const Problem& problem, double within = kNearby) const;

  // Whether a plan is at most `within` [rad] away.
  bool any_within(const Problem& problem, double within) const;

  // Whether a plan of this very problem is there.
  bool has(const Problem& problem) const;

  // Keeps a certified plan with its solution; false for a problem without a family. Of two plans of one problem the
  // better is kept. request: YAML that stands by itself.
  bool add(const Problem& problem, const std::string& request, double objective, const Collocated& solution);

  std::vector<LibraryFamily> families() const;
  // At most `most` plans, drawn without replacement; the same for the same seed and library.
  std::vector<LibraryEntry> sample(std::size_t most, std::uint64_t seed) const;

 private:
  struct Row;
  std::optional<Row> nearest_row(const Problem& problem, double within) const;

  std::filesystem::path file_;
  Database database_;
};

WarmStart warm_start_from(const LibraryNeighbour& neighbour);

}  // namespace fjr

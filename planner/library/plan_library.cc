#include "planner/library/plan_library.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <utility>

#include "common/input_error.h"
#include "planner/ocp/collocate.h"
#include "planner/request/request.h"
#include "planner/results/solution_file.h"

namespace fjr {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 1;
constexpr const char* kFile = "library.sqlite";

// The table `places` finds plans by their angles. It is an R*-tree of SQLite, whose numbers have 24 bits.
constexpr const char* kTables = R"(
  CREATE TABLE IF NOT EXISTS fjr_library (version INTEGER);
  CREATE TABLE IF NOT EXISTS plans (
    id INTEGER PRIMARY KEY, request_hash TEXT UNIQUE, family TEXT, robot_hash TEXT, name TEXT,
    start_1 REAL, start_2 REAL, goal_1 REAL, goal_2 REAL, objective REAL, request TEXT, solution BLOB);
  CREATE INDEX IF NOT EXISTS plans_of_family ON plans (family);
  CREATE VIRTUAL TABLE IF NOT EXISTS places USING rtree(
    id, start_1_min, start_1_max, start_2_min, start_2_max, goal_1_min, goal_1_max, goal_2_min, goal_2_max);
)";
constexpr double kRounding = 1e-5;  // [rad] exceeds the rounding error of an angle below 100 rad in the tree

constexpr const char* kEntry = "name, start_1, start_2, goal_1, goal_2, objective, request";

LibraryEntry entry_of(const Statement& row) {
  return {row.text(0), {row.real(1), row.real(2)}, {row.real(3), row.real(4)}, row.real(5), row.text(6)};
}

fs::path existing(const fs::path& folder) {
  if (!fs::exists(folder / kFile)) {
    throw InputError(folder.string(), "",
                     fmt::format("holds no plan library ({}); fjr library build makes one", kFile));
  }
  return folder / kFile;
}

fs::path made(const fs::path& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw InputError(folder.string(), "", "cannot be made: " + error.message());
  return folder / kFile;
}

bool has_tables(const Database& database) { return database.query("SELECT 1 FROM sqlite_master").step(); }

void check_version(const Database& database, const fs::path& file) {
  const bool is_one = database.query("SELECT 1 FROM sqlite_master WHERE name = 'fjr_library'").step();
  Statement version = database.prepare(is_one ? "SELECT version FROM fjr_library" : "SELECT 0");
  if (version.step() && version.integer(0) == kVersion) return;
  throw InputError(file.string(), "", "is no plan library of this version");
}

Database opened(const fs::path& file, PlanLibrary::Access access) {
  const bool writes = access == PlanLibrary::Access::kWrite;
  Database database(file, writes ? Database::Access::kWrite : Database::Access::kRead);
  if (!writes || has_tables(database)) check_version(database, file);
  if (!writes) return database;
  Transaction transaction(database);
  database.execute(kTables);
  if (!database.query("SELECT 1 FROM fjr_library").step()) {
    database.run("INSERT INTO fjr_library VALUES (?)", kVersion);
  }
  transaction.commit();
  return database;
}

}  // namespace

double distance(const Problem& a, const Problem& b) {
  return std::max(largest_difference(a.start.q, b.start.q), largest_difference(a.goal.q, b.goal.q));
}

WarmStart warm_start_from(const LibraryNeighbour& neighbour) {
  return {neighbour.solution, neighbour.entry.name, neighbour.away};
}

std::optional<std::string> family_of(const Problem& problem) {
  if (problem.goal.any_free() || !problem.other_goals.empty()) return std::nullopt;
  Problem family = problem;
  family.start.q = family.goal.q = {0, 0};
  if (problem.start_at_rest) family.start.theta = {0, 0};
  if (problem.goal.at_rest) family.goal.theta = Joints<double>{0, 0};
  family.seed = Problem{}.seed;
  family.search = Thoroughness::kDefault;
  return request_hash(family);
}

PlanLibrary::PlanLibrary(const fs::path& folder, Access access)
    : file_(access == Access::kRead ? existing(folder) : made(folder)), database_(opened(file_, access)) {}

struct PlanLibrary::Row {
  LibraryEntry entry;
  double away = 0;  // [rad]
  std::int64_t id = 0;
};

std::optional<PlanLibrary::Row> PlanLibrary::nearest_row(const Problem& problem, double within) const {
  const auto family = family_of(problem);
  if (!family) return std::nullopt;
  const double box = within + kRounding;
  const auto &s = problem.start.q, &g = problem.goal.q;
  Statement near = database_.query(
      fmt::format("SELECT {}, plans.id FROM places JOIN plans ON plans.id = places.id WHERE family = ? "
                  "AND start_1_max >= ? AND start_1_min <= ? AND start_2_max >= ? AND start_2_min <= ? "
                  "AND goal_1_max >= ? AND goal_1_min <= ? AND goal_2_max >= ? AND goal_2_min <= ? ORDER BY plans.id",
                  kEntry),
      *family, s[0] - box, s[0] + box, s[1] - box, s[1] + box, g[0] - box, g[0] + box, g[1] - box, g[1] + box);
  std::optional<Row> nearest;
  while (near.step()) {
    LibraryEntry entry = entry_of(near);
    const double away = std::max(largest_difference(entry.start, s), largest_difference(entry.goal, g));
    if (away > within || (nearest && away >= nearest->away)) continue;
    nearest = Row{std::move(entry), away, near.integer(7)};
  }
  return nearest;
}

std::optional<LibraryNeighbour> PlanLibrary::nearest(const Problem& problem, double within) const {
  auto row = nearest_row(problem, within);
  if (!row) return std::nullopt;
  Statement solution = database_.query("SELECT solution FROM plans WHERE id = ?", row->id);
  if (!solution.step()) return std::nullopt;  // another process has just replaced the plan
  const std::string where = fmt::format("{}, {}", file_.string(), row->entry.name);
  return LibraryNeighbour{
      std::move(row->entry), row->away,
      std::make_shared<const Collocated>(solution_from(solution.text(0), where, robot_hash(problem.robot)))};
}

bool PlanLibrary::any_within(const Problem& problem, double within) const {
  return nearest_row(problem, within).has_value();
}

bool PlanLibrary::has(const Problem& problem) const {
  return database_.query("SELECT 1 FROM plans WHERE request_hash = ?", request_hash(problem)).step();
}

bool PlanLibrary::add(const Problem& problem, const std::string& request, double objective,
                      const Collocated& solution) {
  const auto family = family_of(problem);
  if (!family) return false;
  const std::string hash = request_hash(problem), robot = robot_hash(problem.robot);
  const auto &s = problem.start.q, &g = problem.goal.q;
  Transaction transaction(database_);
  Statement known = database_.query("SELECT id, objective FROM plans WHERE request_hash = ?", hash);
  if (known.step()) {
    if (known.real(1) <= objective) return true;
    database_.run("DELETE FROM places WHERE id = ?", known.integer(0));
    database_.run("DELETE FROM plans WHERE id = ?", known.integer(0));
  }
  database_.run(
      "INSERT INTO plans (request_hash, family, robot_hash, name, start_1, start_2, goal_1, goal_2, objective, "
      "request, "
      "solution) VALUES (?, ?, ?, ?, ?, ?, ?, ?, ?, ?, ?)",
      hash, *family, robot, problem.name, s[0], s[1], g[0], g[1], objective, request,
      Blob{solution_bytes(solution, robot)});
  database_.run(
      "INSERT INTO places SELECT id, start_1, start_1, start_2, start_2, goal_1, goal_1, goal_2, goal_2 FROM "
      "plans WHERE request_hash = ?",
      hash);
  transaction.commit();
  return true;
}

std::vector<LibraryFamily> PlanLibrary::families() const {
  Statement row = database_.prepare(
      "SELECT family, robot_hash, count(*), min(start_1), min(start_2), max(start_1), max(start_2), min(goal_1), "
      "min(goal_2), max(goal_1), max(goal_2) FROM plans GROUP BY family ORDER BY count(*) DESC, family");
  std::vector<LibraryFamily> families;
  while (row.step()) {
    families.push_back({row.text(0),
                        row.text(1),
                        static_cast<std::size_t>(row.integer(2)),
                        {row.real(3), row.real(4)},
                        {row.real(5), row.real(6)},
                        {row.real(7), row.real(8)},
                        {row.real(9), row.real(10)}});
  }
  return families;
}

std::vector<LibraryEntry> PlanLibrary::sample(std::size_t most, std::uint64_t seed) const {
  std::vector<std::int64_t> ids;
  for (Statement row = database_.prepare("SELECT id FROM plans ORDER BY id"); row.step();)
    ids.push_back(row.integer(0));
  std::vector<std::int64_t> drawn;
  std::sample(ids.begin(), ids.end(), std::back_inserter(drawn), most, std::mt19937_64(seed));
  std::vector<LibraryEntry> entries;
  for (const std::int64_t id : drawn) {
    Statement row = database_.query(fmt::format("SELECT {} FROM plans WHERE id = ?", kEntry), id);
    if (row.step()) entries.push_back(entry_of(row));
  }
  return entries;
}

}  // namespace fjr

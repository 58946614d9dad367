#include "planner/search/detours.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>
#include <queue>
#include <set>

#include "planner/problem/elbow_side.h"
#include "planner/problem/task/task.h"
#include "planner/problem/tip_path.h"

namespace fjr {
namespace {

constexpr double kComfort = 0.02;     // [m] clearance below which a cell costs more
constexpr double kDearer = 2;         // factor on the cost of a cell without clearance
constexpr double kDiscouraged = 6;    // factor on cells near a path that was found before
constexpr double kNear = 0.5;         // [rad] distance that counts as near; grows with every trial
constexpr int kTrials = 3;            // to find one more path
constexpr std::size_t kFewRows = 24;  // of a task, up to which the finest grid takes less than a second
constexpr double kInfinity = std::numeric_limits<double>::infinity();

struct Cell {
  int i, j;
};

// Returns whether the row is of a line or arc of the tip that is wide enough to contain cells of a coarse grid.
bool is_wide(const TaskRow& row) { return row.kind != TaskRow::Kind::kAngles && row.scale >= kWideTipPath; }

}  // namespace

// The cells, their clearances, and what it costs to pass them.
class AngleGrid {
 public:
  AngleGrid(const Problem& problem, double spacing)
      : middle_(problem.limits.link_middle),
        limit_(problem.limits.link_position),
        speed_(problem.limits.motor_velocity) {
    for (std::size_t axis = 0; axis < 2; ++axis) {
      size_[axis] = std::max(3, static_cast<int>(std::ceil(2 * limit_[axis] / spacing)) + 1);
    }
    // Rows that differ by segment are those of a joint path, which is narrow.
    std::vector<TaskRow> rows = task_rows(problem.robot, problem.task, 0);
    std::erase_if(rows, [](const TaskRow& row) { return row.info->is_band && !is_wide(row); });
    clearance_.resize(static_cast<std::size_t>(size_[0] * size_[1]));
    may_be_free_.resize(clearance_.size());
    for (std::size_t c = 0; c < clearance_.size(); ++c) {
      clearance_[c] = kInfinity;
      may_be_free_[c] = 1;
      const auto posture = Posture<double>::of(problem.robot, q_of(c));
      for (const TaskRow& row : rows) {
        const double distance = row.distance(row.value(problem.robot, posture));
        clearance_[c] = std::min(clearance_[c], distance);
        if (distance + moved_by(problem.robot, row, 0.5 * spacing) < 0) may_be_free_[c] = 0;
      }
    }
    cost_.assign(clearance_.size(), 1);
    for (std::size_t c = 0; c < clearance_.size(); ++c) {
      if (clearance_[c] < kComfort) cost_[c] = 1 + (kDearer - 1) * (1 - std::max(0.0, clearance_[c]) / kComfort);
    }
  }

  std::size_t cells() const { return clearance_.size(); }
  double clearance(std::size_t c) const { return clearance_[c]; }
  bool free(std::size_t c) const { return clearance_[c] >= 0; }
  // Returns whether any posture that is nearer to this cell than to others may keep the task.
  bool may_be_free(std::size_t c) const { return may_be_free_[c] != 0; }

  Joints<double> q_of(std::size_t c) const {
    const int i = static_cast<int>(c) / size_[1], j = static_cast<int>(c) % size_[1];
    return {middle_[0] - limit_[0] + 2 * limit_[0] * i / (size_[0] - 1),
            middle_[1] - limit_[1] + 2 * limit_[1] * j / (size_[1] - 1)};
  }

  // Returns the nearest cell; with `only_free` the nearest free one within two cells, if there is any, because a
  // permitted posture may have a forbidden cell next to it.
  std::size_t cell_of(const Joints<double>& q, bool only_free) const {
    const Cell at{nearest(q[0], 0), nearest(q[1], 1)};
    std::size_t best = index(at);
    double least = kInfinity;
    for (int i = at.i - 2; i <= at.i + 2; ++i) {
      for (int j = at.j - 2; j <= at.j + 2; ++j) {
        if (!inside({i, j})) continue;
        const Joints<double> cell = q_of(index({i, j}));
        const double away = task::distance(cell, q);
        if (away < least && (!only_free || free(index({i, j})))) {
          least = away;
          best = index({i, j});
        }
      }
    }
    return best;
  }

  // visit(neighbour, time [s] to go there at full speed)
  template <class Visit>
  void each_neighbour(std::size_t c, Visit&& visit) const {
    const int i = static_cast<int>(c) / size_[1], j = static_cast<int>(c) % size_[1];
    for (int di = -1; di <= 1; ++di) {
      for (int dj = -1; dj <= 1; ++dj) {
        if ((di == 0 && dj == 0) || !inside({i + di, j + dj})) continue;
        const Joints<double> a = q_of(c), b = q_of(index({i + di, j + dj}));
        visit(index({i + di, j + dj}), std::hypot((b[0] - a[0]) / speed_[0], (b[1] - a[1]) / speed_[1]));
      }
    }
  }

  double cost(std::size_t c) const { return cost_[c]; }

  // Makes the middle of a path dear, so that the next one goes elsewhere.
  void discourage(const Path& path, double near) {
    for (std::size_t c = 0; c < cells(); ++c) {
      const Joints<double> q = q_of(c);
      for (std::size_t k = path.size() / 5; k < path.size() - path.size() / 5; ++k) {
        if (task::distance(path[k], q) < near) {
          cost_[c] = kDiscouraged;
          break;
        }
      }
    }
  }

 private:
  int nearest(double angle, std::size_t axis) const {
    const double fraction = (angle - middle_[axis] + limit_[axis]) / (2 * limit_[axis]);
    return std::clamp(static_cast<int>(std::lround(fraction * (size_[axis] - 1))), 0, size_[axis] - 1);
  }
  bool inside(Cell c) const { return c.i >= 0 && c.i < size_[0] && c.j >= 0 && c.j < size_[1]; }
  std::size_t index(Cell c) const { return static_cast<std::size_t>(c.i * size_[1] + c.j); }

  Joints<double> middle_, limit_, speed_;
  std::array<int, 2> size_{};
  std::vector<double> clearance_, cost_;
  std::vector<char> may_be_free_;
};

namespace {

// Dijkstra's algorithm. better(a, b): whether value a of a path is better than b. extend(value, from, to, time): value
// of the path after one more step. Returns the cells of the best path; empty if there is none.
template <class Better, class Extend>
std::vector<std::size_t> search(const AngleGrid& grid, std::size_t from, std::size_t to, double first, double worst,
                                const Better& better, const Extend& extend) {
  std::vector<double> value(grid.cells(), worst);
  std::vector<std::size_t> previous(grid.cells(), grid.cells());
  using Entry = std::pair<double, std::size_t>;
  const auto later = [&](const Entry& a, const Entry& b) {
    return a.first != b.first ? better(b.first, a.first) : a.second > b.second;
  };
  std::priority_queue<Entry, std::vector<Entry>, decltype(later)> open(later);
  value[from] = first;
  open.push({first, from});
  while (!open.empty()) {
    const auto [reached, cell] = open.top();
    open.pop();
    if (cell == to) break;
    if (better(value[cell], reached)) continue;
    grid.each_neighbour(cell, [&](std::size_t next, double time) {
      const double candidate = extend(reached, cell, next, time);
      if (!better(candidate, value[next])) return;
      value[next] = candidate;
      previous[next] = cell;
      open.push({candidate, next});
    });
  }
  std::vector<std::size_t> cells;
  if (to != from && previous[to] == grid.cells()) return cells;
  for (std::size_t c = to; c != grid.cells(); c = previous[c]) cells.push_back(c);
  std::reverse(cells.begin(), cells.end());
  return cells;
}

std::vector<std::size_t> quickest(const AngleGrid& grid, std::size_t from, std::size_t to) {
  return search(
      grid, from, to, 0, kInfinity, [](double a, double b) { return a < b; },
      [&](double value, std::size_t cell, std::size_t next, double time) {
        return grid.free(next) ? value + time * (grid.cost(cell) + grid.cost(next)) / 2 : kInfinity;
      });
}

std::vector<std::size_t> widest(const AngleGrid& grid, std::size_t from, std::size_t to) {
  return search(
      grid, from, to, kInfinity, -kInfinity, [](double a, double b) { return a > b; },
      [&](double value, std::size_t, std::size_t next, double) { return std::min(value, grid.clearance(next)); });
}

// Returns whether cells that may be free lead from one cell to another. Every path of the arm passes from a cell to one
// of its neighbours.
bool may_be_connected(const AngleGrid& grid, std::size_t from, std::size_t to) {
  std::vector<char> reached(grid.cells());
  std::vector<std::size_t> open{from};
  reached[from] = 1;
  while (!open.empty() && reached[to] == 0) {
    const std::size_t cell = open.back();
    open.pop_back();
    grid.each_neighbour(cell, [&](std::size_t next, double) {
      if (reached[next] != 0 || !grid.may_be_free(next)) return;
      reached[next] = 1;
      open.push_back(next);
    });
  }
  return reached[to] != 0;
}

Path path_of(const AngleGrid& grid, const std::vector<std::size_t>& cells, const Joints<double>& from,
             const Joints<double>& to) {
  Path path{from};
  for (std::size_t k = 1; k + 1 < cells.size(); ++k) path.push_back(grid.q_of(cells[k]));
  path.push_back(to);
  return path;
}

// Returns the winding number of a closed polygon about a point.
int winding(const Path& polygon, const Joints<double>& point) {
  int turns = 0;
  for (std::size_t k = 0; k < polygon.size(); ++k) {
    const Joints<double>&a = polygon[k], &b = polygon[(k + 1) % polygon.size()];
    const double side = (b[0] - a[0]) * (point[1] - a[1]) - (point[0] - a[0]) * (b[1] - a[1]);
    if (a[1] <= point[1] && b[1] > point[1] && side > 0) ++turns;
    if (a[1] > point[1] && b[1] <= point[1] && side < 0) --turns;
  }
  return turns;
}

// Returns whether two paths are of one homotopy class: the loop that they form must not enclose a forbidden cell.
bool same_path(const AngleGrid& grid, const Path& a, const Path& b) {
  Path loop = a;
  loop.insert(loop.end(), b.rbegin(), b.rend());
  for (std::size_t c = 0; c < grid.cells(); ++c) {
    if (!grid.free(c) && winding(loop, grid.q_of(c)) != 0) return false;
  }
  return true;
}

std::vector<std::size_t> broken_on(const Problem& problem, std::size_t segment, const Path& path) {
  std::set<std::size_t> broken;
  const std::vector<TaskRow> rows = task_rows(problem.robot, problem.task, segment);
  for (const Joints<double>& q : path) {
    const auto posture = Posture<double>::of(problem.robot, q);
    for (const TaskRow& row : rows) {
      if (row.clearance(row.value(problem.robot, posture)) < 0) broken.insert(row.constraint);
    }
  }
  return {broken.begin(), broken.end()};
}

}  // namespace

DetourFinder::DetourFinder(const Problem& problem, double spacing)
    : problem_(problem), grid_(std::make_unique<AngleGrid>(problem, spacing)) {}
DetourFinder::~DetourFinder() = default;

bool DetourFinder::is_barred(const Joints<double>& from, const Joints<double>& to) const {
  return !may_be_connected(*grid_, grid_->cell_of(from, false), grid_->cell_of(to, false));
}

Detours DetourFinder::find(std::size_t segment, const Joints<double>& from, const Joints<double>& to,
                           std::size_t most) const {
  AngleGrid grid = *grid_;  // a copy, whose costs are raised by each path that is found
  Detours found;
  const std::vector<std::size_t> best = widest(grid, grid.cell_of(from, false), grid.cell_of(to, false));
  found.widest = path_of(grid, best, from, to);
  found.clearance = kInfinity;
  for (const std::size_t c : best) found.clearance = std::min(found.clearance, grid.clearance(c));
  found.barred_by = broken_on(problem_, segment, found.widest);
  const std::size_t start = grid.cell_of(from, true), goal = grid.cell_of(to, true);
  if (!grid.free(start) || !grid.free(goal)) return found;
  for (int trial = 0; trial < kTrials && found.paths.size() < most; ++trial) {
    const std::vector<std::size_t> cells = quickest(grid, start, goal);
    if (cells.empty()) break;
    const Path path = path_of(grid, cells, from, to);
    if (std::none_of(found.paths.begin(), found.paths.end(), [&](const Path& w) { return same_path(grid, w, path); })) {
      found.paths.push_back(path);
    }
    grid.discourage(path, kNear * (1 + trial));
  }
  return found;
}

namespace {

// Returns a sentence on a point of the tip's line or arc that no posture within the joints' limits reaches, if there is
// one.
std::optional<std::string> beyond_reach(const Problem& problem) {
  constexpr int kPieces = 400;
  const std::optional<TipPath> path = tip_path(problem.task);
  if (!path) return std::nullopt;
  const auto [l1, l2] = problem.robot.link.length;
  const double lowest = problem.limits.lowest(1), highest = problem.limits.highest(1);
  const double most = std::min(std::max(std::abs(lowest), std::abs(highest)), std::numbers::pi);
  const double least = lowest > 0 ? lowest : highest < 0 ? -highest : 0;  // the elbow cannot be stretched further
  const auto away_at = [&](double bend) { return std::sqrt(l1 * l1 + l2 * l2 + 2 * l1 * l2 * std::cos(bend)); };
  const double nearest = away_at(most), furthest = least == 0 ? l1 + l2 : away_at(least);
  const Point<double> begin = tip_position(problem.robot, problem.start.q),
                      end = tip_position(problem.robot, problem.goal.q);
  const Joints<double> from{begin.x, begin.y}, to{end.x, end.y};
  for (int i = 0; i <= kPieces; ++i) {
    const double s = static_cast<double>(i) / kPieces;
    const Coordinates tip = path->along(from, to, s);
    const double away = std::hypot(tip[0], tip[1]);
    if (away > nearest - path->tolerance && away < furthest + path->tolerance) continue;
    return fmt::format(
        "{} passes [{:.4g}, {:.4g}] m, {:.4g} m from the base; with the joints' limits the tip reaches from "
        "{:.4g} to {:.4g} m",
        path->name, tip[0], tip[1], away, nearest, furthest);
  }
  return std::nullopt;
}

}  // namespace

std::optional<NoPath> no_path(const Problem& problem) {
  const Task& task = problem.task;
  const std::optional<TipPath> path = tip_path(task);
  if (const auto sentence = beyond_reach(problem)) return NoPath{*sentence, {path->number}, 0};
  if (const auto sentence = barred_elbow(problem)) {
    return NoPath{*sentence, {task.box ? number_of(task, *task.box) : path->number}, 0};
  }
  if ((!keeps_clear(problem.task) && !problem.task.box) || problem.goal.any_free()) return std::nullopt;
  const std::vector<Joints<double>> points = waypoints(problem);
  const DetourFinder on_coarse_grid(problem);
  // Seldom needed, for they take 9 and 144 times as long to make.
  std::optional<DetourFinder> on_fine_grid, on_finest_grid;
  for (std::size_t s = 0; s + 1 < points.size(); ++s) {
    if (on_coarse_grid.find(s, points[s], points[s + 1], 0).clearance > 0) continue;
    if (!on_fine_grid) on_fine_grid.emplace(problem, kFineGrid);
    const Detours fine = on_fine_grid->find(s, points[s], points[s + 1], 0);
    if (fine.clearance > 0) continue;
    bool barred = on_fine_grid->is_barred(points[s], points[s + 1]);
    if (!barred && count_of_rows(task) <= kFewRows) {
      if (!on_finest_grid) on_finest_grid.emplace(problem, kFinestGrid);
      barred = on_finest_grid->is_barred(points[s], points[s + 1]);
    }
    if (!barred) continue;
    std::vector<std::string> names;
    for (const std::size_t number : fine.barred_by) names.push_back(constraint_name(task, number));
    const std::string where = points.size() == 2 ? "from the start to the goal"
                                                 : fmt::format("in segment {} of {}", s + 1, points.size() - 1);
    return NoPath{
        fmt::format("every path {} within the joints' limits is barred by {}; {:.2g} m more clearance would open one",
                    where, fmt::join(names, ", "), -fine.clearance),
        fine.barred_by, -fine.clearance};
  }
  return std::nullopt;
}

}  // namespace fjr

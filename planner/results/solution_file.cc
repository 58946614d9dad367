#include "planner/results/solution_file.h"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <vector>

#include "common/atomic_file.h"
#include "common/bounded_json.h"
#include "common/input_error.h"
#include "common/read_file.h"

namespace fjr {
namespace {

using nlohmann::json;

constexpr int kVersion = 1;
constexpr std::uintmax_t kLargest = 64 << 20;  // bytes; a solution on the finest meshes has a few million
constexpr std::size_t kMostIntervals = 100'000;

std::vector<double> numbers(const Eigen::VectorXd& v) { return {v.data(), v.data() + v.size()}; }

double finite(double value) {
  if (!std::isfinite(value)) throw std::invalid_argument("a number is not finite");
  return value;
}

Eigen::VectorXd vector_of(const json& values) {
  Eigen::VectorXd v(static_cast<Eigen::Index>(values.size()));
  for (Eigen::Index i = 0; i < v.size(); ++i) v(i) = finite(values.at(static_cast<std::size_t>(i)).get<double>());
  return v;
}

std::invalid_argument no_whole(int segment, double sum) {
  return std::invalid_argument(fmt::format("the intervals of segment {} make {} of it and not all", segment, sum));
}

Mesh mesh_of(const json& intervals) {
  Mesh mesh;
  double whole = 0;  // of the present segment
  if (intervals.empty() || intervals.size() > kMostIntervals)
    throw std::invalid_argument("the mesh has no usable size");
  for (const json& interval : intervals) {
    const double fraction = finite(interval.at(0).get<double>());
    const int segment = interval.at(1).get<int>(), last = mesh.intervals.empty() ? 0 : mesh.intervals.back().segment;
    if (segment != last && std::abs(whole - 1) > 1e-9) throw no_whole(last, whole);
    if (!(fraction > 0)) throw std::invalid_argument("an interval of the mesh takes no time");
    if (segment != last && segment != last + 1)
      throw std::invalid_argument("the segments of the mesh are out of order");
    whole = (segment == last ? whole : 0) + fraction;
    if (whole > 1 + 1e-9) throw no_whole(segment, whole);
    mesh.intervals.push_back({fraction, segment});
  }
  if (mesh.intervals.front().segment != 0) throw std::invalid_argument("the mesh begins with another segment than 0");
  if (std::abs(whole - 1) > 1e-9) throw no_whole(mesh.intervals.back().segment, whole);
  return mesh;
}

template <class Row, std::size_t kSize>
std::vector<Row> rows_of(const json& rows, std::size_t intervals, double* (*data)(Row&)) {
  if (!rows.empty() && rows.size() != intervals) throw std::invalid_argument("not one row per interval");
  std::vector<Row> result(rows.size());
  for (std::size_t k = 0; k < rows.size(); ++k) {
    for (std::size_t i = 0; i < kSize; ++i) data(result[k])[i] = finite(rows.at(k).at(i).get<double>());
  }
  return result;
}

std::vector<PerLimit> margins_of(const json& rows, std::size_t intervals) {
  if (!rows.empty() && rows.size() != intervals) throw std::invalid_argument("not one row of margins per interval");
  std::vector<PerLimit> margins;
  for (const json& row : rows) {
    margins.push_back(row.get<PerLimit>());
    if (margins.back().size() != margins.front().size()) throw std::invalid_argument("margins of different sizes");
    for (const double margin : margins.back()) {
      if (finite(margin) < 0) throw std::invalid_argument("a margin is negative");
    }
  }
  return margins;
}

Collocated solution_of(const json& file) {
  CollocationSetup setup{find_scheme(file.at("scheme").get<std::string>()), mesh_of(file.at("mesh"))};
  setup.smoothing = {finite(file.at("friction_width").get<double>()), finite(file.at("regularisation").get<double>())};
  setup.margins = margins_of(file.at("margins"), setup.mesh.size());
  setup.creep = rows_of<Joints<double>, kJoints>(file.at("creep"), setup.mesh.size(),
                                                 [](Joints<double>& pair) { return pair.data(); });
  Collocated solution{std::move(setup), {}, {}, {}};
  solution.report.iterate = {vector_of(file.at("x")), vector_of(file.at("lambda")), vector_of(file.at("z_lower")),
                             vector_of(file.at("z_upper"))};
  return solution;
}

}  // namespace

std::string solution_bytes(const Collocated& solution, const std::string& robot_hash) {
  const CollocationSetup& setup = solution.setup;
  const Iterate& iterate = solution.report.iterate;
  json mesh = json::array(), margins = json::array();
  for (const Mesh::Interval& interval : setup.mesh.intervals) mesh.push_back({interval.fraction, interval.segment});
  for (const PerLimit& margin : setup.margins) margins.push_back(margin);
  const json content{{"fjr_solution", kVersion},
                     {"robot_hash", robot_hash},
                     {"scheme", setup.scheme.name},
                     {"mesh", mesh},
                     {"friction_width", setup.smoothing.friction_width},
                     {"regularisation", setup.smoothing.regularisation},
                     {"margins", margins},
                     {"creep", setup.creep},
                     {"x", numbers(iterate.x)},
                     {"lambda", numbers(iterate.lambda)},
                     {"z_lower", numbers(iterate.z_lower)},
                     {"z_upper", numbers(iterate.z_upper)}};
  const std::vector<std::uint8_t> bytes = json::to_cbor(content);
  return {bytes.begin(), bytes.end()};
}

Collocated solution_from(std::string_view bytes, const std::string& source, const std::string& robot_hash) {
  std::string of_robot;
  try {
    const json content = json_from_cbor<json>(bytes);
    if (content.at("fjr_solution").get<int>() != kVersion) throw std::invalid_argument("another version's");
    of_robot = content.at("robot_hash").get<std::string>();
    if (of_robot == robot_hash) return solution_of(content);
  } catch (const std::exception& fault) {
    throw InputError(source, "", std::string("is no solution written by fjr plan: ") + fault.what());
  }
  throw InputError(source, "", "was planned for another robot or with another payload: " + of_robot);
}

void write_solution(const std::filesystem::path& file, const Collocated& solution, const std::string& robot_hash) {
  write_file(file, solution_bytes(solution, robot_hash));
}

Collocated read_solution(const std::filesystem::path& file, const std::string& robot_hash) {
  std::error_code error;
  const std::uintmax_t size = std::filesystem::file_size(file, error);
  if (error) throw InputError(file.string(), "", "cannot be read: " + error.message());
  if (size > kLargest) throw InputError(file.string(), "", "is too large for a solution");
  return solution_from(read_file(file).value_or(""), file.string(), robot_hash);
}

}  // namespace fjr

#include "planner/results/analysis_json.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/rounded.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::size_t kMostStretches = 16;  // of one limit; the longest
constexpr std::size_t kMostAlong = 100;     // of the intervals: plan.json travels in every reply

// Rounds to the number of significant digits that are meaningful.
Json rounded(double value, int digits = 6) {
  if (!std::isfinite(value)) return nullptr;
  return rounded_to(value, digits);
}
Json time(double value) { return std::round(value * 1e7) / 1e7; }
Json rounded(const Joints<double>& values) { return Json::array({rounded(values[0]), rounded(values[1])}); }
Json rounded_or_null(const std::optional<double>& value) { return value ? rounded(*value) : Json(nullptr); }
Json rounded_or_null(const std::optional<Joints<double>>& v) { return v ? rounded(*v) : Json(nullptr); }

Json stretches(std::vector<ShadowPrice::Stretch> active) {
  const auto length = [](const ShadowPrice::Stretch& s) { return s.end - s.begin; };
  if (active.size() > kMostStretches) {
    std::stable_sort(active.begin(), active.end(), [&](const auto& a, const auto& b) { return length(a) > length(b); });
    active.resize(kMostStretches);
    std::sort(active.begin(), active.end(), [](const auto& a, const auto& b) { return a.begin < b.begin; });
  }
  Json list = Json::array();
  for (const auto& s : active) list.push_back({time(s.begin), time(s.end)});
  return list;
}

Json costate(const State<double>& p) {
  return {{"q", rounded(p.q)}, {"dq", rounded(p.dq)}, {"theta", rounded(p.theta)}, {"dtheta", rounded(p.dtheta)}};
}

// Returns the values along the motion as columns, thinned out to every n-th interval.
Json along_json(const std::vector<Optimality::Along>& along) {
  Json json{{"time", Json::array()}, {"hamiltonian", Json::array()}};
  const auto add = [&json](const std::string& name, const Joints<double>& values) {
    for (std::size_t j = 0; j < kJoints; ++j)
      json["costate"][fmt::format("{}{}", name, j + 1)].push_back(rounded(values[j]));
  };
  const std::size_t step = (along.size() + kMostAlong - 1) / kMostAlong;
  for (std::size_t k = 0; k < along.size(); k += step) {
    json["time"].push_back(time(along[k].time));
    json["hamiltonian"].push_back(rounded(along[k].hamiltonian));
    add("q", along[k].costate.q);
    add("dq", along[k].costate.dq);
    add("theta", along[k].costate.theta);
    add("dtheta", along[k].costate.dtheta);
  }
  return json;
}

}  // namespace

Json joint_or_null(int joint) { return joint == 0 ? Json(nullptr) : Json(joint); }

Json sensitivity_json(const Sensitivity& sensitivity) {
  Json limits = Json::array();
  for (const ShadowPrice& limit : sensitivity.limits) {
    limits.push_back({{"name", limit.name},
                      {"joint", joint_or_null(limit.joint)},
                      {"limit", limit.limit},
                      {"unit", limit.unit},
                      {"worth", rounded(limit.price)},
                      {"saved_by_1_percent", rounded(0.01 * limit.limit * limit.price)},
                      {"active_share", rounded(limit.fraction)},
                      {"active", stretches(limit.active)}});
  }
  Json via = Json::array();
  for (const ViaPrices& v : sensitivity.via) {
    via.push_back({{"time", rounded(v.time, 10)},
                   {"q", rounded(v.q)},
                   {"dq", rounded_or_null(v.dq)},
                   {"later", rounded_or_null(v.later)}});
  }
  return {{"limits", std::move(limits)},
          {"duration", rounded_or_null(sensitivity.duration)},
          {"via", std::move(via)},
          {"goal", {{"q", rounded(sensitivity.goal)}}}};
}

Json optimality_json(const Optimality& optimality) {
  const auto& h = optimality.hamiltonian;
  const auto& s = optimality.stationarity;
  return {{"hamiltonian",
           {{"mean", rounded(h.mean)},
            {"expected", rounded_or_null(h.expected)},
            {"spread", rounded(h.spread)},
            {"allowed", rounded(h.allowed)},
            {"stationary", h.stationary()},
            {"largest_deviation", rounded(h.largest)},
            {"time", time(h.time)}}},
          {"stationarity",
           {{"where_free", rounded(s.free)},
            {"wrong_sign", rounded(s.wrong)},
            {"largest", rounded(s.largest)},
            {"residual", rounded(s.residual)}}},
          {"friction_width", rounded(optimality.friction_width)},
          {"costate", {{"start", costate(optimality.costate_start)}, {"end", costate(optimality.costate_end)}}},
          {"along", along_json(optimality.along)}};
}

Json mesh_errors_json(const std::vector<double>& node_times, const std::vector<double>& errors) {
  Json times = Json::array(), largest = Json::array();
  const std::size_t together = (errors.size() + kMostIntervals - 1) / kMostIntervals;
  for (std::size_t k = 0; k < errors.size(); k += together) {
    const std::size_t end = std::min(k + together, errors.size());
    times.push_back(time(node_times[k]));
    largest.push_back(rounded(*std::max_element(errors.data() + k, errors.data() + end), 3));
  }
  if (!errors.empty()) times.push_back(time(node_times.back()));
  return {{"node_times", std::move(times)}, {"errors", std::move(largest)}};
}

}  // namespace fjr

#include "planner/results/report/objective_text.h"

#include <fmt/format.h>

#include <cmath>
#include <string_view>

#include "planner/results/report/html_table.h"

namespace fjr {

std::vector<WeightedTerm> weighted_terms(const JsonField& plan) {
  const JsonField weights = plan.at("resolved_request").at("objective");
  std::vector<WeightedTerm> terms;
  for (const TermInfo& info : Terms::infos) {
    const auto weight = weights.find(info.name);
    if (weight && weight->number() != 0) terms.push_back({&info, (info.reward ? -1 : 1) * weight->number()});
  }
  return terms;
}

std::string objective_formula(const std::vector<WeightedTerm>& terms) {
  std::string text;
  for (const WeightedTerm& term : terms) {
    const double size = std::abs(term.weight);
    const char* const sign = term.weight < 0 ? (text.empty() ? "-" : " - ") : (text.empty() ? "" : " + ");
    text += fmt::format("{}{}{}", sign, size == 1 ? "" : number_text(size) + " x ", spaced(term.info->name));
  }
  return text.empty() ? "none" : text;
}

std::string objective_unit(const std::vector<WeightedTerm>& terms) {
  return terms.size() == 1 && terms.front().weight == 1 ? terms.front().info->unit : "";
}

Gain Gain::of(const std::vector<WeightedTerm>& objective) {
  const bool alone = objective.size() == 1;
  if (alone && std::string_view(objective[0].info->name) == Time::info.name) return {1e3 / objective[0].weight, "ms"};
  const std::string unit = objective_unit(objective);
  return {1, fmt::format("{}{}of {}", unit, unit.empty() ? "" : " ", objective_formula(objective))};
}

std::string Gain::saved(double objective) const { return number_text(factor * objective, 3); }

}  // namespace fjr

// Writes a Request as a document of one line.
#include <fmt/format.h>

#include <cmath>
#include <string_view>
#include <vector>

#include "planner/request/request.h"
#include "planner/request/words.h"

namespace fjr {
namespace {

// A flow map; numbers in the shortest digits that read back to the same bits.
class Map {
 public:
  void add(std::string_view name, std::string_view text) {
    fmt::format_to(std::back_inserter(text_), "{}{}: {}", text_.empty() ? "" : ", ", name, text);
  }
  std::string text() const { return "{" + text_ + "}"; }

 private:
  std::string text_;
};

template <class T>
std::string text_of(const std::optional<T>& value);
template <class T>
std::string text_of(const std::vector<T>& list);
template <Keyed R>
std::string text_of(const R& r);
template <class Kind, class Variant>
std::string text_of(const OneOf<Kind, Variant>& member);
std::string text_of(const RequestedGoal& goal);
std::string text_of(const RequestedDuration& duration);
std::string text_of(const RequestedTip& tip);

std::string text_of(double value) { return fmt::format("{}", value); }
std::string text_of(std::uint64_t value) { return fmt::format("{}", value); }
std::string text_of(bool value) { return value ? "true" : "false"; }
std::string text_of(const std::string& value) { return quoted_flow(value); }
std::string text_of(const Joints<double>& value) { return fmt::format("[{}, {}]", value[0], value[1]); }

template <Worded Choice>
std::string text_of(Choice value) {
  return std::string(word_of(value));
}

std::string text_of(const AnglesOrFree& angles) {
  const auto one = [](const std::optional<double>& angle) { return angle ? text_of(*angle) : std::string("free"); };
  return fmt::format("[{}, {}]", one(angles[0]), one(angles[1]));
}

std::string text_of(const VelocityOrFree& velocity) {
  const auto* value = std::get_if<Joints<double>>(&velocity);
  return value != nullptr ? text_of(*value) : "free";
}
std::string text_of(const TipBox& box) { return fmt::format("[{}, {}]", text_of(box.lower), text_of(box.upper)); }
std::string text_of(const Payload& payload) {
  const auto entry = [](double value, double error, const PayloadBound& bound) {
    if (error == 0) return text_of(value);
    return fmt::format("{{value: {}, unit: {}, standard_error: {}}}", value, bound.unit, error);
  };
  return fmt::format("{{mass: {}, inertia: {}}}", entry(payload.mass, payload.mass_error, kPayloadMassBound),
                     entry(payload.inertia, payload.inertia_error, kPayloadInertiaBound));
}

std::string text_of_limit(double limit) { return limit == kNoLimit ? ".inf" : text_of(limit); }
std::string text_of_limits(const Joints<double>& limits) {
  return fmt::format("[{}, {}]", text_of_limit(limits[0]), text_of_limit(limits[1]));
}

std::string text_of(const Limits& limits) {
  Map map;
  for (const QuantityInfo& quantity : Quantities::infos) {
    if (!is_limited(quantity, limits)) continue;
    map.add(quantity.name,
            quantity.of_tip ? text_of_limit(limits.*quantity.of_tip) : text_of_limits(limits.*quantity.per_joint));
  }
  return map.text();
}

std::string text_of(const RequestedObjective& objective) {
  if (const auto* preset = std::get_if<Preset>(&objective)) return text_of(*preset);
  const auto& weights = std::get<Weights>(objective);
  Map map;
  for (const TermInfo& term : Terms::infos) {
    if (const double weight = weights.*term.weight; weight != 0) map.add(term.name, text_of(weight));
  }
  return map.text();
}

template <class T>
std::string text_of(const std::vector<T>& list) {
  std::string items;
  for (const T& item : list)
    fmt::format_to(std::back_inserter(items), "{}{}", items.empty() ? "" : ", ", text_of(item));
  return "[" + items + "]";
}

// Whether a value was stated in the request.
template <class T>
bool is_said(const std::optional<T>& value) {
  return value.has_value();
}
template <class T>
bool is_said(const std::vector<T>& list) {
  return !list.empty();
}
bool is_said(const Limits& limits) { return text_of(limits) != "{}"; }
bool is_said(bool value) { return value; }
bool is_said(const RequestedDuration& duration) {
  const auto* free = std::get_if<FreeDuration>(&duration);
  return free == nullptr || free->min || free->max;
}
template <class Kind, class Variant>
bool is_said(const OneOf<Kind, Variant>& member);
template <class T>
bool is_said(const T&) {
  return true;
}

template <class Kind, class Variant>
bool is_said(const OneOf<Kind, Variant>& member) {
  return member.get() != nullptr && is_said(*member.get());
}

template <class T>
std::string text_of(const std::optional<T>& value) {
  return text_of(*value);
}
template <class Kind, class Variant>
std::string text_of(const OneOf<Kind, Variant>& member) {
  return text_of(*member.get());
}

template <Keyed R>
std::string text_of_keys(const R& r) {
  Map map;
  visit(r, [&](const Key& key, const auto& member) {
    if (is_said(member)) map.add(key.name, text_of(member));
  });
  return map.text();
}

std::string text_of(const RequestedDuration& duration) {
  const auto* fixed = std::get_if<double>(&duration);
  return fixed != nullptr ? text_of(*fixed) : text_of_keys(std::get<FreeDuration>(duration));
}

std::string text_of(const RequestedGoal& goal) { return text_of_keys(by_key(goal)); }

std::string text_of(const RequestedTip& tip) { return text_of_keys(by_kind(tip)); }

template <Keyed R>
std::string text_of(const R& r) {
  return text_of_keys(r);
}

}  // namespace

std::string format_request(const Request& request) { return text_of(request); }

std::vector<std::string> said_keys(const Request& request) {
  std::vector<std::string> keys;
  visit(request, [&](const Key& key, const auto& member) {
    if (is_said(member)) keys.emplace_back(key.name);
  });
  return keys;
}

}  // namespace fjr

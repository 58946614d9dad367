#include "planner/results/planned_with.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string_view>

#include "common/input_error.h"

namespace fjr {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kPayload = "payload";
constexpr const char* kPayloadInertia = "payload.inertia";

std::string in_unit(double value, std::string_view unit) { return fmt::format("{} {}", value, unit); }

std::string key_of(const LimitName& limit) {
  const char* name = limit.quantity->name;
  return limit.joint == 0 ? fmt::format("limits.{}", name) : fmt::format("limits.{}[{}]", name, limit.j());
}

std::optional<double> limit_in(const Json& limits, const LimitName& limit) {
  const auto found = limits.find(limit.quantity->name);
  if (found == limits.end()) return std::nullopt;
  const Json& value = limit.joint == 0 ? *found : found->at(limit.j());
  return value.is_number() ? std::optional(value.get<double>()) : std::nullopt;
}

// "10 N m"
double read(const Metadata& metadata, const std::string& key, std::string_view unit, bool may_be_zero,
            const std::string& source) {
  const std::string& text = metadata.at(key);
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  const std::string_view rest(end, static_cast<std::size_t>(text.data() + text.size() - end));
  const bool valid = error == std::errc() && rest == fmt::format(" {}", unit) && std::isfinite(value);
  if (valid && (value > 0 || (may_be_zero && value == 0))) return value;
  throw InputError(source, key,
                   fmt::format("'{}' must be a number {} 0 and its unit, such as '{}'", text, may_be_zero ? ">=" : ">",
                               in_unit(0.5, unit)));
}

}  // namespace

std::string LimitInHeader::key() const { return key_of(kLimitNames[index]); }

std::string LimitInHeader::text() const { return fmt::format("{} {}", key(), in_unit(value, unit())); }

std::string text_of(const Payload& payload) {
  const std::string mass = in_unit(payload.mass, "kg");
  return payload.inertia == 0 ? mass : fmt::format("{}, {}", mass, in_unit(payload.inertia, "kg m^2"));
}

void tell_planned_with(const Json& plan, Metadata& metadata) {
  const Json &payload = plan.at("robot").at("payload"), &robot = plan.at("robot").at("limits");
  const double inertia = payload.at("inertia");
  metadata[kPayload] = in_unit(payload.at("mass"), "kg");
  if (inertia != 0) metadata[kPayloadInertia] = in_unit(inertia, "kg m^2");
  const Json& limits = plan.at("resolved_request").at("limits");
  for (const LimitName& name : kLimitNames) {
    const auto limit = limit_in(limits, name), of_robot = limit_in(robot, name);
    if (limit && (!of_robot || *limit < *of_robot)) metadata[key_of(name)] = in_unit(*limit, name.quantity->unit);
  }
}

std::string leaves_out(const LimitName& limit, double planned) {
  return fmt::format("does not say that {}{} was limited to {} {}, as its request does", limit.quantity->name,
                     limit.joint == 0 ? "" : fmt::format(" of joint {}", limit.joint), planned, limit.quantity->unit);
}

Limits limits_of(const Parameters& robot, const PlannedWith& header) {
  Limits limits = Limits::of(robot);
  for (const LimitInHeader& limit : header.limits) {
    double& held = kLimitNames[limit.index].in(limits);
    held = std::min(held, limit.value);
  }
  return limits;
}

PlannedWith planned_with(const Metadata& metadata, const std::string& source) {
  PlannedWith result;
  if (metadata.contains(kPayload)) result.payload = {read(metadata, kPayload, "kg", true, source), 0};
  if (metadata.contains(kPayloadInertia)) {
    if (!result.payload) throw InputError(source, kPayloadInertia, "goes with a payload");
    result.payload->inertia = read(metadata, kPayloadInertia, "kg m^2", true, source);
  }
  for (std::size_t i = 0; i < kLimits; ++i) {
    const std::string key = key_of(kLimitNames[i]);
    if (metadata.contains(key)) {
      result.limits.push_back({i, read(metadata, key, kLimitNames[i].quantity->unit, false, source)});
    }
  }
  const auto known = [&](const std::string& key) {
    return std::any_of(result.limits.begin(), result.limits.end(),
                       [&](const auto& limit) { return limit.key() == key; });
  };
  for (const auto& [key, value] : metadata) {
    if (key.starts_with("limits.") && !known(key)) {
      throw InputError(source, key, "is no limit that a request may set, such as limits.torque[0]");
    }
  }
  return result;
}

}  // namespace fjr

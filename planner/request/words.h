// The words for choices in a request.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "planner/request/request_keys.h"

namespace fjr {

template <class Choice>
inline constexpr std::array<std::pair<std::string_view, Choice>, 0> kWords{};
template <>
inline constexpr std::array<std::pair<std::string_view, Elbow>, 3> kWords<Elbow>{
    {{"any", Elbow::kAny}, {"left", Elbow::kLeft}, {"right", Elbow::kRight}}};
template <>
inline constexpr std::array<std::pair<std::string_view, ArcWay>, 2> kWords<ArcWay>{
    {{"short", ArcWay::kShort}, {"long", ArcWay::kLong}}};
template <>
inline constexpr std::array<std::pair<std::string_view, Preset>, 3> kWords<Preset>{
    {{"fastest", Preset::kFastest}, {"gentle", Preset::kGentle}, {"efficient", Preset::kEfficient}}};
template <>
inline constexpr std::array<std::pair<std::string_view, Thoroughness>, 3> kWords<Thoroughness>{
    {{"quick", Thoroughness::kQuick}, {"default", Thoroughness::kDefault}, {"thorough", Thoroughness::kThorough}}};

template <class Choice>
concept Worded = kWords<Choice>
.size() > 0;

template <Worded Choice>
std::string_view word_of(Choice choice) {
  for (const auto& [word, other] : kWords<Choice>) {
    if (other == choice) return word;
  }
  return {};
}

// A part of a request with keys of its own. fjr:: is explicit because a variant would find std::visit.
template <class R>
concept Keyed = requires(R& r) {
  fjr::visit(r, [](const Key&, auto&) {});
};

}  // namespace fjr

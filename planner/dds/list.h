// Pairs and sequences of the wire types, as idlc makes them.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <type_traits>
#include <vector>

#include "planner/trajectory/trajectory.h"

namespace fjr::dds {

inline void set_pair(double (&to)[2], const std::array<double, 2>& from) { std::copy(from.begin(), from.end(), to); }
inline Joints<double> pair_of(const double (&from)[2]) { return {from[0], from[1]}; }

// Makes a list of the wire from const data. The lists are not const, but writing only reads them.
template <class List, class T>
void point_to(List& list, const T* data, std::size_t size, std::size_t most) {
  if (size > most) throw std::length_error("more than the wire type allows");
  list._length = list._maximum = static_cast<std::uint32_t>(size);
  list._buffer = reinterpret_cast<decltype(list._buffer)>(const_cast<T*>(data));
}

// Copies a list of the wire; the items must have the layout of the list's elements.
template <class List, class Items>
void copy_list(const List& from, Items& to) {
  static_assert(sizeof(*from._buffer) == sizeof(to[0]) && std::is_trivially_copyable_v<typename Items::value_type>);
  to.resize(from._length);
  if (!to.empty()) std::memcpy(static_cast<void*>(to.data()), from._buffer, to.size() * sizeof(to[0]));
}

template <class List>
std::string_view bytes_of(const List& list) {
  return {reinterpret_cast<const char*>(list._buffer), list._length};
}

}  // namespace fjr::dds

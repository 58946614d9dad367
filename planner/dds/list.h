// Sequences of the wire types, as idlc makes them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <stdexcept>

namespace fjr::dds {

// The wire's lists are not const, and only read when written.
template <class List, class T>
void point_to(List& list, const T* data, std::size_t size, std::size_t most) {
  if (size > most) throw std::length_error("more than the wire type allows");
  list._length = list._maximum = static_cast<std::uint32_t>(size);
  list._buffer = reinterpret_cast<decltype(list._buffer)>(const_cast<T*>(data));
}

}  // namespace fjr::dds

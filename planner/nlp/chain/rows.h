// A row-major matrix of doubles for vector instructions: every row begins at a multiple of 32 bytes and is padded to a
// multiple of 32 bytes. resize() keeps the memory if it suffices.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

namespace fjr {

constexpr int kLanes = 4;

constexpr int padded(int count) { return (count + kLanes - 1) / kLanes * kLanes; }

class Rows {
 public:
  // Entries are undefined afterwards.
  void resize(int rows, int columns) {
    blocks_ = static_cast<std::size_t>(padded(columns) / kLanes);
    data_.resize(static_cast<std::size_t>(rows) * blocks_);
  }
  void resize_to_zero(int rows, int columns) {
    blocks_ = static_cast<std::size_t>(padded(columns) / kLanes);
    data_.resize(static_cast<std::size_t>(rows) * blocks_);
    if (!data_.empty()) std::fill_n(data_[0].lanes, data_.size() * kLanes, 0.0);
  }

  int width() const { return static_cast<int>(blocks_) * kLanes; }
  double* row(int i) { return data_[static_cast<std::size_t>(i) * blocks_].lanes; }
  const double* row(int i) const { return data_[static_cast<std::size_t>(i) * blocks_].lanes; }
  double* data() { return data_.empty() ? nullptr : data_[0].lanes; }
  const double* data() const { return data_.empty() ? nullptr : data_[0].lanes; }

 private:
  struct alignas(kLanes * sizeof(double)) Block {
    double lanes[kLanes];
  };
  std::size_t blocks_ = 0;
  std::vector<Block> data_;
};

}  // namespace fjr

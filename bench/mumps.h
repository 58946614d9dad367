// MUMPS as Ipopt uses it - symmetric indefinite, sequential - on a matrix given by triplets of one triangle: what the
// chain factorisation is compared with.
#pragma once

#include <dmumps_c.h>

#include <span>
#include <vector>

namespace fjr::bench {

class Mumps {
 public:
  // 0-based; repeated entries add up.
  Mumps(int size, std::vector<int> rows, std::vector<int> cols, std::vector<double> values)
      : rows_(std::move(rows)), cols_(std::move(cols)), values_(std::move(values)) {
    for (int& i : rows_) ++i;
    for (int& i : cols_) ++i;
    data_.sym = 2;
    data_.par = 1;
    data_.comm_fortran = -987654;
    run(-1);
    for (const int output : {0, 1, 2, 3}) data_.icntl[output] = 0;  // silent
    data_.icntl[13] = 1000;                                         // more work space than estimated, as Ipopt grants
    data_.n = size;
    data_.nz = static_cast<int>(values_.size());
    data_.irn = rows_.data();
    data_.jcn = cols_.data();
    data_.a = values_.data();
    run(1);
  }
  ~Mumps() { run(-2); }
  Mumps(const Mumps&) = delete;
  Mumps& operator=(const Mumps&) = delete;

  bool factorise() {
    run(2);
    return data_.info[0] >= 0;
  }
  int negative_eigenvalues() const { return data_.infog[11]; }
  void solve(std::span<double> right_hand_side) {
    data_.nrhs = 1;
    data_.rhs = right_hand_side.data();
    run(3);
  }

 private:
  void run(int job) {
    data_.job = job;
    dmumps_c(&data_);
  }

  std::vector<int> rows_, cols_;
  std::vector<double> values_;
  DMUMPS_STRUC_C data_{};
};

}  // namespace fjr::bench

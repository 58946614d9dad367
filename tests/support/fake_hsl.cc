// Stands in for a user's HSL library: MA27 by its calling convention, done by MUMPS. Says at the end how often it was
// asked, if at all.
#include <algorithm>
#include <cstdio>
#include <memory>
#include <span>
#include <vector>

#include "bench/mumps.h"

namespace {

struct Report {
  int factorisations = 0;
  ~Report() {
    if (factorisations > 0) std::fprintf(stderr, "fake HSL: %d factorisations\n", factorisations);
  }
} report;

std::vector<int> zero_based(const int* indices, int count) {
  std::vector<int> result(indices, indices + count);
  for (int& i : result) --i;
  return result;
}

std::unique_ptr<fjr::bench::Mumps> factor;

}  // namespace

extern "C" {

void ma27id_(int* icntl, double* cntl) {
  std::fill_n(icntl, 30, 0);
  std::fill_n(cntl, 5, 0.0);
}

void ma27ad_(const int* n, const int* nz, const int* irn, const int* icn, int*, const int*, int*, int*, int* nsteps,
             const int*, const int*, const double*, int* info, double* ops) {
  std::fill_n(info, 20, 0);
  info[4] = info[5] = std::max(*nz, 1);
  *nsteps = 1;
  *ops = 0;
  factor = std::make_unique<fjr::bench::Mumps>(*n, zero_based(irn, *nz), zero_based(icn, *nz),
                                               std::vector<double>(static_cast<std::size_t>(*nz), 1.0));
}

void ma27bd_(const int*, const int* nz, const int*, const int*, const double* a, const int*, int*, const int*, int*,
             const int*, int* maxfrt, int*, const int*, const double*, int* info) {
  std::fill_n(info, 20, 0);
  *maxfrt = 1;
  ++report.factorisations;
  std::copy_n(a, *nz, factor->values().begin());
  if (!factor->factorise()) info[0] = -5;
  info[14] = factor->negative_eigenvalues();
}

void ma27cd_(const int* n, const double*, const int*, const int*, const int*, double*, const int*, double* rhs, int*,
             const int*, const int*, const double*) {
  factor->solve(std::span(rhs, static_cast<std::size_t>(*n)));
}

}  // extern "C"

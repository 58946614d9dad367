#include "planner/nlp/chain/ma27.h"

#include <dlfcn.h>

#include <algorithm>
#include <exception>
#include <limits>
#include <span>
#include <stdexcept>
#include <utility>
#include <vector>

#include "common/cpu_time.h"

namespace fjr {
namespace {

thread_local ChainStructure described;
thread_local DoBoth halves = one_after_the_other;
thread_local ChainLdlt factor;
thread_local std::vector<int> rows, cols;
thread_local int factorised = 0;
thread_local double multiplied = 0;
thread_local double seconds = 0;

}  // namespace

void describe_chain(ChainStructure structure, DoBoth both) {
  described = std::move(structure);
  halves = std::move(both);
}

int factorisations() { return factorised; }
double multiplications() { return multiplied; }
double chain_seconds() { return seconds; }

std::string chain_library() {
  static const char here = 0;
  Dl_info library{};
  if (dladdr(&here, &library) == 0) throw std::logic_error("this code is in no file");
  return library.dli_fname;
}

}  // namespace fjr

// The Fortran interface of MA27 (HSL specification): every argument by address, arrays 1-based. Only what Ipopt reads
// is set: info(1) status, info(5) and info(6) recommended lengths, info(15) negative eigenvalues; the rest is zero. The
// factors stay in `factor`, so of the caller's work space nothing is used.
extern "C" {

void ma27id_(int* icntl, double* cntl) {
  std::fill_n(icntl, 30, 0);
  std::fill_n(cntl, 5, 0.0);
  cntl[0] = 0.1;
}

void ma27ad_(const int* n, const int* nz, const int* irn, const int* icn, int* /*iw*/, const int* /*liw*/,
             int* /*ikeep*/, int* /*iw1*/, int* nsteps, const int* /*iflag*/, const int* /*icntl*/,
             const double* /*cntl*/, int* info, double* ops) {
  std::fill_n(info, 20, 0);
  *ops = 0;
  *nsteps = 1;
  const auto count = static_cast<std::size_t>(*nz);
  info[4] = std::max(*nz, 1);
  info[5] = std::max(*nz, 1);
  if (fjr::described.block.size() != static_cast<std::size_t>(*n)) {
    info[0] = -1;  // "N out of range": describe_chain() was not called for this matrix
    return;
  }
  const fjr::CpuTimed timed(fjr::seconds);
  fjr::rows.resize(count);
  fjr::cols.resize(count);
  const auto zero_based = [](int i) { return i - 1; };
  std::transform(irn, irn + count, fjr::rows.begin(), zero_based);
  std::transform(icn, icn + count, fjr::cols.begin(), zero_based);
  try {
    fjr::factor.analyse(fjr::rows, fjr::cols, fjr::described);
  } catch (const std::exception&) {
    info[0] = -1;
  }
}

void ma27bd_(const int* /*n*/, const int* nz, const int* /*irn*/, const int* /*icn*/, const double* a,
             const int* /*la*/, int* /*iw*/, const int* /*liw*/, int* /*ikeep*/, const int* /*nsteps*/, int* maxfrt,
             int* /*iw1*/, const int* /*icntl*/, const double* cntl, int* info) {
  const fjr::CpuTimed timed(fjr::seconds);
  std::fill_n(info, 20, 0);
  *maxfrt = 1;
  ++fjr::factorised;
  const double threshold = std::clamp(cntl[0], 1e-10, 0.5);
  const std::span<const double> values(a, static_cast<std::size_t>(*nz));
  constexpr int kAnyInertia = std::numeric_limits<int>::max();
  const fjr::ChainLdlt::Outcome outcome = fjr::factor.factorise(values, threshold, kAnyInertia, fjr::halves);
  if (outcome == fjr::ChainLdlt::Outcome::kSingular) info[0] = -5;
  fjr::multiplied += fjr::factor.factorisation_work();
  info[14] = fjr::factor.negative_eigenvalues();
}

void ma27cd_(const int* n, const double* /*a*/, const int* /*la*/, const int* /*iw*/, const int* /*liw*/, double* /*w*/,
             const int* /*maxfrt*/, double* rhs, int* /*iw1*/, const int* /*nsteps*/, const int* /*icntl*/,
             const double* /*cntl*/) {
  const fjr::CpuTimed timed(fjr::seconds);
  fjr::factor.solve(std::span(rhs, static_cast<std::size_t>(*n)), fjr::halves);
  fjr::multiplied += fjr::factor.solve_work();
}

}  // extern "C"

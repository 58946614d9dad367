// The products of small matrices that a block is made of. Matrices and vectors are padded and aligned as in
// rows.h.
#pragma once

#include <span>

namespace fjr {

// to += scale * S z for the square S of which row i is that of `s` + i * s_width, taken at the given columns: z and to
// have one row per column, of `width`. Zeros of S are skipped: structure puts many there.
void add_product(double scale, const double* s, int s_width, std::span<const int> columns, const double* z, int width,
                 double* to);

// to = u' z: u and z are rows x width, of u the first `count` columns are used; to is count x width.
void transposed_product(const double* u, int count, const double* z, int rows, int width, double* to);

// to = A x: A is rows x width.
void times_vector(const double* a, int rows, int width, const double* x, double* to);

// to = A' x: x has one number per row.
void transposed_times_vector(const double* a, int rows, int width, const double* x, double* to);

}  // namespace fjr

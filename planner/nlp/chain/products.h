// Products of the small matrices of a block. Matrices and vectors are padded and aligned as in rows.h.
#pragma once

#include <span>

namespace fjr {

// to += scale * S z. Row i of the square matrix S consists of the given columns of the row at s + i * s_width; z and
// `to` have one row of `width` per column of S. Zeros of S are skipped, because its sparsity leaves many.
void add_product(double scale, const double* s, int s_width, std::span<const int> columns, const double* z, int width,
                 double* to);

// to = u' z: u and z are (rows x width), only the first `count` columns of u are used, `to` is (count x width).
void transposed_product(const double* u, int count, const double* z, int rows, int width, double* to);

// to = A x: A is rows x width.
void times_vector(const double* a, int rows, int width, const double* x, double* to);

// to = A' x: x has one number per row.
void transposed_times_vector(const double* a, int rows, int width, const double* x, double* to);

}  // namespace fjr

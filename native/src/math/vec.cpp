#include "math/vec.h"

#include <stdexcept>

namespace photon_splat {

double determinant(const Affine& a) {
  const auto& m = a.m;
  return double(m[0]) * (double(m[5]) * m[10] - double(m[6]) * m[9]) -
         double(m[1]) * (double(m[4]) * m[10] - double(m[6]) * m[8]) +
         double(m[2]) * (double(m[4]) * m[9] - double(m[5]) * m[8]);
}

Affine inverse(const Affine& a) {
  const auto& m = a.m;
  const double det = determinant(a);
  if (!(std::abs(det) > 0.0))
    throw std::invalid_argument("an instance has a matrix without inverse");
  const double s = 1.0 / det;
  const double r[9] = {(double(m[5]) * m[10] - double(m[6]) * m[9]) * s,
                       (double(m[2]) * m[9] - double(m[1]) * m[10]) * s,
                       (double(m[1]) * m[6] - double(m[2]) * m[5]) * s,
                       (double(m[6]) * m[8] - double(m[4]) * m[10]) * s,
                       (double(m[0]) * m[10] - double(m[2]) * m[8]) * s,
                       (double(m[2]) * m[4] - double(m[0]) * m[6]) * s,
                       (double(m[4]) * m[9] - double(m[5]) * m[8]) * s,
                       (double(m[1]) * m[8] - double(m[0]) * m[9]) * s,
                       (double(m[0]) * m[5] - double(m[1]) * m[4]) * s};
  Affine out;
  for (int row = 0; row < 3; ++row) {
    double translation = 0;
    for (int col = 0; col < 3; ++col) {
      out.m[row * 4 + col] = static_cast<float>(r[row * 3 + col]);
      translation -= r[row * 3 + col] * double(m[col * 4 + 3]);
    }
    out.m[row * 4 + 3] = static_cast<float>(translation);
  }
  return out;
}

}  // namespace photon_splat

// SPDX-License-Identifier: Apache-2.0
// Discrete Fourier transform of any length, fast for small prime factors. Wraps Eigen's, which compiles
// slowly.
#pragma once

#include <complex>
#include <cstddef>
#include <memory>
#include <vector>

namespace ifog {

// Caches the tables of used lengths. Not thread-safe.
class Fourier {
 public:
  Fourier();
  ~Fourier();

  // All n coefficients, Σ x(i) exp(-2πj i k/n).
  void forward(std::vector<std::complex<double>>& spectrum, const std::vector<double>& values);
  void forward(std::vector<std::complex<double>>& spectrum, const std::vector<std::complex<double>>& values);
  // Inverse transform, with the factor 1/n.
  void inverse(std::vector<std::complex<double>>& values, const std::vector<std::complex<double>>& spectrum);
  void inverse(std::vector<double>& values, const std::vector<std::complex<double>>& spectrum);

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

// Largest length up to n with factors 2, 3, 5 only.
inline std::size_t smooth_length(std::size_t n) {
  for (; n > 1; --n) {
    std::size_t left = n;
    for (const std::size_t factor : {2U, 3U, 5U})
      while (left % factor == 0) left /= factor;
    if (left == 1) break;
  }
  return n;
}

// Squares of the first n/2 + 1 coefficients (frequencies from zero to half the sample rate).
std::vector<double> power_spectrum(const std::vector<double>& values);

}  // namespace ifog

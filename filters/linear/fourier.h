// SPDX-License-Identifier: Apache-2.0
// Discrete Fourier transform of any length, fast where it has small prime factors. Eigen's: here because it takes a
// compiler seconds, and half a dozen files use it.
#pragma once

#include <complex>
#include <memory>
#include <vector>

namespace ifog {

// Keeps the tables of the lengths it has had. Not for two threads at once.
class Fourier {
 public:
  Fourier();
  ~Fourier();

  // All n coefficients, Σ x(i) exp(-2πj i k/n).
  void forward(std::vector<std::complex<double>>& spectrum, const std::vector<double>& values);
  void forward(std::vector<std::complex<double>>& spectrum, const std::vector<std::complex<double>>& values);
  // Back again, with the factor 1/n.
  void inverse(std::vector<std::complex<double>>& values, const std::vector<std::complex<double>>& spectrum);
  void inverse(std::vector<double>& values, const std::vector<std::complex<double>>& spectrum);

 private:
  struct Tables;
  std::unique_ptr<Tables> tables_;
};

// Squares of the first n/2 + 1 coefficients, those of frequencies from zero to half the sample rate.
std::vector<double> power_spectrum(const std::vector<double>& values);

}  // namespace ifog

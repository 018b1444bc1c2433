// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/periodogram.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <complex>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <vector>

namespace ifog {
namespace {

using Complex = std::complex<double>;

// Columns, or rows, that are worked on together: of each row a page of the file.
constexpr std::size_t kTogether = 256;

bool is_smooth(std::size_t length) {
  for (const std::size_t prime : {2U, 3U, 5U})
    while (length % prime == 0) length /= prime;
  return length == 1;
}

Samples power_in_memory(std::span<const double> error, double mean) {
  std::vector<double> values(error.size());
  for (std::size_t i = 0; i < values.size(); ++i) values[i] = std::isfinite(error[i]) ? error[i] - mean : 0.0;
  Eigen::FFT<double> fft;
  fft.SetFlag(Eigen::FFT<double>::HalfSpectrum);
  std::vector<Complex> bins;
  fft.fwd(bins, values);
  Samples power(bins.size());
  for (std::size_t k = 0; k < bins.size(); ++k) power[k] = std::norm(bins[k]);
  return power;
}

// exp(-i 2 pi m / n) for m below n, by two tables of the root of n, a power of two: a division would cost
// more than all the rest.
class UnitRoots {
 public:
  explicit UnitRoots(std::size_t n) : bits_(static_cast<std::size_t>(std::bit_width(n)) / 2 + 1) {
    const std::size_t step = std::size_t{1} << bits_;
    const double turn = -2.0 * std::numbers::pi / static_cast<double>(n);
    for (std::size_t i = 0; i < step; ++i) {
      fine_.push_back(std::polar(1.0, turn * static_cast<double>(i)));
      coarse_.push_back(std::polar(1.0, turn * static_cast<double>(i << bits_)));
    }
  }
  [[nodiscard]] Complex operator[](std::size_t m) const {
    return coarse_[m >> bits_] * fine_[m & ((std::size_t{1} << bits_) - 1)];
  }

 private:
  std::size_t bits_;
  std::vector<Complex> fine_, coarse_;
};

// Samples two by two as complex numbers, in rows one behind the other: their transform is made of those of
// the columns and of the rows, and stands with bin k1 + rows k2 in row k1, column k2.
class PairedTransform {
 public:
  PairedTransform(std::span<const double> error, double mean) : size_(error.size() / 2), values_(size_) {
    for (rows_ = static_cast<std::size_t>(std::sqrt(static_cast<double>(size_))); size_ % rows_ != 0;)
      --rows_;
    columns_ = size_ / rows_;
    const auto at = [&](std::size_t i) { return std::isfinite(error[i]) ? error[i] - mean : 0.0; };
    for (std::size_t i = 0; i < size_; ++i) values_[i] = {at(2 * i), at(2 * i + 1)};
    transform_columns();
    transform_rows();
  }

  // Of the samples as they are, from bins k and size - k of their pairs.
  [[nodiscard]] Samples power() const {
    const UnitRoots roots(2 * size_);
    Samples power(size_ + 1);
    for (std::size_t from = 0; from < rows_; from += kTogether)
      for (std::size_t k2 = 0; k2 < columns_; ++k2)
        for (std::size_t k1 = from; k1 < std::min(from + kTogether, rows_); ++k1) {
          const std::size_t k = k1 + rows_ * k2;
          const Complex one = values_[k1 * columns_ + k2];
          const Complex other = std::conj(mirrored(k1, k2));
          const Complex odd = Complex(0.0, -0.5) * (one - other);
          power[k] = std::norm(0.5 * (one + other) + roots[k] * odd);
        }
    const Complex first = values_.front();
    power.back() = std::pow(first.real() - first.imag(), 2.0);
    return power;
  }

 private:
  // Of bin size - k; 0 is its own.
  [[nodiscard]] Complex mirrored(std::size_t k1, std::size_t k2) const {
    if (k1 == 0) return values_[(columns_ - k2) % columns_];
    return values_[(rows_ - k1) * columns_ + columns_ - 1 - k2];
  }

  void transform_columns() {
    const UnitRoots roots(size_);
    Eigen::FFT<double> fft;
    std::vector<Complex> some(kTogether * rows_), bins(rows_);
    for (std::size_t from = 0; from < columns_; from += kTogether) {
      const std::size_t count = std::min(kTogether, columns_ - from);
      for (std::size_t row = 0; row < rows_; ++row)
        for (std::size_t c = 0; c < count; ++c) some[c * rows_ + row] = values_[row * columns_ + from + c];
      for (std::size_t c = 0; c < count; ++c) {
        Complex* const column = some.data() + c * rows_;
        fft.fwd(bins.data(), column, static_cast<Eigen::Index>(rows_));
        std::size_t turns = 0;  // (from + c) row, below size_: both are below it and so is the product
        for (std::size_t row = 0; row < rows_; ++row, turns += from + c)
          column[row] = bins[row] * roots[turns];
      }
      for (std::size_t row = 0; row < rows_; ++row)
        for (std::size_t c = 0; c < count; ++c) values_[row * columns_ + from + c] = some[c * rows_ + row];
    }
  }

  void transform_rows() {
    Eigen::FFT<double> fft;
    std::vector<Complex> bins(columns_);
    for (std::size_t row = 0; row < rows_; ++row) {
      Complex* const values = values_.data() + row * columns_;
      fft.fwd(bins.data(), values, static_cast<Eigen::Index>(columns_));
      std::copy(bins.begin(), bins.end(), values);
    }
  }

  std::size_t size_, rows_ = 0, columns_ = 0;
  FiledVector<Complex> values_;
};

}  // namespace

double mean_of_present(std::span<const double> values) {
  double sum = 0.0;
  std::size_t n = 0;
  for (const double v : values) {
    if (std::isfinite(v)) {
      sum += v;
      ++n;
    }
  }
  return n ? sum / static_cast<double>(n) : 0.0;
}

Periodogram periodogram(std::span<const double> error, std::size_t in_memory) {
  const bool pairs = error.size() > in_memory;
  Periodogram out;
  out.length = error.size();
  while (out.length > 16 && (!is_smooth(out.length) || (pairs && out.length % 2 != 0))) --out.length;
  const double mean = mean_of_present(error);
  const std::span<const double> used = error.first(out.length);
  out.power = pairs ? PairedTransform(used, mean).power() : power_in_memory(used, mean);
  return out;
}

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/paired_transform.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <numbers>
#include <unsupported/Eigen/FFT>
#include <utility>

#include "filters/series/mapped_file.h"
#include "filters/series/samples_writer.h"

namespace ifog {
namespace {

using Complex = PairedTransform::Complex;

constexpr std::size_t kColumnsTogether = 256;  // of each row a page
constexpr std::size_t kRowsTogether = 64;
constexpr std::size_t kTogether = std::size_t{1} << 17U;  // numbers read or written in one go

std::size_t rows_of(std::size_t size) {
  auto rows = static_cast<std::size_t>(std::sqrt(static_cast<double>(size)));
  while (size % rows != 0) --rows;
  return rows;
}

// As the operator, without its look at what is not finite.
Complex times(const Complex& a, const Complex& b) {
  return {a.real() * b.real() - a.imag() * b.imag(), a.real() * b.imag() + a.imag() * b.real()};
}

// As many rows at once as are read or written in one go.
std::size_t at_once(std::size_t columns) { return std::max<std::size_t>(1, kTogether / columns); }

}  // namespace

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
    return times(coarse_[m >> bits_], fine_[m & ((std::size_t{1} << bits_) - 1)]);
  }

 private:
  std::size_t bits_;
  std::vector<Complex> fine_, coarse_;
};

PairedTransform::PairedTransform(std::span<const double> error, double mean)
    : size_(error.size() / 2),
      rows_(rows_of(size_)),
      columns_(size_ / rows_),
      values_(rows_, columns_, kColumnsTogether) {
  lay_out(error, mean);
  transform_columns();
}

void PairedTransform::lay_out(std::span<const double> error, double mean) {
  const std::size_t together = at_once(columns_);
  std::vector<Complex> some(values_.widest() * together);
  const auto at = [&](double value) { return std::isfinite(value) ? value - mean : 0.0; };
  for (std::size_t row = 0; row < rows_; row += together) {
    const std::size_t count = std::min(together, rows_ - row);
    const std::span<const double> all = error.subspan(2 * row * columns_, 2 * count * columns_);
    expect_reading(all.data(), all.size_bytes());
    for (std::size_t b = 0; b < values_.blocks(); ++b) {
      Complex* to = some.data();
      for (std::size_t r = 0; r < count; ++r) {
        const double* from = all.data() + 2 * (r * columns_ + values_.begin(b));
        for (std::size_t c = 0; c < values_.width(b); ++c, from += 2) *to++ = {at(from[0]), at(from[1])};
      }
      values_.write(b, row, count, some.data());
    }
  }
}

void PairedTransform::transform_columns() {
  const UnitRoots roots(size_);
  std::vector<Complex> columns(values_.widest() * rows_), piece(values_.widest() * kRowsTogether);
  for (std::size_t b = 0; b < values_.blocks(); ++b) {
    const std::size_t width = values_.width(b);
    for (std::size_t row = 0; row < rows_; row += kRowsTogether) {
      const std::size_t count = std::min(kRowsTogether, rows_ - row);
      values_.read(b, row, count, piece.data());
      for (std::size_t c = 0; c < width; ++c)
        for (std::size_t r = 0; r < count; ++r) columns[c * rows_ + row + r] = piece[r * width + c];
    }
    transform_columns(b, roots, columns);
    for (std::size_t row = 0; row < rows_; row += kRowsTogether) {
      const std::size_t count = std::min(kRowsTogether, rows_ - row);
      for (std::size_t c = 0; c < width; ++c)
        for (std::size_t r = 0; r < count; ++r) piece[r * width + c] = columns[c * rows_ + row + r];
      values_.write(b, row, count, piece.data());
    }
  }
}

void PairedTransform::transform_columns(std::size_t block, const UnitRoots& roots,
                                        std::vector<Complex>& columns) const {
  Eigen::FFT<double> fft;
  std::vector<Complex> bins(rows_);
  for (std::size_t c = 0; c < values_.width(block); ++c) {
    Complex* const column = columns.data() + c * rows_;
    fft.fwd(bins.data(), column, static_cast<Eigen::Index>(rows_));
    const std::size_t turn = values_.begin(block) + c;
    std::size_t turns = 0;  // turn times row, below size_: both are below it and so is the product
    for (std::size_t row = 0; row < rows_; ++row, turns += turn) column[row] = times(bins[row], roots[turns]);
  }
}

void PairedTransform::load(std::size_t first, std::size_t count, Rows& rows) const {
  rows.first = first;
  rows.count = count;
  rows.values.resize(count * columns_);
  rows.piece.resize(std::max(count * values_.widest(), columns_));
  for (std::size_t b = 0; b < values_.blocks(); ++b) {
    const std::size_t width = values_.width(b);
    values_.read(b, first, count, rows.piece.data());
    for (std::size_t r = 0; r < count; ++r)
      std::copy_n(rows.piece.data() + r * width, width, rows.values.data() + r * columns_ + values_.begin(b));
  }
  Eigen::FFT<double> fft;
  for (std::size_t r = 0; r < count; ++r) {
    Complex* const row = rows.values.data() + r * columns_;
    fft.fwd(rows.piece.data(), row, static_cast<Eigen::Index>(columns_));
    std::copy_n(rows.piece.data(), columns_, row);
  }
}

// From bins k and size - k of the pairs. partners: rows_ less these, the last first; of row 0 itself.
void PairedTransform::put_power(const Rows& rows, const Rows& partners, const UnitRoots& roots,
                                std::size_t block, Powers& powers) const {
  std::vector<double> power(columns_ * rows.count);
  for (std::size_t k2 = 0; k2 < columns_; ++k2) {
    const std::size_t mirrored = rows.first == 0 ? (columns_ - k2) % columns_ : columns_ - 1 - k2;
    for (std::size_t r = 0; r < rows.count; ++r) {
      const Complex one = rows.values[r * columns_ + k2];
      const Complex other = std::conj(partners.values[(rows.count - 1 - r) * columns_ + mirrored]);
      const Complex odd = times(Complex(0.0, -0.5), one - other);
      power[k2 * rows.count + r] =
          std::norm(0.5 * (one + other) + times(roots[rows.first + r + rows_ * k2], odd));
    }
  }
  powers.write(block, 0, columns_, power.data());
}

// Rows are k2 here, and columns k1: blocks of those whose partners are another block, but for the first row
// and, where it is its own partner, the middle one.
PairedTransform::Powers PairedTransform::power_by_row() const {
  const std::size_t half = (rows_ + 1) / 2;
  std::vector<std::size_t> begins{0};
  for (std::size_t from = 1; from < half; from += kRowsTogether) begins.push_back(from);
  const std::size_t pairs = begins.size() - 1;
  const bool middle = rows_ > 1 && rows_ % 2 == 0;
  if (middle) begins.push_back(half);
  for (std::size_t p = pairs; p-- > 0;)
    begins.push_back(rows_ + 1 - std::min(begins[p + 1] + kRowsTogether, half));
  Powers powers(columns_, rows_, begins);
  const UnitRoots roots(2 * size_);
  Rows top, bottom;
  load(0, 1, top);
  put_power(top, top, roots, 0, powers);
  if (middle) {
    load(half, 1, top);
    put_power(top, top, roots, pairs + 1, powers);
  }
  for (std::size_t p = 0; p < pairs; ++p) {
    const std::size_t count = powers.width(1 + p), partner = powers.blocks() - 1 - p;
    load(powers.begin(1 + p), count, top);
    load(powers.begin(partner), count, bottom);
    put_power(top, bottom, roots, 1 + p, powers);
    put_power(bottom, top, roots, partner, powers);
  }
  return powers;
}

Samples PairedTransform::power() const {
  const Powers powers = power_by_row();
  const std::size_t together = at_once(rows_);
  std::vector<double> some(together * rows_), piece(together * powers.widest());
  SamplesWriter power(size_ + 1);
  for (std::size_t k2 = 0; k2 < columns_; k2 += together) {
    const std::size_t count = std::min(together, columns_ - k2);
    for (std::size_t b = 0; b < powers.blocks(); ++b) {
      powers.read(b, k2, count, piece.data());
      for (std::size_t i = 0; i < count; ++i)
        std::copy_n(piece.data() + i * powers.width(b), powers.width(b),
                    some.data() + i * rows_ + powers.begin(b));
    }
    power.add(std::span<const double>(some).first(count * rows_));
  }
  Rows first;
  load(0, 1, first);
  power.add(std::pow(first.values[0].real() - first.values[0].imag(), 2.0));
  return std::move(power).done();
}

}  // namespace ifog

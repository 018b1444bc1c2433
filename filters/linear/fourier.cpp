// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/fourier.h"

#include <unsupported/Eigen/FFT>

namespace ifog {

struct Fourier::Tables {
  Eigen::FFT<double> fft;
};

Fourier::Fourier() : tables_(std::make_unique<Tables>()) {}
Fourier::~Fourier() = default;

void Fourier::forward(std::vector<std::complex<double>>& spectrum, const std::vector<double>& values) {
  tables_->fft.fwd(spectrum, values);
}

void Fourier::forward(std::vector<std::complex<double>>& spectrum,
                      const std::vector<std::complex<double>>& values) {
  tables_->fft.fwd(spectrum, values);
}

void Fourier::inverse(std::vector<std::complex<double>>& values,
                      const std::vector<std::complex<double>>& spectrum) {
  tables_->fft.inv(values, spectrum);
}

void Fourier::inverse(std::vector<double>& values, const std::vector<std::complex<double>>& spectrum) {
  tables_->fft.inv(values, spectrum);
}

std::vector<double> power_spectrum(const std::vector<double>& values) {
  std::vector<std::complex<double>> bins;
  Eigen::FFT<double> fft(Eigen::FFT<double>::impl_type(), Eigen::FFT<double>::HalfSpectrum);
  fft.fwd(bins, values);
  std::vector<double> power;
  power.reserve(bins.size());
  for (const std::complex<double>& bin : bins) power.push_back(std::norm(bin));
  return power;
}

}  // namespace ifog

#include "filters/random/exponential.h"

#include "filters/random/logarithm.h"

namespace ifog {
namespace {

// The last counter word tells the two uses apart: rows below for at(), above for fill().
constexpr std::uint32_t kFillRows = 0x80000000U;

PhiloxBlock counter(std::uint64_t index, std::uint32_t stream, std::uint32_t last) noexcept {
  return {static_cast<std::uint32_t>(index), static_cast<std::uint32_t>(index >> 32U), stream, last};
}

}  // namespace

double DeviateStream::deviate(std::uint32_t bits) const noexcept {
  const double uniform = (static_cast<double>(bits) + 0.5) * 0x1p-32;  // never 0 nor 1
  return law_ == Law::kExponential ? -logarithm(uniform) : uniform;
}

double DeviateStream::at(std::uint64_t index, std::uint32_t row) noexcept {
  const std::uint64_t block = index >> 2U;
  if (block != kept_block_ || row != kept_row_) {
    kept_ = philox(counter(block, stream_, row), key_);
    kept_block_ = block;
    kept_row_ = row;
  }
  return deviate(kept_[index & 3U]);
}

void DeviateStream::fill(std::uint64_t index, std::uint32_t row, std::span<double> out) const noexcept {
  const auto count = static_cast<std::uint32_t>(out.size());
  const std::uint32_t blocks = (count + 3) / 4;
  for (std::uint32_t b = 0; b < blocks; ++b) {
    const PhiloxBlock bits = philox(counter(index, stream_, kFillRows + row * blocks + b), key_);
    for (std::uint32_t lane = 0; lane < 4 && 4 * b + lane < count; ++lane)
      out[4 * b + lane] = deviate(bits[lane]);
  }
}

}  // namespace ifog

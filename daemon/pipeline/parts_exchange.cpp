// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/parts_exchange.h"

#include <utility>

namespace ifog {

PartsExchange::~PartsExchange() {
  for (auto* const place : {&offered_, &due_, &retired_}) delete place->load();
}

void PartsExchange::offer(std::unique_ptr<ChainParts> parts, std::uint32_t number) {
  auto made = std::make_unique<Offer>();
  made->parts = std::move(parts);
  made->number = number;
  delete offered_.exchange(made.release(), std::memory_order_acq_rel);
}

void PartsExchange::collect_retired() noexcept {
  delete retired_.exchange(nullptr, std::memory_order_acq_rel);
}

std::uint32_t PartsExchange::mark(std::uint64_t samples) noexcept {
  if (offered_.load(std::memory_order_relaxed) == nullptr) return 0;
  // In this order: an offer that is no longer due was retired before.
  if (due_.load(std::memory_order_acquire) != nullptr || retired_.load(std::memory_order_acquire) != nullptr)
    return 0;
  Offer* const offer = offered_.exchange(nullptr, std::memory_order_acq_rel);
  if (offer == nullptr) return 0;
  const std::uint32_t number = offer->number;
  offer->from_sample = samples;
  due_.store(offer, std::memory_order_release);
  return number;
}

bool PartsExchange::exchange(std::uint64_t samples, SignalChain& chain) noexcept {
  Offer* const offer = due_.load(std::memory_order_acquire);
  if (offer == nullptr || samples < offer->from_sample) return false;
  offer->parts = chain.swap(std::move(offer->parts));
  retired_.store(offer, std::memory_order_release);
  due_.store(nullptr, std::memory_order_release);
  return true;
}

}  // namespace ifog

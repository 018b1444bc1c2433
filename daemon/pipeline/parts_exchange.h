// SPDX-License-Identifier: Apache-2.0
// Passes new parts of the signal chain from housekeeping to the sample at which they take effect. The reader
// determines it: the first sample of a delivery, so that a recording can note it and a replay exchanges the
// parts at the same sample.
#pragma once

#include <atomic>
#include <cstdint>
#include <memory>

#include "filters/chain/signal_chain.h"

namespace ifog {

class PartsExchange {
 public:
  PartsExchange() = default;
  ~PartsExchange();
  PartsExchange(const PartsExchange&) = delete;
  PartsExchange& operator=(const PartsExchange&) = delete;

  // Housekeeping: offers parts, replacing unmarked earlier ones. number: of these settings, not 0.
  void offer(std::unique_ptr<ChainParts> parts, std::uint32_t number);
  // Frees unused parts.
  void collect_retired() noexcept;

  // Reader, before it decodes a delivery, with `samples` pushed so far: number of the settings from the next
  // sample on; 0 if unchanged.
  [[nodiscard]] std::uint32_t mark(std::uint64_t samples) noexcept;

  // The queue's consumer, after `samples` samples: exchanges the chain's parts if due. False: not due.
  [[nodiscard]] bool exchange(std::uint64_t samples, SignalChain& chain) noexcept;

 private:
  struct Offer {
    std::unique_ptr<ChainParts> parts;
    std::uint32_t number = 0;
    std::uint64_t from_sample = 0;
  };

  // Stages of an offer. Only one is due at a time, and only after the previously retired parts were freed, so
  // there is a free place for the next ones.
  std::atomic<Offer*> offered_{nullptr};
  std::atomic<Offer*> due_{nullptr};
  std::atomic<Offer*> retired_{nullptr};
};

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
// New parts of the signal chain on their way from housekeeping to the sample they take effect at. The reader
// says which: the first of a delivery, so that a recording can say it, too, and whoever filters it later
// exchanges them at the same sample.
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

  // Housekeeping. Parts offered before and not yet marked are replaced. number: of these settings, not 0.
  void offer(std::unique_ptr<ChainParts> parts, std::uint32_t number);
  // Frees parts that are out of use.
  void collect_retired() noexcept;

  // Reader, before it decodes a delivery, `samples` having been pushed: the number of the settings that are
  // in use from the next sample on, 0 where they are what they were.
  [[nodiscard]] std::uint32_t mark(std::uint64_t samples) noexcept;

  // The queue's consumer, `samples` of the pushed being behind it: exchanges the chain's parts where that is
  // due. False: nothing is.
  [[nodiscard]] bool exchange(std::uint64_t samples, SignalChain& chain) noexcept;

 private:
  struct Offer {
    std::unique_ptr<ChainParts> parts;
    std::uint32_t number = 0;
    std::uint64_t from_sample = 0;
  };

  // An offer goes from one to the next. Only one is due at a time, and not before the parts that went before
  // it have been freed: their place is free when it is exchanged.
  std::atomic<Offer*> offered_{nullptr};
  std::atomic<Offer*> due_{nullptr};
  std::atomic<Offer*> retired_{nullptr};
};

}  // namespace ifog

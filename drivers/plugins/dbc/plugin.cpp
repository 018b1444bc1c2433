// SPDX-License-Identifier: Apache-2.0
// Driver `dbc`: any gyro on a CAN bus that a Vector DBC file describes. The options select the signals.
#include <cstdio>
#include <exception>
#include <memory>

#include "drivers/plugins/dbc/decoder.h"
#include "drivers/plugins/dbc/encoder.h"
#include "drivers/plugins/dbc/picks.h"
#include "ifog/driver.h"
#include "ifog/options.h"

namespace ifog::dbc {
namespace {

class Driver {
 public:
  explicit Driver(const plugin::Options& options) {
    read_picks(options, picks_);
    decoder_ = std::make_unique<Decoder>(picks_);
    encoder_ = std::make_unique<Encoder>(picks_);
  }

  Decoder& decoder() { return *decoder_; }
  [[nodiscard]] const Decoder& decoder() const { return *decoder_; }
  Encoder& encoder() { return *encoder_; }
  [[nodiscard]] const std::vector<std::string>& remarks() const { return picks_.remarks; }

  void describe(ifog_description& out) const {
    out = {};
    out.kind = picks_.kind;
    out.axes = static_cast<std::uint32_t>(picks_.axes.size());
    for (std::size_t i = 0; i < picks_.axes.size(); ++i) plugin::set_name(out.axis[i], picks_.axes[i].name);
    out.sequence_modulus = picks_.counter_modulus;
    out.has_device_time = picks_.time ? 1 : 0;
    out.nominal_rate_hz = picks_.rate_hz;
    out.angle_wrap_rad = picks_.angle_wrap_rad;
    out.environments = static_cast<std::uint32_t>(picks_.environments.size());
    for (std::size_t i = 0; i < picks_.environments.size(); ++i)
      plugin::set_name(out.environment[i], picks_.environments[i].column);
    picks_.each([&](Role, std::size_t, const Pick& pick) { want(out, pick); });
  }

 private:
  // The table of ids is large enough for axes, status, time and environment.
  static_assert(IFOG_MAX_AXES + 2 + IFOG_MAX_ENVIRONMENT <= IFOG_MAX_CAN_IDS);
  static void want(ifog_description& out, const Pick& pick) {
    const std::uint32_t extended = pick.message->extended ? 1 : 0;
    for (std::uint32_t i = 0; i < out.can_ids; ++i)
      if (out.can_id[i].id == pick.message->id && out.can_id[i].extended == extended) return;
    out.can_id[out.can_ids].id = pick.message->id;
    out.can_id[out.can_ids++].extended = extended;
  }

  Picks picks_;
  std::unique_ptr<Decoder> decoder_;
  std::unique_ptr<Encoder> encoder_;
};

Driver& self(void* instance) { return *static_cast<Driver*>(instance); }
const Driver& self(const void* instance) { return *static_cast<const Driver*>(instance); }

const ifog_driver kTable{
    .abi = IFOG_DRIVER_ABI,
    .transports = IFOG_TRANSPORT_CAN,
    .name = "dbc",
    .version = "1",
    .summary = "any CAN gyro described by a Vector DBC file; the options pick its signals",
    .options = option_list(),
    .create = [](const ifog_setting* settings, size_t count, char* error, size_t error_size) -> void* {
      return plugin::create_or_explain(settings, count, error, error_size,
                                       [&](const plugin::Options& options) {
                                         auto driver = std::make_unique<Driver>(options);
                                         plugin::explain_warnings(driver->remarks(), error, error_size);
                                         return driver.release();
                                       });
    },
    .destroy = [](void* instance) { delete static_cast<Driver*>(instance); },
    .describe = [](const void* instance, ifog_description* out) { self(instance).describe(*out); },
    .decode_bytes = nullptr,
    .decode_can = [](void* instance, const ifog_can_frame* frame, ifog_emit_sample emit,
                     void* sink) { self(instance).decoder().decode(*frame, emit, sink); },
    .reset = [](void* instance) { self(instance).decoder().reset(); },
    .counters = [](const void* instance,
                   ifog_driver_counters* out) { *out = self(instance).decoder().counters(); },
    .encode_bytes = nullptr,
    .encode_can = [](void* instance, const ifog_sample* sample, ifog_emit_can emit, void* sink, char* error,
                     size_t error_size) -> int {
      try {
        self(instance).encoder().encode(*sample, emit, sink);
        return 0;
      } catch (const std::exception& problem) {
        std::snprintf(error, error_size, "%s", problem.what());
        return -1;
      }
    }};

}  // namespace
}  // namespace ifog::dbc

const ifog_driver* ifog_driver_entry(void) { return &ifog::dbc::kTable; }

// SPDX-License-Identifier: Apache-2.0
// One configured driver of one sensor: owns the plugin's instance.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "drivers/host/plugin.h"
#include "drivers/ifog/driver.h"

namespace ifog {

// Option keys and values as text: the sensor's [sensor.options] table, or `--option key=value`.
using DriverSettings = std::map<std::string, std::string>;

// Capture columns of a driver's samples: axes, then channels.
std::vector<std::string> capture_columns(const ifog_description& description);

class DriverInstance {
 public:
  // Checks the keys, fills in defaults, creates the instance. Throws std::runtime_error with one line
  // (driver, key, value, what was expected): unknown or missing key, a value that the plugin rejects, a
  // description outside the interface's limits.
  DriverInstance(std::shared_ptr<const Plugin> plugin, const DriverSettings& settings);

  [[nodiscard]] const ifog_driver& table() const { return plugin().table(); }
  [[nodiscard]] const Plugin& plugin() const { return *instance_.get_deleter().plugin; }
  [[nodiscard]] const ifog_description& description() const { return description_; }
  [[nodiscard]] bool takes_bytes() const { return (table().transports & IFOG_TRANSPORT_BYTES) != 0; }
  [[nodiscard]] bool takes_can() const { return (table().transports & IFOG_TRANSPORT_CAN) != 0; }
  [[nodiscard]] ifog_driver_counters counters() const;
  // Warnings of the plugin for the user, one line each.
  [[nodiscard]] const std::vector<std::string>& warnings() const { return warnings_; }

  // Hot path. Calls `sink` with each const ifog_sample& when its last byte arrives. An exception of the sink
  // is rethrown after the plugin returns (never through its C functions); later samples of this call are not
  // passed. Only for drivers that takes_bytes() / takes_can().
  template <typename Sink>
  void decode_bytes(std::span<const std::uint8_t> bytes, std::int64_t arrival_ns, Sink&& sink) {
    Emission<std::remove_reference_t<Sink>> emission{sink, {}, portion_.at_once(bytes.size())};
    table().decode_bytes(instance_.get(), bytes.data(), bytes.size(), arrival_ns, &decltype(emission)::take,
                         &emission);
    portion_.came(bytes.size(), emission.samples);
    emission.throw_on();
  }
  template <typename Sink>
  void decode_can(const ifog_can_frame& frame, Sink&& sink) {
    Emission<std::remove_reference_t<Sink>> emission{sink, {}, 0};
    table().decode_can(instance_.get(), &frame, &decltype(emission)::take, &emission);
    emission.throw_on();
  }
  void reset() { table().reset(instance_.get()); }

  // Encodes a sample as the device would send it. Throw std::runtime_error: no encoder for that transport, or
  // the sample cannot be expressed in the format.
  void encode_bytes(const ifog_sample& sample, std::vector<std::uint8_t>& out);
  void encode_can(const ifog_sample& sample, std::vector<ifog_can_frame>& out);

 private:
  template <typename Item, typename Encode, typename Emit>
  void encode(Encode encoder, const char* to, const ifog_sample& sample, std::vector<Item>& out, Emit emit);

  // Passes samples to a sink through C.
  template <typename Sink>
  struct Emission {
    Sink& sink;
    std::exception_ptr thrown;
    std::uint32_t at_once = 0;
    std::uint64_t samples = 0;

    static void take(void* user, const ifog_sample* sample) noexcept {
      auto& self = *static_cast<Emission*>(user);
      ++self.samples;
      if (self.thrown) return;
      try {
        if (self.at_once == 0) {
          self.sink(*sample);
        } else {
          ifog_sample complete = *sample;
          complete.at_once = self.at_once;
          self.sink(complete);
        }
      } catch (...) {
        self.thrown = std::current_exception();
      }
    }
    void throw_on() {
      if (thrown) [[unlikely]]
        std::rethrow_exception(std::move(thrown));
    }
  };

  // Estimated number of samples in a delivery, from the mean bytes per sample so far. Always used for devices
  // with neither counter nor clock, for others only if it is large.
  struct Portion {
    bool asked = false;
    std::uint64_t bytes = 0, samples = 0;

    [[nodiscard]] std::uint32_t at_once(std::size_t now) const noexcept {
      constexpr std::uint64_t kMany = 3;
      if (samples == 0 || (!asked && now * samples < kMany * bytes)) return 0;
      const double about =
          static_cast<double>(now) * static_cast<double>(samples) / static_cast<double>(bytes);
      return static_cast<std::uint32_t>(std::clamp(std::round(about), 1.0, 1e9));
    }
    void came(std::size_t more, std::uint64_t of) noexcept {
      bytes += more;
      samples += of;
    }
  };

  // Keeps the plugin loaded for as long as its instance lives.
  struct Destroy {
    std::shared_ptr<const Plugin> plugin;
    void operator()(void* instance) const { plugin->table().destroy(instance); }
  };

  Portion portion_;
  std::unique_ptr<void, Destroy> instance_;
  ifog_description description_{};
  std::vector<std::string> warnings_;
};

// Keys of the settings that are file names, by the plugin's list.
std::vector<std::string> file_settings(const ifog_driver& table, const DriverSettings& settings);

// Settings with relative file paths resolved in `folder`; "": the working directory.
DriverSettings with_files_in(const std::filesystem::path& folder, const ifog_driver& table,
                             DriverSettings settings);

// Finds and loads the plugin and creates the instance. Relative paths in settings start in `files_from`; "":
// the working directory.
DriverInstance make_driver(const std::string& name, const DriverSettings& settings,
                           const std::vector<std::string>& folders = plugin_folders(),
                           const std::filesystem::path& files_from = {});

}  // namespace ifog

// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/field/exchange.h"

#include <ifog/decode.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <stdexcept>
#include <string_view>
#include <thread>

#include "daemon/sensor/sensor_parts.h"
#include "daemon/state/running_mark.h"
#include "daemon/state/state_folder.h"
#include "drivers/ifog/quoted.h"
#include "msgs/state_name.h"
#include "tools/ifog/console/errors.h"
#include "tools/ifog/console/interrupt.h"

namespace ifog::tools {
namespace {

using namespace std::chrono_literals;

constexpr auto kStatusWithin = 3s;   // status messages arrive every second
constexpr auto kEffectWithin = 15s;  // the daemon reloads at most once per second

std::string process(pid_t id) { return "the daemon (process " + std::to_string(id) + ")"; }

std::string not_running(const status_t& status) {
  return "sensor " + in_quotes(status.sensor) + " is in state \"" + state_name(status.state) +
         "\", expected it to run: a model is used from the next sample on";
}

std::string in_words(const std::string& identity) { return identity.empty() ? "none" : identity; }

Statuses decoded(std::string_view answer) {
  Statuses out;
  for (std::uint32_t bytes = 0; answer.size() >= sizeof bytes;) {
    std::memcpy(&bytes, answer.data(), sizeof bytes);
    answer.remove_prefix(sizeof bytes);
    status_t status{};
    if (bytes <= answer.size() && decode_message(answer.data(), bytes, status)) out[status.sensor] = status;
    answer.remove_prefix(std::min<std::size_t>(bytes, answer.size()));
  }
  return out;
}

}  // namespace

void require_that_it_fits(const Field& field, const SensorConfig& sensor, const Model& model) {
  try {
    const DriverInstance driver = make_sensor_driver(sensor, field.required_config().plugin_folders);
    const ChainParts parts(
        sensor_chain_settings(sensor, driver.description(), std::make_shared<const Model>(model)));
  } catch (const std::exception& error) {
    throw refusal("sensor {} cannot run with the model {}: {}", in_quotes(sensor.name), model.identity(),
                  error.what());
  }
}

ModelExchange::ModelExchange(const Field& field, const SensorConfig& sensor, const ModelName& in_use)
    : field_(field), sensor_(sensor.name), path_(field.model_path(sensor)) {
  const std::optional<pid_t> daemon = running_daemon(field.state());
  if (!daemon) return;
  live_.emplace(field.state(), *daemon);
  if (!live_->ask(kStatusWithin, [&](const Statuses& all) { return all.contains(sensor_); }))
    throw refusal("{} has no sensor {}, expected it: nobody would see whether it uses a model",
                  process(*daemon), in_quotes(sensor_));
  const status_t& status = *live_->of(sensor_);
  if (status.state != status_t::STATE_RUNNING) throw std::runtime_error(not_running(status));
  if (status.model != in_use.identity)
    throw refusal("sensor {} runs with model {}, {} holds {}, expected the same: let the daemon reload first",
                  in_quotes(sensor_), printable(in_words(status.model)), path_, in_words(in_use.identity));
}

void ModelExchange::put(const std::optional<Model>& model) const {
  model ? write_state_file(path_, model_text(*model)) : remove_state_file(path_);
}

void ModelExchange::ask_for_reload() {
  // The daemon may have been restarted.
  const std::optional<pid_t> now = running_daemon(field_.state());
  if (!now) throw refusal("{} has ended, and none runs in its place", process(live_->daemon()));
  live_.emplace(field_.state(), *now);
  live_->reload(kEffectWithin);
}

bool ModelExchange::takes_effect(const std::string& identity) {
  return live_->ask(kEffectWithin, [&](const Statuses&) {
    const status_t* const status = live_->of(sensor_);
    return status != nullptr && status->model == identity && status->model_since != 0;
  });
}

// The sensor may have stopped after the check in the constructor.
std::string ModelExchange::why_not_in_effect() const {
  const status_t* const status = live_->of(sensor_);
  if (status == nullptr || status->state == status_t::STATE_RUNNING) return "the reason is in its log";
  return not_running(*status);
}

void ModelExchange::exchange(const std::optional<Model>& model, const std::optional<Model>& before) {
  put(model);
  if (!live_) return;
  std::string why;
  try {
    ask_for_reload();
    if (takes_effect(model ? model->identity() : "")) return;
    why = process(live_->daemon()) + " does not use model " + in_words(model ? model->identity() : "") +
          " within " + std::to_string(std::chrono::seconds(kEffectWithin).count()) + " s, " +
          why_not_in_effect();
  } catch (const std::exception& error) {
    why = error.what();
  }
  std::string then;
  try {
    put(before);
    then = "; the model before is in place again";
    // Also if the first request failed: the daemon must use the model that is now in place.
    ask_for_reload();
  } catch (const std::exception& error) {
    then = std::string("; ") + error.what() + ", let it reload" + then;
  }
  throw refusal("{}{}", why, then);
}

bool LiveStatus::ask(std::chrono::milliseconds most, const std::function<bool(const Statuses&)>& enough) {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::milliseconds kBetween{500};  // half of the period of status messages
  const Clock::time_point end = Clock::now() + most;
  for (;;) {
    const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(end - Clock::now());
    all_ = decoded(ask_daemon(folder_, daemon_, DaemonQuestion::status, std::max(left, 4 * kBetween)));
    if (enough(all_)) return true;
    if (left.count() <= 0 || interrupted()) return false;
    std::this_thread::sleep_for(std::min(left, kBetween));
  }
}

void LiveStatus::reload(std::chrono::milliseconds most) const {
  const std::string refused = ask_daemon(folder_, daemon_, DaemonQuestion::reload, most);
  if (!refused.empty())
    throw refusal("the daemon refused to reload: {}", printable(refused, kLongestMessage));
}

const status_t* LiveStatus::of(const std::string& sensor) const {
  const auto found = all_.find(sensor);
  return found == all_.end() ? nullptr : &found->second;
}

}  // namespace ifog::tools

// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/monitor/known_here.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <exception>
#include <filesystem>

#include "daemon/sensor/flight_header.h"
#include "daemon/state/running_mark.h"
#include "drivers/ifog/quoted.h"
#include "msgs/channel_name.h"
#include "tools/ifog/field/models.h"

namespace ifog::tools {
namespace {

// "": no model.
void look_at_model(const Field& field, const SensorConfig& sensor, KnownSensor& known) {
  const ModelInUse in_use = model_in_use(field, sensor);
  if (!in_use.model) return;
  known.identity = in_use.name.identity;
  std::string date = in_use.model->source.date.substr(0, 16);  // to the minute
  std::ranges::replace(date, 'T', ' ');
  known.model = printable(std::filesystem::path(field.model_path(sensor)).filename().string()) +
                (date.empty() ? "" : " of " + printable(date));
}

void look_at_proposal(const Field& field, const SensorConfig& sensor, KnownSensor& known) {
  const std::optional<Proposal> waits = read_proposal(field.state(), sensor.name);
  if (waits)
    known.proposal = "proposal of " + printable(waits->made) + ": " + printable(waits->why, kLongestMessage) +
                     "; adopt with: " + field.command("adopt", sensor.name);
}

}  // namespace

KnownHere::KnownHere(const FieldOptions& options) : named_(!options.config.empty()) {
  try {
    field_.emplace(options);
  } catch (const std::exception&) {
    if (named_) throw;
  }
  look();
}

void KnownHere::look() {
  sensors_.clear();
  if (!field_ || field_->config() == nullptr) return;
  try {
    if (!named_ && !running_daemon(field_->state())) return;
  } catch (const std::exception&) {  // this user may not read it
    return;
  }
  constexpr std::array kKinds{"serial ", "CAN ", "", "tcp ", "file "};  // as TransportConfig::Kind
  for (const SensorConfig& sensor : field_->config()->sensors) {
    KnownSensor& known = sensors_[sensor.lcm_channel().substr(kChannelPrefix.size())];
    known.driver = sensor.driver + ", " + kKinds[static_cast<std::size_t>(sensor.transport.kind)] +
                   printable(source_of(sensor.transport), kLongestMessage);
    for (const ChannelConfig& channel : sensor.channels)
      if (channel.source != ChannelConfig::Source::frame) known.channels.insert(channel.name);
    // A model that is being exchanged or is not readable is shown by its identity.
    for (const auto look_at : {look_at_model, look_at_proposal}) try {
        look_at(*field_, sensor, known);
      } catch (const std::exception&) {
      }
  }
}

const KnownSensor* KnownHere::of(const std::string& name) const {
  const auto found = sensors_.find(name);
  return found == sensors_.end() ? nullptr : &found->second;
}

}  // namespace ifog::tools

// What `ifog allan` knows of one rate: where it came from, its points, its noise terms. Made from a column of
// a capture, then told in three ways: table, JSON, picture.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/allan/confidence.h"
#include "filters/allan/noise_fit.h"

namespace ifog::tools {

struct AllanOptions {
  std::string axis;           // only this axis; every one when empty
  std::vector<double> tau_s;  // as asked; log-spaced when empty
  int per_decade = 20;
  double confidence = 0.683;
  Deviation kind = Deviation::kAllan;
  bool refuse_gaps = false;
  bool minus_reference = false;
  double from_s = 0.0, to_s = 0.0;  // part of the capture, by its own time; to_s 0: to the end
};

struct AllanRecord {
  std::string capture;  // file
  std::string axis;
  std::string signal;  // "rate", "error" (rate less reference), or of a denoised file "raw", "compensated",
                       // "denoised"
  double sample_rate_hz = 0.0;
  std::size_t samples = 0, missing = 0, gaps = 0, longest = 0;
  double mean_radps = 0.0;
  double worst_jitter_s = 0.0;
  std::vector<double> tau_s;
  std::vector<DeviationPoint> points;
  std::vector<AllanInterval> intervals;
  std::optional<NoiseFit> fit;
  double trusted_tau_s = 0.0;      // up to here the deviation is known to a quarter
  std::vector<std::string> notes;  // what the reader should know, one line each

  [[nodiscard]] std::string label() const;  // short, tells the records of one run apart only with `capture`
};

// One record for each rate column of the file. Throws std::runtime_error with one line for people.
std::vector<AllanRecord> allan_records(const std::string& name, Table table, const AllanOptions& options);

// The coefficients in order Q N B K R with the units of the field: name, value in SI, and the factor to
// people's unit.
struct NamedCoefficient {
  const char* letter;
  const char* meaning;
  const char* si_unit;
  const char* unit;
  double factor;
  NoiseCoefficient NoiseFit::*member;
};
const std::vector<NamedCoefficient>& named_coefficients();

nlohmann::ordered_json allan_json(const std::vector<AllanRecord>& records, const AllanOptions& options);
void print_allan(const AllanRecord& record, const AllanOptions& options);

}  // namespace ifog::tools

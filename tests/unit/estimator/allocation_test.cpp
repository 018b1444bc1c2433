// Heap allocations of Estimator::step(): none, whatever the rule, the weights and the model, through rest,
// outliers, gaps, missing samples, a manoeuvre and a divergence. malloc itself is replaced, so that Eigen's
// own allocations count.
#include <gtest/gtest.h>

#include <atomic>
#include <cerrno>
#include <cstdlib>

#include "filters/rules/rule.h"
#include "tests/unit/estimator/drive.h"

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
#define IFOG_SANITIZED 1
#else
#define IFOG_SANITIZED 0
#endif

namespace {
std::atomic<bool> counting{false};
std::atomic<std::uint64_t> allocations{0};
void count() {
  if (counting.load(std::memory_order_relaxed)) allocations.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace

#if !IFOG_SANITIZED
// glibc's own, under the names it exports for this purpose.
extern "C" {
void* __libc_malloc(std::size_t);                 // NOLINT(bugprone-reserved-identifier)
void* __libc_memalign(std::size_t, std::size_t);  // NOLINT(bugprone-reserved-identifier)

void* malloc(std::size_t size) {
  count();
  return __libc_malloc(size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) {
  count();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** out, std::size_t alignment, std::size_t size) {
  count();
  *out = __libc_memalign(alignment, size);
  return *out == nullptr ? ENOMEM : 0;
}
}
#endif

namespace {

using namespace ifog::test;

std::uint64_t allocations_of(const ifog::FilterSettings& settings) {
  const Record r =
      record(3, 4000, 1e-3, [](int i) { return i < 2000 ? 0.0 : (i < 2500 ? 30.0 : 0.05 * (i - 2500)); });
  ifog::Estimator estimator(settings, 3, kPeriod);
  ifog::EstimatorInput in;
  ifog::EstimatorOutput out;
  counting = true;
  for (std::size_t i = 0; i < r.measured.size(); ++i) {
    in.sequence = i;
    in.dt_s = i % 701 == 700 ? 20 * kPeriod : kPeriod;
    in.valid_axes = i % 97 == 5 ? 5 : 7;
    const double rate = i == 1500 ? 1e4 : (i % 501 == 7 ? std::nan("") : r.measured[i]);
    in.rate_radps = {rate, -rate, 0.5 * rate};
    estimator.step(in, out);
  }
  counting = false;
  return allocations.exchange(0);
}

TEST(Allocation, NoStepAllocates) {
  if (IFOG_SANITIZED)
    GTEST_SKIP() << "a sanitizer has its own allocator; a build without one (preset release) counts";
  // The counter counts.
  counting = true;
  free(malloc(1));  // NOLINT(cppcoreguidelines-no-malloc)
  counting = false;
  ASSERT_GT(allocations.exchange(0), 0U);

  struct Model {
    const char* name;
    std::vector<double> parameters;
  };
  const std::vector<Model> models{
      {"random-walk", {}},
      {"integrated-random-walk", {}},
      {"arma(2,1)", {0.5, 0.2, 0.3}},
      {"random-walk + ar(3) + harmonic + harmonic", {0.5, 0.1, 0.1, 1.0, 4.17, 0.1, 8.34, 0.1}}};
  for (const Model& model : models) {
    for (const ifog::RuleEntry& rule : ifog::rules()) {
      for (const char* weights : {"kept", "fresh", "uniform"}) {
        ifog::FilterSettings settings = told(1e-3);
        settings.state = model.name;
        settings.state_parameters = model.parameters;
        settings.rule = rule.name;
        settings.weights = weights;
        settings.draws = 3;
        EXPECT_EQ(allocations_of(settings), 0U) << rule.name << ", " << weights << ", " << model.name;
        if (settings.rule != "irwe-akfg") break;  // the others draw no weights
      }
    }
  }
  ifog::FilterSettings lost = told(1e-9);
  lost.rule = "ckf";
  lost.follow_manoeuvres = false;
  EXPECT_EQ(allocations_of(lost), 0U);
}

}  // namespace

#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""Checks the blind generator and its judge by closed forms, without the program that they score."""
import sys
import unittest

try:
    import numpy as np
except ModuleNotFoundError:
    print("check_blind: skipped, numpy is missing for this Python; install python3-numpy")
    sys.exit(77)

import best_possible
import judge
import score_real
import sensor
import signals
from noise import Noise


def noise(seed=1, grade="navigation", dt=0.1):
    return Noise(np.random.default_rng(seed), grade, dt)


def allan(x, m):
    """Overlapping Allan deviation of a rate over m samples, by its definition."""
    sums = np.concatenate([[0.0], np.cumsum(x)])
    mean = (sums[m:] - sums[:-m]) / m
    return np.sqrt(0.5 * np.mean((mean[m:] - mean[:-m]) ** 2))


class NoiseTest(unittest.TestCase):
    def test_innovations_of_everything_are_white(self):
        n = 30000
        full = noise()
        white = full.N / np.sqrt(full.dt)
        full.Q = 0.3 * full.N * np.sqrt(full.dt)
        full.sways = [(0.54, 0.01, 10 * white)]
        full.lines = [(3.1, 1e-5, white)]
        measured = sum(full.draw(np.random.default_rng(2), n))
        v = full.whitener(n)(measured)[3000:]
        self.assertAlmostEqual(np.var(v), 1.0, delta=0.05)
        for lag in range(1, 30):
            self.assertLess(abs(np.mean(v[lag:] * v[:-lag])), 4.5 / np.sqrt(len(v)), f"lag {lag}")

    def test_allan_deviation_is_that_of_the_standard(self):
        n, flicker, white = 60000, [], []
        for seed in range(12):
            only = noise(seed)
            only.B, only.K, only.Q = 0.0, 0.0, 0.0
            white.append(allan(only.draw(np.random.default_rng(seed), n)[0], 50) / (only.N / np.sqrt(5.0)))
            only = noise(seed)
            only.N, only.K, only.Q = 0.0, 0.0, 0.0
            x = only.draw(np.random.default_rng(seed), n)[0]
            flicker.append(allan(x, 500) / (only.B * np.sqrt(2 * np.log(2) / np.pi)))
        self.assertAlmostEqual(np.mean(white), 1.0, delta=0.02)
        self.assertAlmostEqual(np.mean(flicker), 1.0, delta=0.08)

    def test_real_noise_is_fitted(self):
        known = Noise.known(score_real.STEP_S, 2e-6, 3e-8, 1e-9)
        found = score_real.fitted_noise(known.draw(np.random.default_rng(5), 3000)[0])
        effect = np.sin(np.arange(3000) * 0.02)
        self.assertAlmostEqual(found.sigma(effect) / known.sigma(effect), 1.0, delta=0.1)

    def test_sigma_in_white_noise_is_the_norm(self):
        plain = noise()
        plain.B, plain.K, plain.Q = 1e-6 * plain.B, 1e-6 * plain.K, 0.0
        effect = np.sin(np.arange(4000) * 0.01) * plain.N
        expected = np.sqrt(np.sum((effect - effect.mean()) ** 2)) / (plain.N / np.sqrt(plain.dt))
        self.assertAlmostEqual(plain.sigma(effect) / expected, 1.0, delta=0.01)

    def test_sizes_scatter_as_sigma_says(self):
        n = 3000
        full = noise(5)
        effect = np.cumsum(np.sin(np.arange(n) * 0.004)) * full.N * 0.01
        whiten = full.whitener(n)
        one, e = whiten(np.ones(n)), whiten(effect - effect[0])
        e = e - one * (one @ e) / (one @ one)
        sizes = [e @ whiten((x := full.draw(np.random.default_rng(k), n)[0]) - x[0]) / (e @ e) for k in range(300)]
        self.assertAlmostEqual(np.std(sizes) * full.sigma(effect), 1.0, delta=0.15)


class SensorTest(unittest.TestCase):
    def test_same_seed_same_sensor(self):
        a, b = sensor.make(12), sensor.make(12)
        for x, y in zip(a.captures, b.captures):
            for name in x.columns:
                np.testing.assert_array_equal(x.columns[name], y.columns[name])
        self.assertEqual(a.truth, b.truth)

    def test_a_capture_more_changes_nothing_of_the_others(self):
        a, b = sensor.make(12), sensor.make(12, several=True)
        self.assertEqual((len(a.captures), len(b.captures)), (2, 3))
        for x, y in zip(a.captures, b.captures):
            for name in x.columns:
                np.testing.assert_array_equal(x.columns[name], y.columns[name])
        again, second = b.captures[2], b.captures[1]
        self.assertEqual(list(again.columns), list(second.columns))
        self.assertGreater(np.std(again.own[:500] - second.own[:500]), 0)

    def test_a_confounder_runs_along_in_the_first_capture_alone(self):
        s = sensor.make(720116, "confounder", several=True)
        along = [abs(np.corrcoef(c.effect, c.columns["laser_mA"])[0, 1]) for c in s.captures]
        self.assertGreater(along[0], 0.97)
        self.assertLess(max(along[1:]), 0.8)

    def test_the_captures_hold_what_the_truth_says(self):
        s = next(x for x in (sensor.make(k, "supply") for k in range(1, 99)) if x.truth["role"] == "visible"
                 and len(x.truth["effects"]) == 1 and not x.truth["faults"] and not x.truth["noise"]["sways"])
        c = s.captures[0]
        np.testing.assert_allclose(c.columns["rate_radps"], c.rate + c.effect + c.own, rtol=0, atol=1e-15)
        self.assertTrue(12 <= s.truth["effects"][0]["sigma"] <= 80)
        slope = np.polyfit(c.columns["supply_V"], c.effect, 1)[0]
        self.assertAlmostEqual(slope / s.truth["effects"][0]["size"], 1.0, delta=0.02)

    def test_the_second_capture_leaves_the_range_when_told(self):
        for seed in range(1, 12):
            s = sensor.make(seed, "pressure in the housing, through a leak")
            for e in (e for e in s.truth["effects"] if e["kind"].startswith("pressure")):
                self.assertEqual(e["outside_share"] > 0.05, s.truth["outside"], f"seed {seed}")


class JudgeTest(unittest.TestCase):
    def setUp(self):
        self.sensor = sensor.make(17, "supply")
        self.report = {"effects": [{"form": "linear", "channel": "supply_V", "variance_explained": 0.5}],
                       "before": {"rms_10s_radps": 2.0}, "after": {"rms_10s_radps": 1.0}, "unexplained": {}}

    def verdict(self, share, channel="supply_V"):
        second = self.sensor.captures[1]
        self.report["effects"][0]["channel"] = channel
        error = judge.errors(second, share * second.effect, 1 / self.sensor.truth["sample_rate_hz"], 10.0)
        return judge.verdict(self.sensor.truth, self.report, error)

    def test_prediction_and_channel_decide(self):
        self.sensor.captures[1].effect *= 10  # far above a third of the noise
        self.assertEqual(self.verdict(1.0), "right")
        self.assertEqual(self.verdict(0.5), "imprecise")
        self.assertEqual(self.verdict(1.0, "laser_mA"), "wrong")
        self.report["effects"] = []
        second = self.sensor.captures[1]
        error = judge.errors(second, 0 * second.effect, 1.0, 10.0)
        self.assertEqual(judge.verdict(self.sensor.truth, self.report, error), "missed")

    def test_contradictions_are_seen(self):
        self.assertEqual(judge.contradictions(self.report, 2.0, 1.0), [])
        self.assertEqual(len(judge.contradictions(self.report, 2.0, 1.5)), 1)
        self.report["after"]["rms_10s_radps"] = 3.0
        self.assertEqual(len(judge.contradictions(self.report, 2.0, 1.0)), 1)
        self.report["remarks"] = ["10 s means grow 1.5 times, but there are 12 of them"]
        self.assertEqual(judge.contradictions(self.report, 2.0, 1.0), [])

    def test_a_heading_is_measured_against_its_prediction(self):
        rng, dt, aligned, later = np.random.default_rng(3), 0.5, 300, 600
        report = {"heading_prediction": {"aligned_s": aligned, "after_s": [60, later, 7200],
                                         "sigma_rad": [0.0, np.sqrt(later * (1 + later / aligned)), 0.0]}}
        squares = []
        for _ in range(400):
            own = rng.normal(size=2400) / np.sqrt(dt)
            effect = rng.normal(size=2400)
            capture = sensor.Capture(None, {}, effect, [], None, own)
            squares.append(judge.heading_square(capture, effect, report, dt))
        self.assertAlmostEqual(np.mean(squares), 1.0, delta=0.25)
        self.assertIsNone(judge.heading_square(sensor.Capture(None, {}, own[:500], [], None, own[:500]), own[:500], report, dt))

    def test_a_coefficient_is_measured_in_its_errors(self):
        truth = next(x.truth for x in (sensor.make(k, "supply") for k in range(1, 99)) if x.truth["role"] == "visible"
                     and len(x.truth["effects"]) == 1 and not x.truth["faults"])
        size = truth["effects"][0]["size"]
        found = self.report["effects"][0]
        found["parameters"] = {"coefficient": {"value": size + 0.2 * abs(size), "std_error": 0.1 * abs(size)}}
        self.assertAlmostEqual(judge.coefficient_error(self.report, truth), 2.0)
        found["channel"] = "laser_mA"
        self.assertIsNone(judge.coefficient_error(self.report, truth))

    def test_means_leave_out_what_is_missing(self):
        x = np.array([1.0, 1.0, np.nan, 3.0, np.nan, np.nan])
        np.testing.assert_array_equal(signals.means(x, 1.0, 2.0), [1.0, 3.0])


class BestPossibleTest(unittest.TestCase):
    def test_without_noise_the_law_is_found(self):
        made = sensor.make(12, "coil lags the thermometer").making
        law = best_possible.Law(made.hidden[:1], made.laws[:1], [2e-6], made.worlds[0].plan)
        truth = law.start.copy()
        law.start = truth * [0.8, 1.2]
        at = best_possible.fitted(law, made.worlds[0], law.effect(made.worlds[0], truth), made.noise)
        np.testing.assert_allclose(at, truth, rtol=0.02)

    def test_what_is_left_scatters_as_the_bound_says(self):
        seeds = [s for s in range(1, 60) if sensor.draw_role(np.random.default_rng([s, 0x1F06]), s, "supply")[0]
                 == "visible"][:25]
        ratios = []
        for s in seeds:
            one = sensor.make(s, "supply")
            if len(one.truth["effects"]) == 1 and not one.truth["faults"]:
                second = one.captures[1]
                own = signals.rms(second.own, 1 / one.truth["sample_rate_hz"])
                ratios.append(best_possible.floor(s, "supply") * own / one.truth["limit_radps"])
        # the better of two nearly equal fits, so a little less than one
        self.assertGreater(len(ratios), 10)
        self.assertTrue(0.5 < np.sqrt(np.mean(np.square(ratios))) < 1.5, ratios)


if __name__ == "__main__":
    unittest.main()

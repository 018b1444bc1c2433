# SPDX-License-Identifier: Apache-2.0
"""What a diagnosis is worth, by physics: does the model it wrote predict the hidden effect in a second capture, for
the right channel?

A claim is *founded* when each channel it uses carries the hidden effect (both thermometers of one path do), or, for a
form without a channel, when that form was hidden. `bias` beside a reference is about the mean, which nothing here counts; `line`,
`outliers`, `noise_change`, `gauss_markov` and `quantisation` describe and correct nothing: a line is founded where a line, a sway or a ramp that was not logged is
within 3 %; the others are not judged.

Verdict of a sensor, on RMS of 10 s means about their mean in the second capture (single samples for a feedback ramp):
  right      of every hidden effect of 12 sigma or more a channel is named, and what the model leaves of the effects is
             at most a third of them, or a third of the sensor's own noise, or what nobody can do without: three
             times what a fit would leave that knows the noise and the law and has only its constants to find
             (`limit_radps`, Cramer and Rao) and 1.5 times what the age of a late channel costs (`stale_radps`)
  imprecise  every channel is named, the prediction is not that good
  wrong      an unfounded claim and not right
  missed     neither
  refused    the program reads the capture and says in one line why it will not diagnose it (exit 1)
  failed     it crashes, does not end, or leaves out what it was told to write
For a gyro without effect or with one below 3 sigma, with a reference logged late, or one that tilts against the
Earth's rate (motion, no error): *right* when nothing is corrected beyond a third of its noise and no line invented,
else *false alarm*. For an effect no form covers: *left alone* when nothing is corrected and something is reported
unexplained, *silent* when nothing is reported, *helped* when founded claims lessen the error, else *wrong*.
*Made worse*: the error of the second capture (own noise and effect, not motion) grows above 1.1 times."""
import re

import numpy as np

import signals

DESCRIBE = {"bias", "line", "outliers", "noise_change", "gauss_markov", "quantisation"}
WHITE_KINDS = ("nothing", "white")


def claims_of(report):
    """[(form, [channels])] of the effects, products with both."""
    out = []
    for e in report.get("effects", []):
        channels = [e.get("channel")]
        forms = [e["form"]]
        if e.get("with"):
            channels.append(e["with"].get("channel"))
            forms.append(e["with"].get("form"))
        out.append((" x ".join(map(str, forms)), [c for c in channels if c], e))
    return out


def _near(effect, known_hz):
    hz = effect.get("parameters", {}).get("frequency_hz", {}).get("value", 0.0)
    return any(abs(hz - k) < 0.03 * k for k in known_hz)


def _line_founded(effect, truth):
    known = [line[0] for line in truth["noise"]["lines"] + truth["noise"]["sways"]]
    if any(e["form"] == "line" for e in truth["effects"]):
        known.append(truth["line_hz"])
    return _near(effect, known) or any("ramp" in e["kind"] for e in truth["effects"])


def unfounded(report, truth):
    """Claims that nothing hidden bears out, as text."""
    channels = {c for e in truth["effects"] for group in e["channels"] for c in group}
    forms = {e["form"] for e in truth["effects"] if () in map(tuple, e["channels"]) or [] in e["channels"]}
    out = []
    for form, used, effect in claims_of(report):
        if form == "line":
            good = _line_founded(effect, truth)
        elif form in DESCRIBE:
            good = True
        elif used:
            good = set(used) <= channels
        else:
            good = form in forms
        if not good:
            out.append(f"{form} of {' and '.join(used)}" if used else form)
    return out


def named(report, effect):
    """For each group of channels of a hidden effect, whether one is named, or its form where it has no channel."""
    claims = claims_of(report)
    return [any(set(group) & set(used) if group else form == effect["form"] for form, used, _ in claims)
            for group in effect["channels"]]


def errors(capture, correction, dt, seconds):
    """RMS in rad/s before and after the correction (nan where there is none: left as it was)."""
    took = np.where(np.isfinite(correction), correction, 0.0)
    left = capture.effect - took

    def size(x):
        return signals.rms(x, dt, seconds)

    return {"own": size(capture.own), "effect_before": size(capture.effect), "effect_after": size(left),
            "correction": size(took), "total_before": size(capture.own + capture.effect),
            "total_after": size(capture.own + left)}


def coefficient_error(report, truth):
    """Error of a coefficient in its standard errors, where the hidden law is one coefficient of one channel and the report names
    just that; else None."""
    effects = [(form, used, e) for form, used, e in claims_of(report) if form not in DESCRIBE]
    if len(truth["effects"]) != 1 or len(effects) != 1 or truth["faults"]:
        return None
    hidden, (form, used, found) = truth["effects"][0], effects[0]
    if hidden["form"] != "linear" or form != "linear" or len(hidden["channels"]) != 1 or used != [hidden["channel"]] \
            or "minus_channel" in found:
        return None
    said = found["parameters"]["coefficient"]
    return (said["value"] - hidden["size"]) / said["std_error"]


def heading_square(capture, correction, report, dt):
    """(found / predicted)^2 of the heading error after the longest predicted time that fits into the capture, with the bias
    from its beginning; None if no time fits."""
    said = report["heading_prediction"]
    aligned = round(said["aligned_s"] / dt)
    left = capture.own + capture.effect - np.where(np.isfinite(correction), correction, 0.0)
    fit = [(round(t / dt), sigma) for t, sigma in zip(said["after_s"], said["sigma_rad"])
           if aligned + round(t / dt) <= len(left)]
    if not fit or aligned == 0:
        return None
    n, sigma = fit[-1]
    heading = np.sum(left[aligned : aligned + n] - np.mean(left[:aligned])) * dt
    return float((heading / sigma) ** 2)


def verdict(truth, report, error):
    extra = unfounded(report, truth)
    corrective = [c for c in claims_of(report) if c[0] not in DESCRIBE]
    strong = [e for e in truth["effects"] if e["sigma"] >= 12.0]
    flags = {f for e in truth["effects"] for f in e["flags"]}
    small = error["correction"] <= error["own"] / 3
    special = any(e["cover"] in ("logger", "motion") for e in truth["effects"])
    if truth["role"] != "visible" or special:
        if truth["role"] == "faint" and not extra:
            return "right"
        return "right" if small and not (extra and not special) else "false alarm"
    if any(e["cover"] == "none" for e in strong) or ("same start only" in flags and truth["outside"]):
        return _uncovered(report, error, extra, corrective)
    if "feedback ramp, not logged" in truth["kind"]:
        return _unlogged_ramp(report, error, extra)
    inevitable = 3 * truth["limit_radps"] + 1.5 * truth["stale_radps"]
    predicted = error["effect_after"] <= max(error["effect_before"] / 3, error["own"] / 3, inevitable)
    if "descriptive" in flags:
        predicted = error["correction"] <= error["own"] / 3 and any(
            form == "line" and _near(effect, [truth["line_hz"]]) for form, _, effect in claims_of(report))
    found = [named(report, e) for e in strong]
    if predicted and all(any(groups) for groups in found):
        return "right"
    if extra:
        return "wrong"
    return "imprecise" if all(groups and all(groups) for groups in found) else "missed"


def _uncovered(report, error, extra, corrective):
    worse = error["total_after"] > error["total_before"]
    if corrective:
        return "helped" if not extra and not worse else "wrong"
    share = report.get("unexplained", {})
    told = share.get("kind") not in WHITE_KINDS or share.get("fraction", 0) > 0.12
    return "left alone" if told else "silent"


def _unlogged_ramp(report, error, extra):
    if error["effect_after"] <= error["effect_before"] / 3:
        return "right"
    text = str(report.get("unexplained")) + str(report.get("remarks")) + str(report.get("effects"))
    if re.search("ramp", text):
        return "right" if error["total_after"] <= 1.02 * error["total_before"] else "wrong"
    return "wrong" if extra else "missed"


def contradictions(report, fit_before, fit_after):
    """What a report says against itself, or against what its written model does to its own capture. Means that grow
    by chance are no contradiction where the report says so itself, of few means and by name. `fit_*` are the
    RMS of 10 s means of rate minus reference before and after, as anyone can compute them."""
    out = []
    before, after = report.get("before", {}), report.get("after", {})
    effects = report.get("effects", [])
    if effects:
        for key in ("residual_rms_radps", "rms_1s_radps", "rms_10s_radps", "rms_100s_radps"):
            said = f"{key.split('_')[1][:-1]} s means grow"
            if after.get(key, 0) > 1.02 * before.get(key, np.inf) and not any(
                    said in remark for remark in report.get("remarks", [])):
                out.append(f"{key} grew {after[key] / before[key]:.2f} times")
        explained = [e.get("variance_explained", 0) for e in effects]
        if report.get("unexplained", {}).get("fraction", 0) >= 0.95 and sum(explained) > 0.3:
            out.append("all unexplained beside what explains it")
    promised = after.get("rms_10s_radps")
    if promised and fit_after > 1.2 * promised and fit_before <= 1.2 * before["rms_10s_radps"]:
        out.append(f"promised {promised:.3g} rad/s, the model leaves {fit_after:.3g}")
    used = {c for _, channels, _ in claims_of(report) for c in channels}
    for remark in report.get("remarks", []):
        if "were dropped: " in remark and any(re.search(rf"\b{c}\b", remark.split("were dropped: ")[1]) for c in used):
            out.append("a channel left out and used: " + remark[:80])
    return out


def odd_words(report):
    """No contradiction, but what a reader stumbles over."""
    explained = [e.get("variance_explained", 0) for e in report.get("effects", [])]
    return [f"explains {100 * sum(explained):.0f} % together"] if sum(explained) > 1.1 else []

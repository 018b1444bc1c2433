# SPDX-License-Identifier: Apache-2.0
"""The counts over many sensors: a summary for programs, tables for people, a line for each sensor."""
import numpy as np

VERDICTS = ("right", "imprecise", "wrong", "missed", "false alarm", "left alone", "silent", "helped", "refused",
            "failed")


def _strong(r):
    return r["truth"]["role"] == "visible"


def cover(r):
    """Of the hardest effect; `clean` for sensors that should be left alone, warm starts and faint ones told apart."""
    if r["truth"]["role"] != "visible":
        return r["truth"]["role"]
    covers = [e["cover"] for e in r["truth"]["effects"]]
    flags = {f for e in r["truth"]["effects"] for f in e["flags"]}
    if "same start only" in flags and r["truth"]["outside"]:
        return "none"
    return next(c for c in ("logger", "motion", "none", "grammar", "design") if c in covers)


def left_range(r):
    """Whether the second capture leaves the first one's range of what matters."""
    shares = [e["outside_share"] for e in r["truth"]["effects"]]
    return max(shares, default=0.0) > 0.05 or (r["truth"]["platform"] == "shaker" and r["truth"]["outside"])


def relative(r):
    """What is left of the effect in parts of the sensor's own noise."""
    return r["error"]["effect_after"] / r["error"]["own"]


def _share(part, whole):
    return round(len(part) / len(whole), 4) if whole else None


def _quantiles(rows):
    values = [relative(r) for r in rows if r["error"]]
    if not values:
        return None
    return {"count": len(values), "median": float(np.median(values)), "p90": float(np.quantile(values, 0.9))}


def _kept_out(r):
    """Errors of effects that a correction can take away in another capture: no lines, no steps of the past."""
    return not any({"descriptive", "first capture only"} & set(e["flags"]) for e in r["truth"]["effects"])


def judged_by_error(r):
    """Whether what is left of its effect counts: a form covers it, and a correction can take it away elsewhere."""
    return bool(r["error"]) and _strong(r) and cover(r) in ("design", "grammar") and _kept_out(r)


def summary(records):
    done = [r for r in records if r["error"]]
    covered = [r for r in records if _strong(r) and cover(r) in ("design", "grammar")]
    visible = [r for r in done if _strong(r) and cover(r) not in ("logger", "motion")]
    alone = [r for r in done if cover(r) in ("clean", "faint", "logger", "motion")]
    clean = [r for r in alone if cover(r) == "clean"]
    hidden = [r for r in visible if r["truth"]["kind"] != "confounder"]
    warm = [r for r in done if cover(r) == "none" and r["truth"]["kind"] == "warm-up"]
    out = {"sensors": len(records), "crashed": sum(r["verdict"] == "failed" for r in records),
           "refused": sum(r["verdict"] == "refused" for r in records), "covered": len(covered)}
    out["right"] = _share([r for r in covered if r["verdict"] == "right"], covered)
    for name in ("design", "grammar"):
        rows = [r for r in covered if cover(r) == name]
        out[f"{name}_sensors"] = len(rows)
        out[f"{name}_right"] = _share([r for r in rows if r["verdict"] == "right"], rows)
    out["missed"] = _share([r for r in covered if r["verdict"] == "missed"], covered)
    out["wrong_claims"] = _share([r for r in visible if r["unfounded"]], visible)
    out["wrong_claims_but_for_confounders"] = _share([r for r in hidden if r["unfounded"]], hidden)
    out["clean_sensors"] = len(clean)
    out["clean_false_alarms"] = sum(r["verdict"] == "false alarm" for r in clean)
    out["left_alone_sensors"] = len(alone)
    out["false_alarms"] = _share([r for r in alone if r["verdict"] == "false alarm"], alone)
    out["worse"] = _share([r for r in done if r["worse"]], done)
    out["worse_but_for_warm_starts"] = _share([r for r in done if r["worse"] and r not in warm], done)
    out["contradictions"] = _share([r for r in done if r["contradictions"]], done)
    # The mean square of a right prediction is 1, and 95 % of right intervals hold.
    squares = [r["heading_square"] for r in done if r["heading_square"] is not None
               and r["verdict"] in ("right", "left alone")]
    out["heading_square"] = {"count": len(squares), "mean": float(np.mean(squares))} if squares else None
    errors = [r["coefficient_error"] for r in done if r["coefficient_error"] is not None]
    out["intervals_hold"] = {"count": len(errors), "share": _share([e for e in errors if abs(e) < 1.96], errors)}
    for name, outside in (("inside", False), ("outside", True)):
        rows = [r for r in covered if _kept_out(r) and left_range(r) == outside]
        out[f"error_{name}"] = _quantiles(rows)
        out[f"error_{name}_when_right"] = _quantiles([r for r in rows if r["verdict"] == "right"])
    return out


def line(r):
    t = r["truth"]
    faults = ",".join(f"{f['kind']}:{f['column']}" for f in t["faults"])
    head = f"{r['seed']} {t['role']:7} {r['verdict']:11} {t['kind']} @{t['platform']}"
    head += " " + "/".join(f"{e['sigma']:.0f}s" for e in t["effects"]) + (f" [{faults}]" if faults else "")
    if r["failure"]:
        return head + " " + r["failure"]
    e = r["error"]
    head += (f" out={int(left_range(r))} sways={len(t['noise']['sways'])} | {'; '.join(r['claims']) or '-'} | effect "
             f"{e['effect_before'] / e['own']:.2f} -> {relative(r):.2f}, "
             f"error {e['total_before'] / e['own']:.2f} -> {e['total_after'] / e['own']:.2f}")
    if r["worse"]:
        head += " WORSE"
    for text in r["contradictions"]:
        head += f" CONTRADICTION({text})"
    return head + "".join(f" ({text})" for text in r["odd_words"])


def _table(title, groups):
    rows = [f"\n| {title} | sensors | " + " | ".join(VERDICTS) + " | unfounded claim | made worse | contradiction "
            "| effect's error, median; 90 % |", "|---" * (len(VERDICTS) + 6) + "|"]
    for name, members in groups:
        if not members:
            continue
        done = [r for r in members if r["error"]]
        counts = [sum(r["verdict"] == v for r in members) for v in VERDICTS]
        q = _quantiles(done)
        rows.append(f"| {name} | {len(members)} | " + " | ".join(str(c) if c else "" for c in counts)
                    + f" | {sum(bool(r['unfounded']) for r in done)} | {sum(r['worse'] for r in done)}"
                    + f" | {sum(bool(r['contradictions']) for r in done)}"
                    + (f" | {q['median']:.3f}; {q['p90']:.2f} |" if q else " | |"))
    return rows


def _grouped(records, key):
    names = list(dict.fromkeys(key(r) for r in records))
    return [(n, [r for r in records if key(r) == n]) for n in sorted(names, key=str)]


def markdown(records, found):
    out = ["Effect's error: what the model leaves of it in the second capture, RMS of 10 s means, in parts of the",
           "sensor's own noise there.", ""]
    out += [f"* {name}: {value}" for name, value in found.items()]
    covered = [r for r in records if _strong(r) and cover(r) in ("design", "grammar")]
    out += _table("who could describe it", _grouped(records, cover))
    out += _table("hidden", _grouped([r for r in records if _strong(r)], lambda r: r["truth"]["kind"]
                                     if len(r["truth"]["effects"]) == 1 else "two at once"))
    out += _table("covered; second capture", _grouped(covered, lambda r: "outside" if left_range(r) else "inside"))
    out += _table("covered; logger", _grouped(covered, lambda r: " + ".join(
        sorted({f["kind"] for f in r["truth"]["faults"]})) or "intact"))
    out += _table("covered; structure", _grouped(covered, lambda r: "sways" if r["truth"]["noise"]["sways"]
                                                 else "stands still"))
    out += _table("covered; visibility", _grouped(covered, lambda r: "below 20 sigma" if min(
        e["sigma"] for e in r["truth"]["effects"]) < 20 else "from 20 sigma"))
    out += ["", "To be looked at:", ""]
    for v in ("failed", "refused", "false alarm", "wrong", "imprecise", "missed", "silent"):
        seeds = [str(r["seed"]) for r in records if r["verdict"] == v]
        out.append(f"* {v}: {' '.join(seeds) or 'none'}")
    out.append(f"* made worse: {' '.join(str(r['seed']) for r in records if r['worse']) or 'none'}")
    out.append(f"* contradiction: {' '.join(str(r['seed']) for r in records if r['contradictions']) or 'none'}")
    return "\n".join(out) + "\n"

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The same series with times that begin at 0 and at any other moment, in any unit and format: the output of every command is the
same to the last bit, except times, which have all digits of the file. Times that do not increase like those of one recording are
rejected with the line or reported.

usage: origins.py PATH_OF_IFOG SOURCE_DIR The HDF5 part is skipped, with a message, without h5py.
"""
import json
import math
import random
import re
import sys
from decimal import Decimal

try:
    import h5py
    import numpy
except ImportError:
    h5py = None

from run import SOURCE, ifog, main_of, ran, refused

S = 10**9  # ns
STARTS = {"1970": 1_700_000_000_123_456_789, "GPS": 345_678_250_000_000, "before": -1_700_000_000_500_000_000}
UNITS = {"s": 1, "ms": 10**3, "us": 10**6, "ns": 10**9}
RATE_HZ, ROWS = 100, 3000
KINDS = ("even", "uneven", "holes")
COLUMNS = ["--column", "rate_radps=rate_radps", "--column", "temperature_degC=temperature_degC"]
TOLD = {"from_s", "to_s", "times_s", "time_s"}  # keys whose values are times of the capture
NUMBER = re.compile(r"(?<![\w.])-?\d+(?:\.\d+)?(?:e[-+]?\d+)?(?![\w.])")


def stamp(ns, of_second=1):
    """A time in plain digits, to 1 ns in its unit."""
    a_unit = S // of_second
    whole, rest = divmod(abs(ns), a_unit)
    digits = len(str(a_unit)) - 1
    return ("-" if ns < 0 else "") + str(whole) + (f".{rest:0{digits}d}" if digits else "")


def series(kind):
    """ns since the start, rates and temperatures as cells, with a step, a glitch and missing cells, so that messages contain
    times."""
    draw = random.Random(7)
    ns, rate, temperature, walk = [], [], [], 0.0
    for i in range(ROWS):
        late = draw.randrange(-200_000, 200_001) if kind == "uneven" and i else 0
        hole = 3 * S + 70_000_000 if kind == "holes" and i > ROWS // 2 else 0
        ns.append(i * S // RATE_HZ + late + hole)
        walk += draw.gauss(0, 2e-8)
        degrees = round(25 + 3 * math.sin(2 * math.pi * i / (ROWS / 2.3)) + 0.01 * draw.gauss(0, 1), 4)
        value = draw.gauss(0, 1e-5) * (3 if i > 0.8 * ROWS else 1) + walk + 4e-6 * (degrees - 25) + (3e-5 if i > ROWS / 3 else 0)
        rate.append("" if kind == "holes" and 700 <= i < 720 else repr(value + (1e-2 if i == 2000 else 0)))
        temperature.append(repr(degrees))
    return ns, rate, temperature


def same_text(before, after, start_s):
    """Equal texts, except for numbers that are times and differ by start_s within the printed digits."""
    numbers = NUMBER.findall(before), NUMBER.findall(after)
    if NUMBER.sub("#", before) != NUMBER.sub("#", after) or len(numbers[0]) != len(numbers[1]):
        return False
    return all(a == b or abs(float(b) - float(a) - start_s) < 1e-4 for a, b in zip(*numbers))


def differences(before, after, start_s, key=""):
    """Places where two documents differ by more than their times."""
    if isinstance(before, dict) and isinstance(after, dict) and set(before) == set(after):
        return [d for k in before for d in differences(before[k], after[k], start_s, key if k == "value" and key in TOLD else k)]
    if isinstance(before, list) and isinstance(after, list) and len(before) == len(after):
        return [d for a, b in zip(before, after) for d in differences(a, b, start_s, key)]
    if isinstance(before, str) and isinstance(after, str):
        return [] if same_text(before, after, start_s) else [(key, before, after)]
    if before == after and (key not in TOLD or start_s == 0):
        return []
    told = key in TOLD and isinstance(before, float) and abs(after - before - start_s) < 1e-6
    return [] if told else [(key, before, after)]


class Checks:
    def __init__(self, folder):
        self.folder = folder
        self.series = {kind: series(kind) for kind in KINDS}
        self.answers = {}  # of the series that begins at 0

    def csv(self, name, times, kind="even", unit="s"):
        path = self.folder / name
        header = "time_s" if unit == "s" else "t"
        _, rate, temperature = self.series[kind]
        path.write_text(f"{header},rate_radps,temperature_degC\n" + "".join(
            f"{stamp(t, UNITS[unit])},{r},{d}\n" for t, r, d in zip(times, rate, temperature)))
        return path, [] if unit == "s" else ["--time", f"t:{unit}", *COLUMNS]

    def hdf5(self, name, times, kind, dtype):
        """As in other programs: times as integers."""
        path = self.folder / name
        _, rate, temperature = self.series[kind]
        with h5py.File(path, "w") as file:
            file["t"] = numpy.array(times, dtype=dtype)
            file["rate_radps"] = numpy.array([float(r) if r else math.nan for r in rate])
            file["temperature_degC"] = numpy.array([float(d) for d in temperature])
        return path, ["--time", "t:ns", *COLUMNS]

    def answer(self, command, path, options):
        """Output of the command without the file's name: its JSON and text."""
        out = self.folder / "answer.json"
        more = {"denoise": ["--output", self.folder / "denoised.csv"], "diagnose": ["--write-model", self.folder / "model.toml"]}.get(command, [])
        words = ifog(command, path, *options, *more, "--json", out)
        def unnamed(text):
            return re.sub(r"FILE:(\d+| sample \d+)", "FILE", text.replace(path.name, "FILE").replace(str(self.folder), ""))
        document = json.loads(unnamed(out.read_text()))
        words = "\n".join(line for line in words.splitlines() if "ifog denoise" not in line)
        if command == "denoise":
            words += "".join(line.partition(",")[2] + "\n" for line in (self.folder / "denoised.csv").read_text().splitlines())
        if command == "diagnose":
            model = (self.folder / "model.toml").read_text()
            words += "\n".join(line for line in model.splitlines() if not line.startswith(("date", "sha256", "capture")))
        return document, unnamed(words)

    def require_same(self, command, kind, start, path, options):
        if (command, kind) not in self.answers:
            self.answers[command, kind] = self.answer(command, *self.csv("zero.csv", self.series[kind][0], kind))
        before, after = self.answers[command, kind], self.answer(command, path, options)
        found = differences(before[0], after[0], start / S) + ([] if same_text(before[1], after[1], start / S) else [("words", before[1], after[1])])
        assert not found, (command, kind, path.name, len(found), found[:3])

    def require_times(self, path, times):
        """To the digit, as in the column."""
        lines = [line for line in path.read_text().splitlines() if not line.startswith("#")][1:]
        found = [Decimal(line.partition(",")[0]) for line in lines]
        wrong = [i for i, (a, b) in enumerate(zip(found, times)) if a != Decimal(b).scaleb(-9)]
        assert not wrong and len(found) == len(times), (path.name, len(found), len(times), [(str(found[i]), times[i]) for i in wrong[:3]])

    def check_every_start_and_unit_gives_the_same(self):
        for kind in KINDS:
            ns = self.series[kind][0]
            for start in STARTS.values():
                times = [start + t for t in ns]
                for unit in UNITS:
                    path, options = self.csv("moved.csv", times, kind, unit)
                    out = self.folder / "converted.csv"
                    ifog("convert", path, out, *options)
                    self.require_times(out, times)
                    self.require_same("allan", kind, start, path, options)
                    if unit in ("s", "ns"):
                        self.require_same("denoise", kind, start, path, options)
                        self.require_times(self.folder / "denoised.csv", times)

    def check_commands_that_search_find_the_same(self):
        for command, kind, start, unit in (("diagnose", "even", "1970", "s"), ("diagnose", "holes", "GPS", "us"), ("tune", "holes", "1970", "ms"),
                                           ("diagnose", "uneven", "before", "ns"), ("tune", "even", "before", "ns"), ("compare", "uneven", "1970", "us")):
            path, options = self.csv("moved.csv", [STARTS[start] + t for t in self.series[kind][0]], kind, unit)
            self.require_same(command, kind, STARTS[start], path, options)

    def check_a_fleet_of_them_is_of_one_kind(self):
        """Three gyros whose captures differ only in their start times."""
        ns = self.series["even"][0]
        starts = {"A": 0, "B": STARTS["1970"], "C": STARTS["before"]}
        lot = 'type = "demo"\n'
        for serial, start in starts.items():
            self.csv(f"gyro_{serial}.csv", [start + t for t in ns])
            lot += f'[[gyro]]\nserial = "{serial}"\ncaptures = ["gyro_{serial}.csv"]\n'
        (self.folder / "lot.toml").write_text(lot)
        ifog("fleet", self.folder / "lot.toml", "--engine", "local", "--results", self.folder / "lot")

        def found(serial):
            text = (self.folder / "lot/gyros" / serial / "diagnosis.json").read_text()
            return json.loads(text.replace(f"gyro_{serial}.csv", "FILE"))
        for serial in ("B", "C"):
            wrong = differences(found("A"), found(serial), starts[serial] / S)
            assert not wrong, (serial, wrong[:3])

    def check_parts_are_cut_where_the_digits_say(self):
        start = STARTS["1970"]
        times = [start + t for t in self.series["uneven"][0]]
        path, _ = self.csv("cut.csv", times, "uneven")
        out = self.folder / "part.csv"
        for first, last in ((1000, 2000), (1, 2999), (1701, 1702)):
            ifog("denoise", path, "--output", out, "--from", stamp(times[first]), "--to", stamp(times[last]))
            self.require_times(out, times[first:last])
            # 1 ns later the first row is outside, and the last one inside.
            ifog("denoise", path, "--output", out, "--from", stamp(times[first] + 1), "--to", stamp(times[last] + 1))
            self.require_times(out, times[first + 1:last + 1])
        result = ran("allan", path, "--from", stamp(start + 100 * S))
        assert result.returncode == 1 and stamp(times[0])[:15] in result.stderr, result.stderr

    def check_records_that_overlap_are_seen_whatever_they_are_counted_from(self):
        times = [STARTS["1970"] + t for t in self.series["uneven"][0]]
        whole, _ = self.csv("whole.csv", times, "uneven")
        part = self.folder / "part_of_it.csv"
        lines = whole.read_text().splitlines(keepends=True)
        part.write_text("".join(lines[:1] + lines[1000:]))
        refused(1, "diagnose", whole, part, says=["part_of_it.csv: holds the same samples as", "from 1700000010.11", "expected each record once"])

    def check_frames_carry_the_times(self):
        """Format B of the KVH 1750 has its time in µs with 32 bits."""
        times = [STARTS["1970"] + t for t in self.series["uneven"][0]]
        path, _ = self.csv("sent.csv", times, "uneven")
        driver = ["--driver", "kvh1750", "--option", "format=b"]
        us = [t // 1000 % 2**32 for t in times]
        expected = [Decimal(us[0] + (u - us[0]) % 2**32).scaleb(-6) for u in us]
        for command in (["convert", path, self.folder / "sent.kvh", *driver],
                        ["replay", path, *driver, "--speed", "0", "--to", f"file:{self.folder / 'sent.kvh'}"]):
            ifog(*command)
            back = self.folder / "back.csv"
            ifog("convert", self.folder / "sent.kvh", back, *driver)
            found = [Decimal(line.partition(",")[0]) for line in back.read_text().splitlines()[1:]]
            assert found == expected, (command[0], found[:3], expected[:3])

    def check_one_part_of_every_source_has_the_same_samples(self):
        """--from and --to refer to the printed times of the source; the first is inclusive, the last exclusive."""
        kvh, still = ["--driver", "kvh1750", "--option", "rate_hz=100"], ["--driver", "dsp3000", "--option", "output=rate"]
        can = ["--dbc", SOURCE / "drivers/dbc/examples/ifogd_gyro.dbc", "--option", "signal=Rate_x"]
        counted = [*can, "--option", "counter=Counter", "--option", "rate_hz=100"]
        # Times of a source for a series that begins then: 32 bits of µs, a counter or none from 0, the stamps of a log.
        us = 2**32 * 1000
        sources = (("clock.kvh", [*kvh, "--option", "format=b"], lambda t: t % us), ("count.kvh", [*kvh, "--option", "format=a"], lambda t: t - start),
                   ("none.bin", [*still, "--option", "rate_hz=100"], lambda t: t - start), ("stamps.log", can, lambda t: t), ("counter.log", counted, lambda t: t))
        for start in (0, 50 * S, 1_763_000_000 * S):
            times = [start + i * S // RATE_HZ for i in range(ROWS)]
            csv, _ = self.csv("source.csv", times)
            for name, options, made in (("same.csv", [], lambda t: t), ("same.h5", [], lambda t: t), *sources):
                path, back, out = (self.folder / each for each in (name, "back.csv", "part.csv"))
                ifog("convert", csv, path, *(["--axis", "x"] if name.endswith("kvh") else []), *options)
                ifog("convert", path, back, *options)
                self.require_times(back, [made(t) for t in times])
                part = ["--from", stamp(made(times[500])), "--to", stamp(made(times[2700]))]
                rate = ["--rate", "100"] if name == "stamps.log" else []
                ifog("denoise", path, "--output", out, *options, *rate, *part)
                self.require_times(out, [made(t) for t in times[500:2700]])
                for command, samples in (("allan", lambda found: found["axes"][0]["samples"]), ("tune", lambda found: found["samples"]),
                                         ("compare", lambda found: found["samples"]), ("diagnose", lambda found: found["samples"])):
                    answer = self.folder / "answer.json"
                    ifog(command, path, *options, *part, "--moving", "keep", "--json", answer) if command == "allan" else ifog(
                        command, path, *options, *part, "--json", answer)
                    found = samples(json.loads(answer.read_text()))
                    assert found == 2200, (command, name, start, found)

    def check_logs_with_short_times_and_without(self):
        """candump -t z, -t d, and no times."""
        dbc = ["--dbc", SOURCE / "drivers/dbc/examples/ifogd_gyro.dbc", "--option", "signal=Rate_x"]
        times = [i * S // RATE_HZ for i in range(200)]
        def line(front, i):
            return f" {front} vcan0  100   [8]  {i % 200:02X} 00 80 35 {i % 256:02X} 00 00 00\n"
        def short(ns):
            return f"({ns // S:03d}.{ns % S // 1000:06d})"
        lines = {"z": "".join(line(short(t), i) for i, t in enumerate(times)),
                 "d": "".join(line(short(t - times[max(i - 1, 0)]), i) for i, t in enumerate(times)),
                 "none": "".join(line("", i) for i in range(200))}
        for kind, text in lines.items():
            path, out = self.folder / f"{kind}.log", self.folder / "out.csv"
            path.write_text(text)
            more = ["--option", "rate_hz=100"] if kind == "none" else []
            ifog("convert", path, out, *dbc, *more)
            self.require_times(out, times)
            ifog("denoise", path, "--output", out, *dbc, *more, *([] if more else ["--rate", "100"]), "--from", "0.5", "--to", "1")
            self.require_times(out, times[50:100])

    def check_doubles_of_hdf5_are_written_in_plain_digits(self):
        if h5py is None:
            return
        with h5py.File(self.folder / "doubles.h5", "w") as file:
            file["time_s"], file["rate_radps"] = 1_763_000_000 + numpy.arange(ROWS) / RATE_HZ, numpy.full(ROWS, 1e-6)
        out, again = self.folder / "doubles.csv", self.folder / "again.csv"
        ifog("convert", self.folder / "doubles.h5", out)
        assert out.read_text().splitlines()[1].startswith("1763000000,"), out.read_text()[:60]
        ifog("convert", out, again)
        assert again.read_bytes() == out.read_bytes()

    def check_hdf5_has_all_the_digits(self):
        if h5py is None:
            print("left out: HDF5 (apt install python3-h5py)")
            return
        for number, (kind, start) in enumerate(zip(KINDS, STARTS.values())):
            times = [start + t for t in self.series[kind][0]]
            path, options = self.hdf5("moved.h5", times, kind, "<i8" if start < 0 or number % 2 else ">u8")
            out = self.folder / "converted.csv"
            ifog("convert", path, out, *options)
            self.require_times(out, times)
            self.require_same("allan", kind, start, path, options)
            self.require_same("denoise", kind, start, path, options)
            # Our files have them as doubles for simple readers, and exactly.
            ours = self.folder / "ours.h5"
            ifog("convert", path, ours, *options)
            with h5py.File(ours) as file:
                assert file["time_ns"].dtype == "<i8" and list(file["time_ns"][:]) == times
                assert [float(t) for t in file["time_s"][:]] == [float(Decimal(t).scaleb(-9)) for t in times]
            self.require_same("allan", kind, start, ours, [])
            self.require_same("denoise", kind, start, ours, COLUMNS)
            again = self.folder / "again.h5"
            ifog("convert", ours, again)
            assert again.read_bytes() == ours.read_bytes()
        records = numpy.zeros(ROWS, dtype=[("t", "<i8"), ("rate_radps", "<f8")])
        records["t"], records["rate_radps"] = times, 1e-6
        for chunks in (True, (ROWS,)):
            with h5py.File(self.folder / "table.h5", "w") as file:
                file.create_dataset("t", data=records, chunks=chunks, compression="gzip")
            ifog("convert", self.folder / "table.h5", out, "--group", "/t", "--time", "t:ns", "--column", "rate_radps=rate_radps")
            self.require_times(out, times)

    def check_times_that_go_back_are_of_a_clock_or_refused_with_their_line(self):
        ns, half, start = self.series["even"][0], ROWS // 2, STARTS["1970"]
        rollovers = {
            "a GPS week": [(604_800 * S - ns[half] + t) % (604_800 * S) for t in ns],
            "a day": [(86_400 * S - ns[half] + t) % (86_400 * S) for t in ns],
            "a count of µs in 32 bits": [(2**32 * 1000 - ns[half] + t) % (2**32 * 1000) for t in ns],
        }
        for what, times in rollovers.items():
            path, _ = self.csv("over.csv", times)
            result = ran("convert", path, self.folder / "over-read.csv")
            assert result.returncode == 0 and f"rolls over, as {what} does" in result.stderr, f"{what}: {result.stderr}"
        for what, times in {
            "two recordings": [t if i < half else ns[i - half] for i, t in enumerate(ns)],
            "a clock set by 5 s": [start + t - (5 * S if i >= half else 0) for i, t in enumerate(ns)],
            "a leap second": [start + t - (S if i >= half else 0) for i, t in enumerate(ns)],
        }.items():
            path, _ = self.csv("joined.csv", times)
            result = ran("convert", path, self.folder / "joined-read.csv")
            assert result.returncode == 0 and f"joined.csv:{half + 2}: time_s begins again at " in result.stderr, f"{what}: {result.stderr}"
        times = [start + t - (S if i % 20 == 19 else 0) for i, t in enumerate(ns)]
        path, _ = self.csv("back.csv", times)
        for command in (["allan"], ["tune"], ["diagnose"], ["convert", self.folder / "never.csv"], ["denoise", "--output", self.folder / "never.csv"]):
            refused(1, command[0], path, *command[1:], says=["back.csv:21: time_s is ", " s, expected more than in the row before"])
        if h5py is not None:
            path, options = self.hdf5("back.h5", times, "even", "<i8")
            refused(1, "allan", path, *options, says=["t is ", f"{path}:20: ", " s, expected more"])
        assert not (self.folder / "never.csv").exists()

    def check_holes_are_counted(self):
        """A leap second forward, and concatenated recordings, compared with steps of whole periods."""
        ns, half = self.series["even"][0], ROWS // 2
        for later_s, start in ((1, STARTS["1970"]), (7200, STARTS["GPS"]), (1, 0)):
            path, _ = self.csv("hole.csv", [start + t + (later_s * S if i >= half else 0) for i, t in enumerate(ns)])
            missing, place = later_s * RATE_HZ, f"hole.csv:{half + 1}: 1 gap in the time column ({later_s * RATE_HZ} samples missing), the first after "
            axis = self.answer("allan", path, [])[0]["axes"][0]
            assert axis["missing"] == missing and axis["gaps"] == 1, axis
            assert f"{missing} more lost in 1 gap" in ifog("denoise", path, "--output", self.folder / "out.csv")
            said = ran("allan", path).stdout
            told = float(said.partition(f"({missing} samples missing), the first after ")[2].split()[0])
            assert abs(told - start / S - ns[half - 1] / S) < 1e-5, (place, told)
            if later_s == 1 and start != 0:
                moved = axis
        # The Allan deviation of both halves is independent of their times.
        assert moved["adev_radps"] == axis["adev_radps"]

    def check_another_rate_is_said_and_losses_are_none(self):
        """200 Hz and then 210 Hz, as of a logger that was set anew; 200 Hz of which half lose one row in twenty."""
        draw = random.Random(3)
        rate = [draw.gauss(0, 1e-5) for _ in range(8000)]
        for name, rows, told in (("faster", [(i * 0.005 - max(0, i - 4000) * 0.000238095, r) for i, r in enumerate(rate)], True),
                                 ("lossy", [(i * 0.005, r) for i, r in enumerate(rate) if i < 4000 or i % 20], False)):
            path = self.folder / f"{name}.csv"
            path.write_text("time_s,rate_radps\n" + "".join(f"{t:.6f},{r!r}\n" for t, r in rows))
            said = ran("allan", path)
            assert ("rows come at 200 Hz until 20" in said.stderr + said.stdout) == told, said.stderr
            assert ("gaps in the time column" in said.stderr + said.stdout) != told, said.stderr

    def check_a_clock_that_is_set_is_said(self):
        """From seconds since power-up to seconds since 1970."""
        ns, half = self.series["even"][0], ROWS // 2
        path, _ = self.csv("set.csv", [t + (STARTS["1970"] if i >= half else 0) for i, t in enumerate(ns)])
        for command in (["allan"], ["convert", self.folder / "out.csv"], ["denoise", "--output", self.folder / "out.csv"]):
            said = ran(command[0], path, *command[1:]).stderr
            assert f"set.csv:{half + 2}: time_s continues 1700000000 s later, as after a clock was set" in said, (command, said)


if __name__ == "__main__":
    sys.exit(main_of(Checks))

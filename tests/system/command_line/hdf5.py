#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Captures in HDF5: files of `ifog` read by h5py and h5dump, files of h5py read by `ifog`; foreign, damaged and hostile files, each
rejected with one line.

usage: hdf5.py PATH_OF_IFOG SOURCE_DIR Exit 77 without h5py or h5dump.
"""
import gzip
import hashlib
import os
import random
import resource
import shutil
import struct
import subprocess
import sys

try:
    import h5py
    import numpy
except ImportError as missing:
    print(f"skipped: {missing} (apt install python3-h5py)")
    sys.exit(77)
if shutil.which("h5dump") is None:
    print("skipped: no h5dump (apt install hdf5-tools)")
    sys.exit(77)

from run import IFOG, ifog, main_of, refused

CSV = """# a gyro, by hand
# second line: ° and "quotes"
time_s,rate_x_radps,rate_z_radps,reference_rate_x_radps,temperature_degC,supply_V
0,1e-3,-0,0.1,25.5,5
0.1,0.30000000000000004,4.9e-324,nan,,5.000000000000001
0.30000000000000004,-1.7976931348623157e-5,2.2250738585072014e-308,0.125,-40,4.999
"""


def bits(values):
    return [struct.pack("<d", value) for value in values]


def random_columns(rows, seed):
    """Doubles of all magnitudes of a rate, and increasing times."""
    draw = numpy.random.default_rng(seed)
    time = numpy.cumsum(draw.uniform(1e-9, 1e-3, rows))
    rate = draw.standard_normal(rows) * 10.0 ** draw.integers(-300, -5, rows)
    temperature = draw.uniform(-40, 80, rows)
    temperature[draw.random(rows) < 0.1] = numpy.nan
    return {"time_s": time, "rate_radps": rate, "temperature_degC": temperature}


def write(path, columns, group="/", **how):
    with h5py.File(path, "w") as file:
        for name, values in columns.items():
            file.require_group(group).create_dataset(name, data=values, **how)
    return path


def table(text):
    lines = [line for line in text.splitlines() if not line.startswith("#")]
    rows = [[float(cell) if cell else float("nan") for cell in line.split(",")] for line in lines[1:]]
    return dict(zip(lines[0].split(","), map(list, zip(*rows))))


class Checks:
    def __init__(self, folder):
        self.folder = folder
        self.csv = self.folder / "by_hand.csv"
        self.csv.write_text(CSV)
        self.good = write(self.folder / "good.h5", random_columns(5000, 1), compression="gzip", shuffle=True, chunks=(300,))

    def converted(self, file, *options):
        out = self.folder / "out.csv"
        ifog("convert", file, out, *options)
        return table(out.read_text())

    def refused(self, file, *parts, options=()):
        refused(1, "convert", file, self.folder / "never.csv", *options, says=[str(file), *parts])

    def check_h5py_reads_what_we_wrote(self):
        out = self.folder / "by_hand.h5"
        ifog("convert", self.csv, out)
        expected = table(CSV)
        with h5py.File(out, "r") as file:
            assert sorted(file) == sorted(expected), list(file)
            for name, dataset in file.items():
                assert dataset.dtype == "<f8" and dataset.shape == (3,) and dataset.chunks == (3,), name
                assert dataset.compression == "gzip" and dataset.shuffle, name
                for mine, its in zip(expected[name], dataset[:]):
                    assert (mine != mine and its != its) or bits([mine]) == bits([its]), (name, mine, its)
            units = {name: dataset.attrs["units"] for name, dataset in file.items()}
            assert units["time_s"] == "s" and units["rate_x_radps"] == "rad/s" and units["temperature_degC"] == "degC", units
            assert list(file.attrs["comments"]) == ["a gyro, by hand", 'second line: ° and "quotes"'], list(file.attrs["comments"])

    def check_h5dump_reads_what_we_wrote(self):
        out = self.folder / "dumped.h5"
        ifog("convert", self.csv, out)
        said = subprocess.run(["h5dump", "-p", "-m", "%.17g", out], capture_output=True, text=True, check=True).stdout
        for part in ('DATASET "rate_z_radps"', "PREPROCESSING SHUFFLE", "COMPRESSION DEFLATE { LEVEL 6 }", "0.30000000000000004", '"rad/s"'):
            assert part in said, part

    def check_there_and_back_is_the_same_text(self):
        """Also in many chunks of several sizes, and the columns in order."""
        columns = random_columns(200_001, 2)
        text = "# one\n" + ",".join(columns) + "\n" + "".join(
            ",".join("nan" if v != v else repr(float(v)) for v in row) + "\n" for row in zip(*columns.values()))
        first, packed, back = self.folder / "first.csv", self.folder / "packed.h5", self.folder / "back.csv"
        first.write_text(text)
        ifog("convert", first, packed)
        ifog("convert", packed, back)
        there = table(back.read_text())
        assert list(there) == list(columns)
        for name, values in columns.items():
            same = [(a != a and b != b) or struct.pack("<d", a) == struct.pack("<d", b) for a, b in zip(values, there[name])]
            assert len(there[name]) == len(values) and all(same), name
        assert back.read_text().startswith("# one\n")
        again = self.folder / "again.h5"
        ifog("convert", packed, again)
        assert again.read_bytes() == packed.read_bytes(), "the same capture is not the same file"

    def check_reads_what_h5py_wrote(self):
        expected = random_columns(5000, 1)
        for name, how in {"plain": {}, "chunks": {"chunks": (7,)}, "gzip": {"compression": "gzip", "shuffle": True, "chunks": (4999,)},
                          "checked": {"fletcher32": True, "chunks": (100,)}, "shuffled": {"shuffle": True, "chunks": (64,)}}.items():
            file = write(self.folder / f"{name}.h5", expected, **how)
            found = self.converted(file)
            for column, values in expected.items():
                assert all((a != a and b != b) or a == b for a, b in zip(values, found[column])), (name, column)

    def check_reads_every_kind_of_number(self):
        for kind in ("<f4", ">f8", ">f4", "<i2", ">i4", "<u1", "<f2"):
            file = write(self.folder / "kind.h5", {"time_s": numpy.arange(4, dtype=">i8"), "rate_radps": numpy.array([0, 1, 2, 3], dtype=kind)})
            assert self.converted(file)["rate_radps"] == [0, 1, 2, 3], kind

    def check_reads_pipes_packed_files_and_any_name(self):
        text = self.converted(self.good)
        unnamed = self.folder / "capture"
        unnamed.write_bytes(self.good.read_bytes())
        assert str(self.converted(unnamed)) == str(text)  # nan is not equal to itself
        packed = self.folder / "packed.h5.gz"
        packed.write_bytes(gzip.compress(self.good.read_bytes()))
        assert str(self.converted(packed)) == str(text)
        piped = subprocess.run([IFOG, "convert", "-", "-"], input=self.good.read_bytes(), capture_output=True, check=False, timeout=60)
        assert piped.returncode == 0 and str(table(piped.stdout.decode())) == str(text), piped.stderr
        behind = self.folder / "behind.mat"  # as MATLAB writes them
        with h5py.File(behind, "w", userblock_size=512) as file:
            for name, values in random_columns(5000, 1).items():
                file[name] = values
        assert str(self.converted(behind)) == str(text)

    def check_every_command_reads_and_writes_them(self):
        capture = self.folder / "rest.h5"
        scenario = self.folder / "rest.toml"
        scenario.write_text("seed = 3\nsample_rate_hz = 50\nduration_s = 200\n[noise]\nN = 2.5e-7\n")
        ifog("simulate", scenario, "--output", capture, "--truth", self.folder / "truth.h5")
        ifog("simulate", scenario, "--output", self.folder / "rest.csv")
        with h5py.File(self.folder / "truth.h5") as truth:
            assert "time_s" in truth and len(truth["time_s"]) == 10_000
        for command in ("allan", "tune", "compare"):
            outputs = []
            for file in (capture, self.folder / "rest.csv"):
                json = self.folder / f"{command}.json"
                ifog(command, file, "--json", json)
                outputs.append(json.read_text().replace(".csv", ".h5"))
            assert outputs[0].count("\n") == outputs[1].count("\n"), command
            if command == "allan":
                assert outputs[0] == outputs[1]
        ifog("denoise", capture, "--output", self.folder / "denoised.h5")
        ifog("denoise", self.folder / "rest.csv", "--output", self.folder / "denoised.csv")
        expected = table((self.folder / "denoised.csv").read_text())
        with h5py.File(self.folder / "denoised.h5") as denoised:
            assert sorted(denoised) == sorted(expected), list(denoised)
            for name, values in expected.items():
                assert bits(values) == bits(denoised[name][:]), name
        ifog("diagnose", capture)
        ifog("replay", capture, "--driver", "kvh1750", "--option", "format=b", "--speed", "0", "--to", f"file:{self.folder / 'sent.kvh'}")

    def check_a_large_file_is_hashed_in_pieces(self):
        """Only some columns are read, in less memory than the file's size."""
        draw = numpy.random.default_rng(3)
        path, model = self.folder / "large.h5", self.folder / "large.toml"
        write(path, {"time_s": numpy.arange(20000) / 100, "rate_radps": 1e-5 * draw.standard_normal(20000)}, group="/imu")
        with h5py.File(path, "a") as file:
            blob = file.create_dataset("elsewhere", shape=(600 << 20,), dtype="u1")
            blob[-1] = 1  # written, but mostly a hole of the file
        assert path.stat().st_size > 600 << 20
        limit = 500 << 20
        done = subprocess.run([IFOG, "diagnose", "--quiet", path, "--group", "/imu", "--write-model", model], capture_output=True, text=True,
                              check=False, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_DATA, (limit, limit)))
        assert done.returncode == 0, done
        with open(path, "rb") as file:
            digest = hashlib.file_digest(file, "sha256").hexdigest()
        path.unlink()
        assert digest in model.read_text(), model.read_text()

    def check_groups_and_names_of_ones_own(self):
        columns = {"t": numpy.arange(5) * 10, "GyroX": numpy.array([1.0, 2, 3, 4, 5]), "T": numpy.array([32.0, 50, 32, 32, 32]),
                   "note": numpy.array([b"a", b"b", b"c", b"d", b"e"])}
        file = write(self.folder / "own.h5", columns, group="/flight/imu")
        chosen = ["--time", "t:ms", "--column", "rate_x_radps=GyroX:deg/s", "--column", "temperature_degC=T:degF"]
        for options in (["--group", "/flight/imu", *chosen], ["--group", "flight/imu", *chosen],
                        [option.replace("GyroX", "flight/imu/GyroX").replace("T:degF", "flight/imu/T:degF").replace("t:ms", "flight/imu/t:ms")
                         for option in chosen]):
            found = self.converted(file, *options)
            assert found["time_s"] == [0, 0.01, 0.02, 0.03, 0.04] and abs(found["temperature_degC"][0]) < 1e-12, found
            assert abs(found["rate_x_radps"][1] - numpy.radians(2)) < 1e-15
        native = write(self.folder / "native.h5", random_columns(10, 3), group="/a")
        with h5py.File(native, "a") as inside:
            inside["a"].create_group("more")
        assert sorted(self.converted(native, "--group", "/a")) == ["rate_radps", "temperature_degC", "time_s"]
        self.refused(native, "no dataset of numbers in the group '/'; its groups and tables are read by '--group /a'")
        self.refused(file, "no dataset of numbers in the group 'flight'; its groups and tables are read by '--group flight/imu'", options=["--group", "flight"])
        self.refused(native, "no group '/b', expected one of the file's: '--group /a'", options=["--group", "/b"])
        self.refused(file, "no dataset 'GyroY', the group has", "'GyroX'", options=["--group", "/flight/imu", "--column", "rate_radps=GyroY:deg/s", "--time", "t:ms"])
        refused(2, "convert", self.csv, self.folder / "x.h5", "--group", "/a", says=["expected an HDF5 file"])

    def check_units_are_taken_from_attributes(self):
        file = write(self.folder / "units.h5", {"time_s": numpy.arange(3.0), "rate_radps": numpy.array([1.0, 2, 3])})
        with h5py.File(file, "a") as inside:
            inside["rate_radps"].attrs["units"] = "deg/s"
        self.refused(file, "the unit of 'rate_radps' is given as 'deg/s'", "--column rate_radps=rate_radps:deg/s")
        for options in (["--column", "rate_radps=rate_radps"], ["--column", "rate_radps=rate_radps:deg/s"]):
            assert abs(self.converted(file, *options)["rate_radps"][0] - numpy.radians(1)) < 1e-16, options
        named = write(self.folder / "named.h5", {"time_s": numpy.arange(3.0), "rate_dps": numpy.array([1.0, 2, 3])})
        assert abs(self.converted(named, "--column", "rate_radps=rate_dps")["rate_radps"][0] - numpy.radians(1)) < 1e-16
        with h5py.File(file, "a") as inside:
            inside["rate_radps"].attrs["units"] = numpy.bytes_(b"rad/s")
        assert self.converted(file)["rate_radps"] == [1, 2, 3]

    def check_tables_of_records(self):
        """As written by PyTables and pandas (format='table')."""
        records = numpy.zeros(5000, dtype=[("index", "<i8"), ("gyro_z", "<f4"), ("name", "S4"), ("T", "<f8")])
        records["index"] = 1_700_000_000_000_000_000 + numpy.arange(5000) * 10_000_000
        records["gyro_z"] = numpy.arange(5000) % 7
        records["T"] = 20
        file = self.folder / "pandas.h5"
        with h5py.File(file, "w") as inside:
            inside.create_dataset("imu/table", data=records, chunks=(100,), compression="gzip", shuffle=True)
        self.refused(file, "no dataset of numbers in the group '/imu'; its groups and tables are read by '--group /imu/table'", options=["--group", "/imu"])
        found = self.converted(file, "--group", "/imu/table", "--time", "index:ns", "--column", "rate_z_radps=gyro_z:deg/s",
                               "--column", "temperature_degC=T")
        assert len(found["time_s"]) == 5000 and numpy.allclose(found["rate_z_radps"][:7], numpy.radians(numpy.arange(7)), rtol=1e-15)
        self.refused(file, "holds text", options=["--group", "/imu/table", "--time", "index:ns", "--column", "rate_radps=name"])
        self.refused(file, "no column 'x', the table has 'index', 'gyro_z'", options=["--group", "/imu/table", "--time", "index:ns", "--column", "rate_radps=x"])

    def check_what_is_no_column_is_refused(self):
        time = numpy.arange(4.0)
        for name, extra, parts in [
                ("rank", {"rate_radps": numpy.zeros((4, 2, 2))}, ["'rate_radps' has 3 dimensions, expected one"]),
                ("scalar", {"rate_radps": 5.0}, ["'rate_radps' has 0 dimensions, expected one"]),
                ("short", {"rate_radps": numpy.zeros(3)}, ["'rate_radps' has 3 rows, expected the 4 of 'time_s'"]),
                ("text", {"rate_radps": numpy.array([b"a"] * 4)}, ["'rate_radps' holds text, expected numbers"]),
                ("words", {"rate_radps": numpy.array(["a"] * 4, dtype=h5py.string_dtype())}, ["'rate_radps' holds text"]),
                ("truth", {"rate_radps": numpy.array([True] * 4)}, ["holds an enumeration"]),
                ("complex", {"rate_radps": numpy.zeros(4, dtype=complex)}, ["holds records"]),
                ("none", {}, ["no rate column"]),
                ("infinite", {"rate_radps": numpy.array([0, 1, numpy.inf, numpy.inf])}, [":3: rate_radps is 'inf', which no sensor measures"]),
        ]:
            self.refused(write(self.folder / f"{name}.h5", {"time_s": time, **extra}), *parts)
        still = {"rate_radps": numpy.zeros(4)}
        assert self.converted(write(self.folder / "t.h5", {"time_s": time, **still, 'a"b_V': time}))['"a""b_V"'] == [0, 1, 2, 3]
        self.refused(write(self.folder / "t.h5", {"time_s": [0.0, 1, 0.5, 2], **still}), ":2: time_s is 1 s, expected less than in the next row")
        self.refused(write(self.folder / "t.h5", {"time_s": [0.0, 1, numpy.nan, 2], **still}), ":3: time_s is missing, expected a time")
        self.refused(write(self.folder / "t.h5", {"time_s": numpy.zeros(0), "rate_radps": numpy.zeros(0)}), "no rows")
        self.refused(write(self.folder / "t.h5", {"Time": time, "GyroX": time}), "the unit of the time is not named", "--time Time:s", "GyroX:rad/s")
        self.refused(write(self.folder / "t.h5", {"time_s": time, "rate_radps": time * 1e9}), "which no sensor measures")
        refused(2, "convert", self.good, self.folder / "x.csv", "--separator", ";", says=["--separator"])

    def check_links_stay_within_the_file(self):
        other = write(self.folder / "other.h5", {"rate_radps": numpy.zeros(4)})
        (self.folder / "raw").write_bytes(bytes(32))
        file = self.folder / "links.h5"

        def made(add):
            with h5py.File(file, "w") as inside:
                inside["time_s"] = numpy.arange(4.0)
                add(inside)
            return file
        self.refused(made(lambda f: f.__setitem__("rate_radps", h5py.ExternalLink(str(other), "rate_radps"))), "'rate_radps' is a link into another file")
        self.refused(made(lambda f: f.__setitem__("rate_radps", h5py.SoftLink("/nowhere"))), "'rate_radps' leads to nothing")
        self.refused(made(lambda f: f.__setitem__("rate_radps", h5py.SoftLink("/rate_radps"))), "'rate_radps' leads to nothing")
        self.refused(made(lambda f: f.create_dataset("rate_radps", shape=(4,), dtype="f8", external=[(str(self.folder / "raw"), 0, 32)])), "keeps its values in another file")
        layout = h5py.VirtualLayout(shape=(4,), dtype="f8")
        layout[:] = h5py.VirtualSource(str(other), "rate_radps", shape=(4,))
        self.refused(made(lambda f: f.create_virtual_dataset("rate_radps", layout)), "keeps its values in another file")
        through = made(lambda f: f.__setitem__("there", h5py.ExternalLink(str(other), "/")))
        self.refused(through, options=["--column", "rate_radps=there/rate_radps"])

        def circle(inside):
            inside["rate_radps"] = numpy.zeros(4)
            inside["ring"] = inside["/"]
            inside["ring/round"] = inside["ring"]
            inside["soft"] = h5py.SoftLink("/rate_radps")
        ring = made(circle)
        assert self.converted(ring, "--group", "/ring/round/ring/ring", "--column", "rate_radps=ring/soft")["rate_radps"] == [0] * 4

    def check_a_filter_that_is_not_here_is_named(self):
        file = write(self.folder / "lzf.h5", random_columns(500, 4), compression="lzf", chunks=(100,))
        self.refused(file, "is packed by filter 32000 (lzf), which is not here, expected gzip")

    def check_columns_that_stay_as_they_are_come_back(self):
        """More than 256 MiB of text or numbers that compress to less than a hundredth or a thousandth: accepted completely."""
        rows, columns = 120_000, 120
        still = {f"c{i}_counts": 1.2345678901234567e-05 * (i + 1) for i in range(columns)}
        text, first, packed, again = (self.folder / name for name in ("still.csv", "still.h5", "still.csv.gz", "again.h5"))
        cells = "," + ",".join(repr(value) for value in still.values()) + "\n"
        with open(text, "w") as out:
            out.write("time_s,rate_radps," + ",".join(still) + "\n")
            for i in range(rows):
                out.write(f"{i},0" + cells)
        ifog("convert", text, first)
        ifog("convert", first, packed)
        ifog("convert", packed, again)
        assert text.stat().st_size > max(256 << 20, 130 * packed.stat().st_size), packed.stat()
        assert again.read_bytes() == first.read_bytes(), "other numbers"
        with h5py.File(again) as file:
            for name, value in still.items():
                assert file[name].shape == (rows,) and numpy.all(file[name][:] == value), name
        for file in (text, first, packed, again):
            file.unlink()
        # Bytes that do not compress become eight times larger as numbers.
        flags = {"time_s": numpy.arange(4_000_000, dtype="<i4"), "rate_radps": numpy.zeros(4_000_000, dtype="<i1")}
        flags.update({f"flag_{i}_counts": numpy.full(4_000_000, i, dtype="<u1") for i in range(9)})
        file = write(self.folder / "flags.h5", flags, compression="gzip", compression_opts=9, shuffle=True, chunks=(65536,))
        assert 4_000_000 * len(flags) * 8 > max(256 << 20, 1100 * file.stat().st_size), file.stat()
        ifog("convert", file, again)
        with h5py.File(again) as back:
            assert all(numpy.array_equal(back[name][:], values) for name, values in flags.items())

    def check_reads_tables_of_one_chunk(self):
        """Larger than the buffer of a dataset unless it is all in one chunk."""
        rows = 700_000
        expected = random_columns(rows, 7)
        records = numpy.rec.fromarrays(list(expected.values()), names=list(expected))
        file = self.folder / "table.h5"
        with h5py.File(file, "w") as inside:
            inside.create_dataset("t", data=records, chunks=(rows,), compression="gzip", compression_opts=1)
        out = self.folder / "table_back.h5"
        ifog("convert", file, out, "--group", "/t", *(word for name in list(expected)[1:] for word in ("--column", f"{name}={name}")))
        with h5py.File(out) as back:
            for name, values in expected.items():
                assert back[name][:].tobytes() == values.tobytes(), name
        with h5py.File(file, "w") as inside:  # more than is kept of all columns: 512 MiB
            for name in ("time_s", "rate_radps"):
                inside.create_dataset(name, data=numpy.arange(4.0), maxshape=(None,), chunks=(2**27,), compression="gzip")
        self.refused(file, "is packed in chunks of 1024 MiB, expected at most 512 MiB in all columns; 'h5repack -l CHUNK=65536'")

    def check_more_than_there_is_is_not_believed(self):
        """A file of a few kilobytes that claims a thousand million rows."""
        file = self.folder / "bomb.h5"
        with h5py.File(file, "w") as inside:
            for name in ("time_s", "rate_radps"):
                inside.create_dataset(name, shape=(2**40,), dtype="f8", chunks=(1024,))
        self.refused(file, "grows to more than 256 MiB")
        with h5py.File(file, "w") as inside:  # a chunk that unpacks to more than the memory limit
            for name in ("time_s", "rate_radps"):
                inside.create_dataset(name, data=numpy.zeros(2**24), chunks=(2**24,), compression="gzip", compression_opts=9)
        assert self.converted(file)["time_s"] == [0]  # a row and its repetitions

    def check_damaged_files_are_refused_or_read(self):
        """Truncated at any place; single bytes and runs of bytes changed. Never a crash, never two lines, never a hang."""
        small = write(self.folder / "small.h5", random_columns(300, 5), compression="gzip", shuffle=True, chunks=(100,))
        grouped = self.folder / "grouped.h5"
        ifog("convert", self.csv, grouped)
        draw = random.Random(6)
        refusals = 0
        for number in range(160):
            whole = (small if number % 2 else grouped).read_bytes()
            if number % 4 < 2:
                bad = whole[:draw.randrange(len(whole))]
            else:
                changed = bytearray(whole)
                for _ in range(draw.choice([1, 3, 20])):
                    at = draw.randrange(min(len(changed), 3000) if number % 8 < 6 else len(changed))
                    changed[at] = draw.choice([0, 0xFF, 0x7F, changed[at] ^ 1 << draw.randrange(8)])
                bad = bytes(changed)
            file = self.folder / "bad.h5"
            file.write_bytes(bad)
            done = subprocess.run([IFOG, "convert", file, self.folder / "bad.csv"], capture_output=True, timeout=30, check=False)
            said = done.stderr.decode(errors="replace").strip().splitlines()
            assert done.returncode in (0, 1), (number, done)
            refusals += done.returncode
            if done.returncode == 1:
                assert len(said) == 1 and str(file) in said[0], (number, said)
        assert refusals > 80, refusals

    def check_what_is_no_hdf5_is_refused(self):
        text = self.folder / "text.h5"
        text.write_text("a letter, of what was measured\n0,1\n")
        self.refused(text, "cannot be read as HDF5")
        folder = self.folder / "folder.h5"
        os.mkdir(folder)
        self.refused(folder)


if __name__ == "__main__":
    sys.exit(main_of(Checks))

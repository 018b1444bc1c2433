#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon with its flight recorder: what the command line makes of the recording is what the daemon published, and what the
device sent.

usage: recorded.py BUILD [PART OF A CHECK'S NAME...]
"""
import collections
import csv
import json
import math
import os
import re
import shutil
import signal
import socket
import subprocess
import time

import process
from process import DAEMON, FILTER, IFOG

MODEL = """version = 1
sensor = "made"
[[effect]]
form = "linear"
channel = "supply_V"
axis = "y"
reference = 12.0
[[effect.parameter]]
name = "coefficient"
value = 1e-3
std_error = 1e-6
unit = "rad/s/V"
"""
NOISE = """schema = "ifog.noise/2"
sensor = "nose"
driver = "kvh1750"
axes = 3
sample_rate_hz = 1000
learned = "2026-01-31T13:05:09Z"
model = ""
process_noise = 3e-11
measurement_noise = 2e-8
noise = [2e-8, 2.2e-8, 1.8e-8]
samples = 1e6
"""
FLIGHT, OUT = "record/nose", "denoised.csv"


def configure(daemon, model='model = "model.toml"\n', rate_hz=1000, transport='type = "file"\npath = "line"\n', given=FILTER, realtime=""):
    daemon.fifo("line")
    daemon.write("supply", "11500\n")
    daemon.write("model.toml", MODEL)
    daemon.configure(f"""{DAEMON}state_folder = "state"
[[sensor]]
name = "nose"
driver = "kvh1750"
nominal_rate_hz = {rate_hz}
{model}[sensor.options]
format = "a"
[sensor.transport]
{transport}{given}{realtime}[sensor.record]
folder = "record"
file_bytes = 100_000
bytes = 1_000_000
[[sensor.channel]]
name = "supply_V"
source = "file"
path = "supply"
scale = 1e-3
period_s = 0.01
max_age_s = 0.5
""")


def rates(n):
    return [0.01 * (i + 1) + 1e-4 * math.sin(0.3 * n * (i + 1)) for i in range(3)]


def send(daemon, count):
    """In portions that the buffer of the listener's socket holds; returns the bytes."""
    daemon.listen(0)
    sent = b""
    for _ in range(count // 50):
        expected = len(daemon.listener.rates) + 50
        sent += daemon.send("line", 50, rates, lambda n: 20 + n // 100)
        daemon.until(lambda: len(daemon.listener.rates) >= expected, "the samples")
    return sent


def ifog(daemon, *arguments, program=IFOG):
    """Must succeed; returns what it says to standard error."""
    done = subprocess.run([program, *arguments], cwd=daemon.folder, stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True, timeout=60, check=False)
    assert done.returncode == 0, f"ifog {arguments}: {done.stderr}"
    return done.stderr


def rows_of(daemon, name):
    """The numbers of each row; NaN for an empty cell."""
    with open(daemon.path(name), newline="") as file:
        rows = list(csv.reader(line for line in file if not line.startswith("#")))
    return [[float(cell or "nan") for cell in row] for row in rows[1:]]


def same(daemon, rows, first=None):
    """Every denoised row is what was published, to the bit: raw, compensated, denoised and variance of each axis."""
    published = daemon.listener.rates
    assert first or len(rows) == len(published), f"{len(rows)} rows, {len(published)} published"
    for n, (row, message) in enumerate(list(zip(rows, published))[:first]):
        expected = [column[axis] for axis in range(3) for column in (message.raw, message.compensated, message.denoised, message.variance)]
        assert row[1:13] == expected, f"{n}: {row}, published {expected}"


def check_denoise_begins_with_the_noise_the_daemon_began_with(daemon):
    """It is in the recording of a sensor that has run before, although the state folder is another one since."""
    daemon.path("state").mkdir()
    daemon.write("state/nose.noise.toml", NOISE)
    configure(daemon, given="")
    daemon.start()
    send(daemon, 1500)
    daemon.ends_well()
    shutil.rmtree(daemon.path("state"))
    daemon.path("ifogd.toml").unlink()
    ifog(daemon, "denoise", FLIGHT, "--output", OUT)
    same(daemon, rows_of(daemon, OUT))
    # Without it the noise of the first seconds is unknown.
    message = daemon.listener.rates[1000]
    assert message.flags & message.FLAG_NOISE_UNKNOWN == 0 and message.variance[0] > 0


def reload(daemon, expected):
    daemon.process.send_signal(signal.SIGHUP)
    daemon.until(lambda: expected in daemon.said(), expected)
    time.sleep(1.1)  # new parts are in use from the next delivery on, or from the one after it


def check_denoise_gives_what_was_published_through_reloads_and_restarts(daemon):
    """A reload that changes nothing, one that changes the model, one that changes the filter, and a restart."""
    configure(daemon)
    daemon.start()
    sent = b""
    for n in range(12):
        if n % 4 == 2:
            daemon.write("supply", f"{11_600 + 500 * n}\n")
        sent += send(daemon, 50)
    published = daemon.listener.rates
    assert published[-1].denoised[0] != published[-1].compensated[0], "its noise is known"
    reload(daemon, "nothing changed, the filter continues")
    sent += send(daemon, 200)
    assert not any(message.flags & message.FLAG_NOISE_UNKNOWN for message in published[600:])
    other = MODEL.replace("1e-3", "4e-3")
    daemon.write("model.toml", other)
    reload(daemon, "reloaded: model")
    sent += send(daemon, 600)
    configure(daemon, given=FILTER.replace("1e-10", "2e-10"))
    daemon.write("model.toml", other)
    reload(daemon, "reloaded: model")
    sent += send(daemon, 300)
    daemon.ends_well()
    daemon.start()
    sent += send(daemon, 300)
    daemon.ends_well()
    assert len({message.model for message in published}) == 2
    # The recording carries what it needs.
    for name in ("model.toml", "ifogd.toml", "supply"):
        daemon.path(name).unlink()
    said = ifog(daemon, "denoise", FLIGHT, "--output", OUT)
    runs, _, rest = said.partition("\n")
    assert runs.startswith(f"{FLIGHT}: 2 runs of what wrote it, with "), said
    stale = sum(message.flags & message.FLAG_STALE_CHANNEL != 0 for message in published)
    assert rest == (f"{FLIGHT}: {stale} samples without a value of a channel that the model wants, or with one too old: corrected with the last "
                    "one, or not at all\n" if stale else ""), said
    same(daemon, rows_of(daemon, OUT))
    assert any(message.compensated[1] != message.raw[1] for message in published)
    # Every command reads it as a capture, with the channel from elsewhere; and it is sent again to the bit.
    ifog(daemon, "convert", FLIGHT, "capture.csv")
    assert "supply_V" in daemon.read("capture.csv")[:200] and len(rows_of(daemon, "capture.csv")) == len(published)
    ifog(daemon, "allan", FLIGHT, "--json", "allan.json")
    ifog(daemon, "replay", FLIGHT, "--speed", "0", "--to", "file:again")
    assert daemon.path("again").read_bytes() == sent
    # Without its beginning the state of the filter is unknown, which is said.
    files = sorted(os.listdir(daemon.path(FLIGHT)))
    assert len(files) == 4, files
    daemon.path(f"{FLIGHT}/{files[0]}").unlink()
    assert "from 0 s on, until the filter has settled, this need not be what was published" in ifog(daemon, "denoise", FLIGHT, "--output", OUT)


def check_denoise_looks_for_drivers_where_the_configuration_says(daemon):
    configure(daemon)
    daemon.start()
    daemon.write("raw.bin", send(daemon, 100))
    daemon.ends_well()
    # A program that is not in the build tree finds no drivers near itself.
    for folder, file in (("bin", IFOG), ("plugins", process.BUILD / "plugins/kvh1750.so")):
        daemon.path(folder).mkdir()
        shutil.copy(file, daemon.path(folder))
    daemon.configure(daemon.read("ifogd.toml").replace("[daemon]", '[daemon]\nplugin_folder = "plugins"'))
    for recording in (FLIGHT, "raw.bin"):
        ifog(daemon, "denoise", recording, "--config", "ifogd.toml", "--output", "out.csv", program=daemon.path("bin/ifog"))


def check_after_a_kill_all_but_the_last_second_is_there_and_the_next_run_continues(daemon):
    configure(daemon, model="")
    daemon.start()
    sent = send(daemon, 500)
    time.sleep(1.5)
    assert daemon.end(signal.SIGKILL) == -signal.SIGKILL
    replay = ("replay", FLIGHT, "--speed", "0", "--to", "file:again")
    assert "without an end" in ifog(daemon, *replay)
    assert daemon.path("again").read_bytes() == sent
    daemon.start()
    sent += send(daemon, 500)
    daemon.ends_well()
    assert all(name.endswith(".ifr") for name in os.listdir(daemon.path(FLIGHT))), os.listdir(daemon.path(FLIGHT))
    # Every reader names the run that was killed, and for how long nothing was recorded.
    for command in (("denoise", FLIGHT, "--output", OUT), ("convert", FLIGHT, "capture.csv"), ("allan", FLIGHT)):
        said = ifog(daemon, *command)
        assert "1 run(s) of what wrote it were cut off" in said and "2 runs of what wrote it, with " in said, said
    assert rows_of(daemon, OUT)
    ifog(daemon, *replay)
    assert daemon.path("again").read_bytes() == sent


def check_what_the_ring_merged_is_said_by_denoise(daemon):
    """Of bursts that the ring has no room for: how many more rows there are than were published, and where."""
    configure(daemon, transport='type = "udp"\nbind = "127.0.0.1"\nport = 45671\n', realtime="[sensor.realtime]\nring_slots = 2\ndirect = false\n")
    os.close(daemon.fifos["line"])
    line = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)  # a source that does not wait until it is read
    line.connect(("127.0.0.1", 45671))
    daemon.fifos["line"] = line.detach()
    daemon.start()
    daemon.until(lambda: "reading udp" in daemon.said(), "the daemon to read")
    daemon.listen(0)
    published, came = daemon.listener.rates, lambda: sum(max(message.merged, 1) for message in daemon.listener.rates)
    for _ in range(200):
        daemon.send("line", 1, rates)
        daemon.until(lambda: len(published) == daemon.sent["line"], "the sample")
    for _ in range(100):
        daemon.send("line", 50, rates)
        daemon.until(lambda: came() == daemon.sent["line"], "the burst")
        if len(published) < came():
            break
    merged = daemon.sent["line"] - len(published)
    assert merged > 0
    daemon.ends_well()
    said = ifog(daemon, "denoise", FLIGHT, "--output", OUT, "--json", "denoised.json")
    rows = rows_of(daemon, OUT)
    assert len(rows) == len(published) + merged
    assert f": {merged} samples, the first about 0." in said and "were published as one with others (the ring was full)" in said, said
    assert f'"merged": {merged},' in daemon.read("denoised.json")
    same(daemon, rows, first=200)  # until the first of them


def check_lcm_is_recorded_on_another_computer_with_its_channels(daemon):
    configure(daemon, rate_hz=100)
    daemon.listen(0)
    with process.running(IFOG, "record", "--output", daemon.path("heard"), "--sensor", "nose", stdout=subprocess.DEVNULL) as recorder:
        daemon.start()
        daemon.until(daemon.path("heard").exists, "the recorder")
        for _ in range(100):  # it listens soon after its folder exists
            daemon.listen(0.01)
        due = time.monotonic()
        for _ in range(300):  # at the sensor's own rate, so that the fitted time advances
            due += 0.01
            time.sleep(max(0.0, due - time.monotonic()))
            expected = len(daemon.listener.rates) + 1
            daemon.send("line", 1, rates)
            daemon.until(lambda: len(daemon.listener.rates) >= expected, "the sample")
        daemon.seconds(2)
        daemon.ends_well()
        recorder.terminate()
        assert recorder.wait(60) == 0
    ifog(daemon, "convert", "heard", "capture.csv")
    assert "supply_V" in daemon.read("capture.csv")[:200]
    assert [row[1] for row in rows_of(daemon, "capture.csv")] == [message.raw[0] for message in daemon.listener.rates]
    ifog(daemon, "allan", "heard", "--json", "allan.json")


if __name__ == "__main__":
    process.main_of(globals())

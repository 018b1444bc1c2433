#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon while it runs: what reloading, silence, a lost log and a second daemon do to it.

usage: running.py BUILD [PART OF A CHECK'S NAME...]
"""
import fcntl
import os
import random
import re
import shutil
import signal
import stat
import subprocess
import time

import process
from process import DAEMON, FILTER, IFOG, frames

MODEL = 'version = 1\nsensor = "made"\n'
BUSY = "another recorder writes into it (expected a folder of its own)"


def run_second(daemon, name, code=None):
    """Another daemon; returns what it says."""
    with open(daemon.path("second"), "w") as said:
        status = subprocess.run([process.IFOGD, "--config", daemon.path(name)], stdout=said, stderr=said, timeout=60, check=False).returncode
    assert code in (None, status), daemon.said("second")
    return daemon.said("second")


def check_a_reload_takes_effect_for_all_sensors_or_for_none(daemon):
    def reload(*sensors, more=""):
        daemon.configure(DAEMON + more + "".join(daemon.sensor(*sensor) for sensor in sensors))
        daemon.process.send_signal(signal.SIGHUP)

    daemon.configure(DAEMON + daemon.sensor("nose") + daemon.sensor("tail"))
    daemon.start()
    daemon.send("nose", 10)
    daemon.send("tail", 10)
    daemon.published(10)
    # Of these two models only the first is good.
    daemon.write("good.toml", MODEL)
    daemon.write("bad.toml", MODEL + '[[range]]\nchannel = "temperature_degC"\nlow = 2.0\nhigh = 1.0\n')
    reload(("nose", 'model = "good.toml"\n'), ("tail", 'model = "bad.toml"\n'))
    daemon.says("reload refused: nothing has changed for any sensor")
    daemon.has_said(f'sensor "tail": {daemon.path("bad.toml")}:6: range[1].high')
    daemon.send("nose", 10)
    daemon.published(20)
    assert daemon.nose().model == "" and daemon.nose().filter_resets == 0, daemon.nose().model
    reload(("nose",), ("tail", "options.rate_hzz = 100\n"))
    daemon.says("reload refused: nothing has changed for any sensor", 2)
    # Now both are good; what a reload cannot change is said.
    daemon.write("bad.toml", MODEL)
    reload(("nose", 'model = "good.toml"\nrange_radps = 5.0\n'), ("belly",), more='log_level = "debug"\n')
    daemon.says(f"nose: reloaded: model {daemon.path('good.toml')}")
    for part in ("nose: changed, needs a restart: range_radps", "changed in [daemon], needs a restart: log_level",
                 'sensor "belly" is new', "tail: no longer in"):
        daemon.has_said(part)
    daemon.send("nose", 10)
    daemon.until_nose(lambda status: len(status.model) == 12, "the model's name")
    daemon.ends_well()


def check_a_flood_of_reloads_is_one_a_second_and_the_status_continues(daemon):
    daemon.configure(DAEMON + daemon.sensor("nose"))
    daemon.start()
    daemon.seconds(1)
    before, statuses = daemon.listener.heard["IFOG_NOSE_STATUS"], lambda: daemon.listener.heard["IFOG_NOSE_STATUS"]

    def flood():
        for _ in range(5):
            daemon.process.send_signal(signal.SIGHUP)
            time.sleep(0.002)
        return statuses() - before >= 3
    daemon.until(flood, "three status messages")
    reloads = daemon.said().count("nose: reloaded")
    assert 1 <= reloads <= statuses() - before + 3, daemon.said()
    daemon.ends_well()


def check_a_fifo_that_falls_silent_has_no_data(daemon):
    daemon.configure(DAEMON + daemon.sensor("nose"))
    daemon.start()
    for state in ("RUNNING", "NO_DATA", "RUNNING"):
        if state == "RUNNING":
            daemon.send("nose", 100)
        daemon.until_nose(lambda status: status.state == getattr(status, f"STATE_{state}"), state)
    daemon.ends_well()


def check_a_slow_sensor_is_not_without_data(daemon):
    """It is judged by its own rate."""
    daemon.configure(DAEMON + daemon.sensor("nose", "nominal_rate_hz = 0.1\n"))
    daemon.start()
    daemon.send("nose", 1)
    daemon.until_nose(lambda status: status.state == status.STATE_RUNNING, "a running sensor")
    daemon.seconds(4)
    assert daemon.nose().state == daemon.nose().STATE_RUNNING
    daemon.has_said("no data", times=0)
    daemon.ends_well()


def check_a_log_that_nobody_reads_or_that_is_closed_ends_nothing(daemon):
    os.mkfifo(daemon.path("said"))  # a pipe without a reader: SIGPIPE at the first line
    reader = os.open(daemon.path("said"), os.O_RDONLY | os.O_NONBLOCK)
    daemon.configure(DAEMON + daemon.sensor("nose"))
    daemon.start()
    daemon.seconds(1)
    os.close(reader)
    daemon.process.send_signal(signal.SIGHUP)  # which has something to say
    daemon.seconds(2)
    assert daemon.end() == 0
    # Closed from the start: what is opened next must not get its number, and the log.
    daemon.configure(DAEMON + daemon.sensor("tail"))
    daemon.start(says_to=None)
    daemon.seconds(1, "IFOG_TAIL_STATUS")
    assert os.readlink(f"/proc/{daemon.process.pid}/fd/2") == "/dev/null"
    assert daemon.end() == 0


def check_channels_from_a_file_and_from_lcm_reach_the_sensor(daemon):
    daemon.write("hwmon", "41250\n")
    daemon.configure(DAEMON + daemon.sensor("nose") + """
[[sensor.channel]]
name = "coil_degC"
source = "file"
path = "hwmon"
scale = 1e-3
period_s = 0.1
[[sensor.channel]]
name = "hull_degC"
source = "lcm"
lcm_channel = "HULL"
[[sensor.channel]]
name = "load_us"
source = "lcm"
lcm_channel = "IFOG_NOSE_STATUS"
field = "input_rate_hz"
""")
    daemon.start()
    daemon.seconds(1)
    from ifog.channel_t import channel_t
    hull = channel_t()
    hull.name, hull.value = "hull_degC", 18.5

    def arrived():
        daemon.send("nose", 5)
        daemon.listener.send(b"HULL", hull.encode())
        values = dict(zip(daemon.nose().channel_name, daemon.nose().channel_value))
        return values["coil_degC"] == 41.25 and values["hull_degC"] == 18.5 and values["load_us"] > 0
    daemon.until(arrived, "the channels")
    daemon.ends_well()


def check_what_is_not_there_is_said_by_the_check(daemon):
    daemon.configure(DAEMON + daemon.sensor("nose") + '[[sensor.channel]]\nname = "coil_degC"\nsource = "file"\npath = "nothing"\n')
    daemon.run("--check", code=0)
    daemon.has_said(f"nose: channel 'coil_degC': {daemon.path('nothing')}: cannot read: No such file or directory, expected a file that holds one number")
    # A FIFO in the model's place is not waited for.
    os.mkfifo(daemon.path("model"))
    daemon.configure(DAEMON + daemon.sensor("nose", 'model = "model"\n'))
    daemon.run("--check", code=2)
    daemon.has_said(f"{daemon.path('model')}: is no regular file")


def check_a_state_folder_that_cannot_be_made_is_said_by_the_check(daemon):
    """The folder need not exist, and is not made."""
    daemon.write("file", "")
    daemon.configure(DAEMON + 'state_folder = "file/state"\n' + daemon.sensor("nose"))
    daemon.run("--check", code=0)
    daemon.has_said(f'daemon.state_folder = "{daemon.path("file/state")}": cannot be made: Not a directory, expected a folder that the daemon may write')
    daemon.configure(DAEMON + 'state_folder = "new/state"\n' + daemon.sensor("nose"))
    daemon.run("--check", code=0)
    daemon.has_said("state_folder", times=0)
    assert not daemon.path("new").exists()


def check_learned_noise_is_kept_over_restarts_with_its_date(daemon):
    """What cannot be read is learned again; if the settings give the noise, nothing is kept."""
    source = random.Random(7)
    daemon.write("frames", b"".join(frames.kvh1750_of(n, [source.gauss(0.01, 1e-3) for _ in "xyz"]) for n in range(20_000)))
    daemon.path("state").mkdir()
    file = "state/nose.noise.toml"

    def run(more=""):
        daemon.configure(DAEMON + 'state_folder = "state"\n[[sensor]]\nname = "nose"\ndriver = "kvh1750"\nnominal_rate_hz = 1000\n'
                         '[sensor.transport]\ntype = "file"\npath = "frames"\n' + more)
        daemon.run(code=0)

    def samples():
        return float(re.search(r"^samples = (\S+)", daemon.read(file), re.M)[1])
    run()
    daemon.has_said("noise learned at rest")
    daemon.has_said("noise as learned until", times=0)
    first = samples()
    assert first >= 4096 and 'learned = "20' in daemon.read(file), daemon.read(file)
    run()
    daemon.has_said("noise from start-up data", times=0)
    daemon.has_said("noise as learned until 20")
    assert samples() > first, "learned on"
    before = daemon.read(file)
    run(FILTER)
    assert daemon.read(file) == before, "what is given is not learned over"
    daemon.write(file, before[:len(before) // 2])
    run()
    daemon.has_said("learned again")
    assert samples() == first, daemon.read(file)
    # A folder that does not exist is made; if it cannot be made, that is said once.
    shutil.rmtree(daemon.path("state"))
    run()
    assert samples() >= 4096 and stat.S_IMODE(daemon.path("state").stat().st_mode) == 0o2775
    shutil.rmtree(daemon.path("state"))
    daemon.write("state", "")
    run()
    daemon.has_said(f'daemon.state_folder = "{daemon.path("state")}": cannot be made')
    daemon.has_said("learned noise is not kept")


def check_one_fifo_is_one_daemons(daemon):
    daemon.configure(DAEMON + daemon.sensor("nose"))
    daemon.configure(DAEMON + daemon.sensor("nose") + daemon.sensor("tail"), "other.toml")
    daemon.start()
    daemon.send("nose", 100)
    daemon.published(100)
    said = run_second(daemon, "other.toml", 1)
    assert said == (f"ifogd: {daemon.path('nose')}: another process reads it: Device or resource busy, expected a device or FIFO of this "
                    "daemon's own\n"), said
    daemon.send("nose", 100)
    daemon.published(200)
    daemon.ends_well()
    # After the first one's end, however that comes, the FIFO is free.
    daemon.write("said", "")
    daemon.start()
    daemon.says("nose: reading")
    daemon.end(signal.SIGKILL)
    daemon.start()
    daemon.send("nose", 100)
    daemon.published(100)
    daemon.ends_well()


def check_one_state_folder_is_one_daemons(daemon):
    head = DAEMON + 'state_folder = "state"\n'
    daemon.configure(head + daemon.sensor("nose"))
    daemon.configure(head + daemon.sensor("tail"), "other.toml")
    daemon.start()
    daemon.seconds(1)
    said = run_second(daemon, "other.toml", 1)
    assert said == (f"ifogd: {daemon.path('state/ifogd.lock')}: another daemon, process {daemon.process.pid}, works with this state folder; "
                    "expected one of its own for each\n"), said
    assert daemon.listener.heard["IFOG_TAIL_STATUS"] == 0
    daemon.ends_well()


def check_who_publishes_on_a_taken_channel_says_so(daemon):
    """A capture may be read by many."""
    daemon.configure(DAEMON + daemon.sensor("nose"))
    daemon.start()
    daemon.seconds(1)
    daemon.has_said("another daemon publishes", times=0)
    daemon.write("capture.csv", "time_s,rate_radps\n0,0.1\n0.01,0.1\n0.02,0.1\n")
    for name in ("nose", "tail"):
        daemon.configure(f'{DAEMON}[[sensor]]\nname = "{name}"\ndriver = "capture"\n[sensor.options]\nrate_hz = 100\n'
                         '[sensor.transport]\ntype = "file"\npath = "capture.csv"\n', "other.toml")
        said = run_second(daemon, "other.toml")
        assert ("another daemon publishes on IFOG_NOSE of this lcm_url" in said) == (name == "nose"), said
    daemon.ends_well()


def check_a_folder_of_recordings_is_one_recorders(daemon):
    daemon.configure(DAEMON + daemon.sensor("nose") + '[sensor.record]\nfolder = "rec"\n')
    folder = daemon.path("rec/nose")
    daemon.start()
    daemon.send("nose", 100)
    daemon.until_nose(lambda status: status.record_file_bytes > 0, "a recording")
    second = subprocess.run([IFOG, "record", "--seconds", "1", "--output", folder], capture_output=True, text=True, timeout=60, check=False)
    assert second.returncode == 1 and second.stdout + second.stderr == f"ifog: {folder}: {BUSY}\n", second
    daemon.ends_well()
    assert len(os.listdir(folder)) == 1
    # If the daemon finds it taken, it continues without it and says so.
    taken = os.open(folder, os.O_RDONLY | os.O_DIRECTORY)
    fcntl.flock(taken, fcntl.LOCK_EX | fcntl.LOCK_NB)
    daemon.start()
    daemon.send("nose", 100)
    daemon.published(100)
    daemon.says(f"recorder: {folder}: {BUSY}")
    os.close(taken)
    daemon.says("all is recorded again, nothing is lost")
    daemon.ends_well()


if __name__ == "__main__":
    process.main_of(globals())

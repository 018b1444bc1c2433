#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon as a user starts it: what it says and how it ends if something is wrong.

usage: words.py BUILD [PART OF A CHECK'S NAME...]
"""
import contextlib
import os
import signal
import socket
import subprocess
import time

import process
from process import IFOGD, SOURCE, frames

FILE = '[sensor.transport]\ntype = "file"\npath = "flight.kvh"\n'
NO_GYRO = '[sensor.transport]\ntype = "serial"\ndevice = "/dev/no-gyro"\nbaud = 921600\n'


def configure(daemon, more, driver="kvh1750"):
    daemon.configure(f'{process.DAEMON}[[sensor]]\nname = "nose"\ndriver = "{driver}"\n{more}')


def record(daemon, count, cut_off=0):
    recorded = b"".join(frames.kvh1750_of(n, (0.01, 0.01, 0.01)) for n in range(count))
    daemon.write("flight.kvh", recorded[:len(recorded) - cut_off])


def check_what_is_wrong_in_the_parts_is_said_with_the_line_of_its_key(daemon):
    """The same with --check."""
    daemon.write("model.toml", 'version = 1\nsensor = "nose"\n\n[[effect]]\nform = "linear"\nchannel = "supply_V"\n'
                 '  [[effect.parameter]]\n  name = "coefficient"\n  value = 1e-6\n')
    daemon.write("bad.toml", "version = 7\n")
    daemon.write("bus.dbc", 'BU_: G\nBO_ 1 Rate: 8 G\n SG_ Rate_z : 0|16@1- (0.01,0) [-300|300] "deg/s" G\n')
    channel = FILE + '[[sensor.channel]]\nname = "coil_degC"\n'
    sensor = ': sensor "nose": '
    for more, what in (
            (FILE + '[sensor.options]\nformat = "q"\n', f":10{sensor}driver kvh1750: format is 'q', expected "),
            (FILE + '[sensor.options]\nformat = "a"\nfromat = "a"\n', f":11{sensor}driver kvh1750: unknown option 'fromat'"),
            ('model = "bad.toml"\n' + FILE, f":6{sensor}{daemon.path('bad.toml')}:1: version = 7"),
            ('model = "model.toml"\n' + FILE, f":6{sensor}{daemon.path('model.toml')}:4: the model uses channel \"supply_V\", which"),
            (FILE + '[sensor.filter]\nstate = "foo"\n', ":10: sensor.filter.state = 'foo': expected "),
            ('[sensor.transport]\ntype = "can"\ninterface = "can0"\n', f':7{sensor}driver "kvh1750" cannot be fed from a transport of type "can"'),
            (channel + 'source = "can"\ninterface = "can0"\ndbc = "bus.dbc"\nsignal = "Coil"\n',
             f":14{sensor}{daemon.path('bus.dbc')}: no signal \"Coil\""),
            (channel + 'source = "lcm"\nlcm_channel = "HULL"\nfield = "raw[3]"\n', ":13: sensor.channel.field = 'raw[3]': expected ")):
        configure(daemon, more)
        for how in ([], ["--check"]):
            daemon.run(*how, code=2)
            daemon.has_said(str(daemon.path("ifogd.toml")) + what)


def check_a_model_of_a_sensor_with_one_axis_is_said_by_the_check(daemon):
    """Every sensor here has three."""
    daemon.write("model.toml", 'version = 1\n[[noise]]\naxis = "q"\nN = 1e-6\n[[effect]]\nform = "linear"\nchannel = "temperature_degC"\n'
                 '[[effect.parameter]]\nname = "coefficient"\nvalue = 1e-6\n')
    configure(daemon, 'model = "model.toml"\n' + FILE)
    daemon.run("--check", code=0)
    daemon.has_said("subtracted from each of x, y, z")
    daemon.has_said("the noise of an axis 'q'")


def check_an_option_that_is_nearly_right_is_said(daemon):
    configure(daemon, FILE)
    daemon.run("--chekc", code=2)
    daemon.has_said("ifogd: unknown option '--chekc', did you mean '--check'?")


def check_what_cannot_be_said_has_failed(daemon):
    configure(daemon, FILE)
    for how in (["--config", daemon.path("ifogd.toml"), "--check"], ["--help"], ["--version"]):
        for to, code in (("/dev/null", 0), ("/dev/full", 1)):
            with open(to, "w") as out:
                status = subprocess.run([IFOGD, *how], stdout=out, stderr=subprocess.DEVNULL, check=False).returncode
            assert status == code, f"{how} > {to}: exit {status}"


def check_a_check_opens_nothing(daemon):
    configure(daemon, FILE + '[sensor.record]\nfolder = "tape"\n[[sensor.channel]]\nname = "hull_degC"\nsource = "lcm"\nlcm_channel = "HULL"\n')
    # LCM would try to connect.
    daemon.write("ifogd.toml", daemon.read("ifogd.toml").replace("lock_memory", 'lcm_url = "tcpq://127.0.0.1:1"\nlock_memory'))
    daemon.run("--check", code=0)
    assert not daemon.path("tape").exists()
    assert daemon.said() == f"{daemon.path('ifogd.toml')}: good, 1 sensor(s)\n", daemon.said()
    daemon.run(code=1)
    assert "LCM tcpq" in daemon.said(), daemon.said()


def check_a_file_without_a_frame_has_failed(daemon):
    configure(daemon, FILE)
    daemon.write("flight.kvh", "x" * 50_000)
    daemon.run(code=1)
    daemon.has_said(f"nose: failed: {daemon.path('flight.kvh')}: ended, and no frame of the sensor was in its 50000 bytes")
    daemon.write("flight.kvh", "")
    daemon.run(code=1)


def check_a_sensor_that_is_not_open_is_not_said_to_be_read(daemon):
    """With two that cannot be opened, one would not run alone; here the other does."""
    configure(daemon, FILE + '[[sensor]]\nname = "tail"\ndriver = "kvh1750"\n' + NO_GYRO)
    record(daemon, 30)
    daemon.run(code=0, stopped_after_s=3)
    daemon.has_said("nose: reading ")
    daemon.has_said("tail: reading ", times=0)
    daemon.has_said("tail: trying again to open /dev/no-gyro at ")


def check_without_its_only_device_it_is_ready_and_waits(daemon):
    """A gyro may be powered later than its computer."""
    configure(daemon, NO_GYRO)
    with socket.socket(socket.AF_UNIX, socket.SOCK_DGRAM) as manager:
        manager.bind(str(daemon.path("notify")))
        manager.settimeout(1)
        daemon.run(code=0, stopped_after_s=3, NOTIFY_SOCKET=str(daemon.path("notify")))
        assert manager.recv(256).startswith(b"READY=1")
    daemon.has_said("nose: /dev/no-gyro: cannot open: No such file or directory, expected a serial device")
    daemon.has_said("nose: trying again to open /dev/no-gyro at ")
    daemon.has_said("stopping on SIGTERM")


def check_a_file_cut_off_within_a_frame_is_one_line_and_counted(daemon):
    configure(daemon, FILE)
    record(daemon, 300, cut_off=10)
    daemon.run(code=1)
    daemon.has_said(f"nose: failed: {daemon.path('flight.kvh')}: ends within a frame, its last 26 bytes are no whole one (is the file cut off?)")
    daemon.has_said("bytes_skipped +26")
    daemon.has_said("299 samples read, 299 published")


def configure_log(daemon, dbc, options, lines, more=""):
    """A log of a bus, whose frames the driver dbc reads."""
    configure(daemon, f'[sensor.options]\ndbc = "{dbc}"\n{options}rate_hz = 100\n[sensor.transport]\ntype = "file"\npath = "gyro.log"\n'
              f'format = "candump"\n{more}', "dbc")
    daemon.write("gyro.log", "".join(lines))


def check_a_fault_in_a_log_is_said_with_its_place(daemon):
    """All else is read."""
    lines = [f"(1700000000.{4000 * n:06}) can0 100#0000003F00000000\n" for n in range(250)]
    for n in range(249, 200, -1):
        lines.insert(n, "worse\n")
    lines.insert(20, "rubbish\n")
    configure_log(daemon, SOURCE / "drivers/dbc/examples/ifogd_gyro.dbc", 'signal = "Rate_x"\n', lines, 'pace = "recorded"\n')
    daemon.run(code=1)
    for part in (f"{daemon.path('gyro.log')}:21: ", ", found 'rubbish'", "log_faults +"):
        assert part in daemon.said(), f"{part}: {daemon.said()}"
    daemon.has_said("worse", times=0)
    daemon.has_said("250 samples read, 250 published")


def check_what_comes_twice_or_unfinished_is_counted(daemon):
    """A sample of three frames: one frame twice, a whole sample twice, the last sample unfinished; and a slip in the DBC file."""
    bus = "".join(f'BO_ {256 + axis} M{axis}: 8 X\n SG_ R{axis} : 0|32@1- (1e-6,0) [0|0] "rad/s" X\n SG_ Count : 32|16@1+ (1,0) [0|0] "" X\n'
                  for axis in range(3))
    daemon.write("bus.dbc", bus + ' SG_ Slip : 48|8@3+ (1,0) [0|0] "" X\n')
    lines = [f"(1700000000.{4000 * n + 100 * axis:06}) can0 {256 + axis:03X}#{n % 251:02X}{axis:02X}0000{n:02X}000000\n"
             for n in range(200) for axis in range(3)]
    lines[3 * 120:3 * 120] = lines[3 * 119:3 * 120]
    lines.insert(3 * 60 + 2, lines[3 * 60 + 1])
    configure_log(daemon, daemon.path("bus.dbc"), 'x = "R0"\ny = "R1"\nz = "R2"\ncounter = "Count"\n', lines[:-1])
    daemon.run(code=0)
    for part in ("frames_repeated +1", "samples_repeated +1", "samples_incomplete +1", "199 samples read, 199 published",
                 "bus.dbc:10: '3+ (1,0) [0|0] \"\" X', expected one of 01"):
        daemon.has_said(part)


def check_a_driver_that_throws_ends_its_sensor_alone(daemon):
    record(daemon, 300)
    configure(daemon, FILE + '[[sensor]]\nname = "tail"\ndriver = "throwing"\nnominal_rate_hz = 100\n' + FILE)
    daemon.run(code=1, IFOG_PLUGIN_PATH=str(process.BUILD / "tests/unit/drivers/refused/plugins"))
    daemon.has_said(f"warning: tail: failed: {daemon.path('flight.kvh')}: the driver has thrown an exception and is not called any more, "
                    "found 'throwing: boom'")
    daemon.has_said("nose: 300 samples read, 300 published")


def blocked_signals(pid):
    """As the kernel has them: bit n - 1 is signal n."""
    with open(f"/proc/{pid}/status") as file:
        return next(int(line.split()[1], 16) for line in file if line.startswith("SigBlk:"))


def check_a_reload_waits_from_the_first_moment(_):
    """Blocked at the first thing that it does, writing its version into a full pipe, a reload that is too early cannot kill it.
    SIGTERM and Ctrl-C end it at once."""
    ends = os.pipe()
    os.set_blocking(ends[1], False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(ends[1], b"x")
    os.set_blocking(ends[1], True)
    with process.running(IFOGD, "--version", stdout=ends[1]) as version:
        end, expected = time.monotonic() + 10, 1 << (signal.SIGHUP - 1)
        while (blocked := blocked_signals(version.pid)) != expected and time.monotonic() < end:
            time.sleep(0.01)
    assert blocked == expected, f"blocked: {blocked:x}"
    for each in ends:
        os.close(each)


if __name__ == "__main__":
    process.main_of(globals())

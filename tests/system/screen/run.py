#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`ifog monitor` on a terminal: pyte, an independent terminal emulator, shows the screen while the real daemon plays a recording of
three axes in a network namespace.

usage: run.py BINARY_DIR exit 77, with the reason, if something required is missing
"""
import fcntl
import json
import math
import os
import pty
import select
import shutil
import signal
import struct
import subprocess
import sys
import tempfile
import termios
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "../command_line"))
import schema  # pylint: disable=wrong-import-position


def skip(why):
    print(f"SKIPPED: {why}")
    sys.exit(77)


def enter_namespace():
    if os.environ.get("IFOG_SCREEN_INSIDE") != "1":
        flags = "-n" if os.geteuid() == 0 else "-rn"
        if not shutil.which("unshare") or subprocess.run(["unshare", flags, "true"], capture_output=True).returncode != 0:
            skip(f"no network namespace of one's own (unshare {flags}): LCM stays off the real network")
        os.environ["IFOG_SCREEN_INSIDE"] = "1"
        os.execvp("unshare", ["unshare", flags, sys.executable, *sys.argv])
    for command in ("ip link set lo up multicast on", "ip route add 224.0.0.0/4 dev lo"):
        if subprocess.run(command.split(), capture_output=True).returncode != 0:
            skip(f"cannot {command}")


class Terminal:
    """A program on a pseudo-terminal, and its screen."""

    def __init__(self, arguments, columns=80, rows=24):
        self.screen = pyte.Screen(columns, rows)
        self.stream = pyte.ByteStream(self.screen)
        self.pid, self.fd = pty.fork()
        if self.pid == 0:
            os.environ.update(TERM="linux", LC_ALL="C.UTF-8", COLUMNS="", LINES="")
            for name in ("COLUMNS", "LINES"):
                del os.environ[name]
            fcntl.ioctl(0, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))
            os.execv(arguments[0], arguments)

    def resize(self, columns, rows):
        self.screen.resize(rows, columns)
        fcntl.ioctl(self.fd, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def press(self, keys):
        os.write(self.fd, keys.encode())

    def read(self, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            if not select.select([self.fd], [], [], 0.05)[0]:
                continue
            try:
                self.stream.feed(os.read(self.fd, 65536))
            except OSError:  # the program has ended
                return

    def text(self):
        return "\n".join(line.rstrip() for line in self.screen.display)

    def colours(self):
        return {cell.fg for row in self.screen.buffer.values() for cell in row.values()} - {"default"}

    def wait_for(self, judge, what, seconds=20):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            self.read(0.1)
            if judge(self.text()):
                print(f"ok: {what}")
                return
        raise SystemExit(f"FAILED: {what}; on the screen:\n{self.text()}")

    def exit_code(self):
        end = time.monotonic() + 20
        while time.monotonic() < end:
            self.read(0.1)
            time.sleep(0.02)  # the terminal closes a moment before the program ends
            pid, status = os.waitpid(self.pid, os.WNOHANG)
            if pid:
                return os.waitstatus_to_exitcode(status)
        raise SystemExit(f"FAILED: does not end; on the screen:\n{self.text()}")


def capture(path, seconds, rate_hz):
    with open(path, "w", encoding="utf-8") as out:
        out.write("time_s,rate_x_radps,rate_y_radps,rate_z_radps,temperature_degC\n")
        for i in range(seconds * rate_hz):
            t = i / rate_hz
            out.write(f"{t:.3f},{1e-5 + 1e-7 * math.sin(7919.0 * i):.9e},{0.01 * math.sin(t):.9e},{-0.02 + 1e-6 * math.cos(104729.0 * i):.9e},25\n")


def configure(work, binaries):
    capture(f"{work}/three.csv", 60, 100)
    with open(f"{work}/ifogd.toml", "w", encoding="utf-8") as out:
        out.write(f"""[daemon]
lock_memory = false
plugin_folder = "{binaries}/plugins"
[[sensor]]
name = "nose"
driver = "capture"
nominal_rate_hz = 100
[sensor.transport]
type = "file"
path = "{work}/three.csv"
bytes_per_second = 5500
pace = "recorded"
[sensor.options]
columns = "rate_x_radps,rate_y_radps,rate_z_radps,temperature_degC"
[sensor.filter]
process_noise = 1e-10
measurement_noise = 1e-12
""")


def axes(s):
    rows = s.splitlines()
    return all(any(row.startswith(f"  {axis}  ") and "noise" in row and "angle" in row for row in rows) for axis in "xyz")


def see_figures_and_keys(seen):
    seen.wait_for(lambda s: axes(s) and "NOSE  running" in s and "waiting for" not in s, "three axes by name at 80 columns")
    seen.wait_for(lambda s: "°/h" in s and "°/s" in s, "each rate in the unit that suits it")
    seen.wait_for(lambda s: "nothing lost" in s and "books:" in s and "latency p50" in s, "nothing lost, and the books that say so")
    seen.wait_for(lambda s: any(c in s for c in "▁▂▃▄▅▆▇█"), "a spark line")
    seen.wait_for(lambda s: seen.colours() >= {"green"}, "running is green")
    seen.press("d")
    seen.wait_for(lambda s: axes(s) and "books:" not in s, "d: without details")
    seen.press("u")
    seen.wait_for(lambda s: axes(s) and "°/s" not in s, "u: all in °/h")
    seen.press("uu")
    seen.wait_for(lambda s: axes(s) and s.count("rad/s") == 3, "u, u: all in rad/s")
    seen.press("?")
    seen.wait_for(lambda s: "scroll, page up and down" in s and not axes(s), "?: the keys")
    seen.press("x")
    seen.wait_for(axes, "any key: back")
    seen.press(" ")
    seen.wait_for(lambda s: "PAUSED" in s, "space: paused")
    seen.read(1.0)
    before = seen.text()
    seen.read(1.5)
    if seen.text() != before:
        raise SystemExit("FAILED: figures move while it is paused")
    seen.press(" d")
    seen.wait_for(lambda s: "PAUSED" not in s and "books:" in s, "space: on again")


def see_sizes(seen):
    for columns, rows in ((132, 40), (60, 12), (80, 24)):
        seen.resize(columns, rows)
        seen.wait_for(lambda s: axes(s) and "q quit" in s.splitlines()[-1][:columns], f"resized to {columns} x {rows}")
        widest = max(len(line) for line in seen.text().splitlines())
        if widest > columns:
            raise SystemExit(f"FAILED: a line of {widest} at {columns} columns")


def see_no_colour(ifog):
    """no-color.org: lines at a terminal, and the screen."""
    for more, wanted in (([], set()), (["--plain"], set()), (["--plain"], {"green"})):
        os.environ["NO_COLOR"] = "" if wanted else "1"
        seen = Terminal([ifog, "monitor", *more])
        seen.wait_for(lambda s: axes(s) and "running" in s, f"{' '.join(more) or 'a screen'}, NO_COLOR={os.environ['NO_COLOR']}")
        if seen.colours() & {"green", "red", "brown"} != wanted:
            raise SystemExit(f"FAILED: colours {seen.colours()}, expected {wanted or 'none'}")
        os.kill(seen.pid, signal.SIGTERM)
        seen.exit_code()


def see_lines(ifog):
    """For programs: JSON, and lines in a pipe."""
    told = subprocess.run([ifog, "monitor", "--seconds", "2.5", "--json", "-"], capture_output=True, text=True, check=True).stdout
    messages = [json.loads(line) for line in told.splitlines()]
    for message in messages:
        schema.check(message)
    rates = [m for m in messages if m["type"] == "rate"]
    if len(rates) < 50 or any(len(m["raw"]) != 3 or m["sensor"] != "NOSE" for m in rates) or \
            not any(m["type"] == "status" and m["state_name"] == "running" for m in messages):
        raise SystemExit(f"FAILED: --json gave {len(rates)} rates: {told[:400]}")
    print(f"ok: --json, {len(rates)} rates and {len(messages) - len(rates)} status messages, a line each")
    piped = subprocess.run([ifog, "monitor", "--seconds", "2.2"], capture_output=True, text=True, check=True).stdout
    if "\x1b" in piped or not axes(piped):
        raise SystemExit(f"FAILED: to a pipe it says {piped!r}")
    print("ok: to a pipe lines without a control sequence")


def see_the_end(seen, daemon):
    daemon.send_signal(signal.SIGTERM)
    daemon.wait(20)
    seen.wait_for(lambda s: "nothing heard" in s and "no samples in the last second" in s, "a daemon that went: said")
    seen.press("q")
    if (code := seen.exit_code()) != 0:
        raise SystemExit(f"FAILED: exit {code}")
    if "NOSE" not in seen.text() or "q quit" in seen.text():
        raise SystemExit(f"FAILED: left on the terminal is\n{seen.text()}")
    print("ok: q: exit 0, and what was seen last stays")


def main():
    binaries = os.path.realpath(sys.argv[1])
    ifog, ifogd = f"{binaries}/tools/ifog/ifog", f"{binaries}/daemon/ifogd"
    with tempfile.TemporaryDirectory() as work:
        configure(work, binaries)
        seen = Terminal([ifog, "monitor", "--sensor", "nose"])
        seen.wait_for(lambda s: "waiting for 'nose'" in s and "0 s: nothing heard" in s, "in the first second, too, it says that it waits")
        seen.wait_for(lambda s: "waiting for 'nose'" in s and "Is ifogd running" in s and "q quit" in s, "what is waited for stands there, and what to look at")
        with open(f"{work}/log", "w", encoding="utf-8") as log:
            daemon = subprocess.Popen([ifogd, "--config", f"{work}/ifogd.toml"], stdout=log, stderr=log)
        try:
            see_figures_and_keys(seen)
            see_sizes(seen)
            see_lines(ifog)
            see_no_colour(ifog)
            see_the_end(seen, daemon)
        finally:
            if daemon.poll() is None:
                daemon.kill()
            print(open(f"{work}/log", encoding="utf-8").read()[-600:])


try:
    import pyte
except ImportError:
    skip("no terminal emulator: install python3-pyte (tools/install-packages test)")
enter_namespace()
main()

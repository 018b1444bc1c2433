# SPDX-License-Identifier: Apache-2.0
"""The real ifogd in a folder and a network of its own: its configuration, what it says and publishes, sensors that are FIFOs.

A script's functions check_SOMETHING(daemon) each have such a folder; see main_of(). Its arguments are the build folder and, to run
only some of them, parts of their names.
"""
import collections
import os
import pathlib
import select
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = pathlib.Path(__file__).resolve().parent
BUILD, SOURCE = pathlib.Path(sys.argv[1]).resolve(), HERE.parents[2]
sys.path[:0] = [str(HERE.parent), str(HERE.parent / "box"), str(BUILD / "msgs/python")]
import frames  # noqa: E402
from each_check import running  # noqa: E402, F401
import private_network  # noqa: E402

IFOG, IFOGD = BUILD / "tools/ifog/ifog", BUILD / "daemon/ifogd"
DAEMON = "[daemon]\nlock_memory = false\n"
FILTER = "[sensor.filter]\nprocess_noise = 1e-10\nmeasurement_noise = 1e-8\n"
GENEROUS_S = 60  # only a check that fails waits so long


class Listener:
    """The latest status of each sensor by its channel, how many came, and every sample of the sensor nose."""

    def __init__(self):
        from ifog.rate_t import rate_t
        from ifog.status_t import status_t
        self.rate_t, self.status_t = rate_t, status_t
        self.rates, self.last, self.heard = [], {}, collections.Counter()
        self.socket = private_network.group_socket()

    def listen(self, seconds):
        while select.select([self.socket], [], [], seconds)[0]:
            seconds = 0
            packet = self.socket.recv(65536)
            assert packet[:4] == b"LC02", packet[:4]
            channel, message = packet[8:].split(b"\0", 1)
            if channel.endswith(b"_STATUS"):
                self.last[channel.decode()] = self.status_t.decode(message)
                self.heard[channel.decode()] += 1
            elif channel == b"IFOG_NOSE":
                self.rates.append(self.rate_t.decode(message))

    def send(self, channel, message):
        self.socket.sendto(b"LC02" + bytes(4) + channel + b"\0" + message, (private_network.GROUP, private_network.PORT))


class Daemon:
    """What it says is in the file `said`."""

    def __init__(self):
        self.folder, self.process, self.listener = pathlib.Path(tempfile.mkdtemp()), None, None
        self.fifos, self.sent = {}, collections.Counter()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.end(signal.SIGKILL)
        for fifo in self.fifos.values():
            os.close(fifo)
        if self.listener:
            self.listener.socket.close()
        shutil.rmtree(self.folder, ignore_errors=True)

    def path(self, name):
        return self.folder / name

    def write(self, name, text):
        self.path(name).write_bytes(text if isinstance(text, bytes) else text.encode())

    def read(self, name):
        return self.path(name).read_text()

    def configure(self, text, name="ifogd.toml"):
        self.write(name, text)

    def said(self, name="said"):
        return self.read(name) if self.path(name).is_file() else ""  # not a FIFO

    def has_said(self, text, times=1):
        assert self.said().count(text) == times, f"{self.said().count(text)} times, expected {times}: '{text}' in\n{self.said()}"

    def run(self, *arguments, code, config="ifogd.toml", to="said", stopped_after_s=None, **environment):
        """Runs to its end, or is stopped, and writes `said` anew."""
        with open(self.path(to), "w") as said, subprocess.Popen([IFOGD, "--config", self.path(config), *arguments], stdout=said, stderr=said,
                                                                env=os.environ | environment) as process:
            try:
                status = process.wait(stopped_after_s or GENEROUS_S)
            except subprocess.TimeoutExpired:
                process.send_signal(signal.SIGTERM if stopped_after_s else signal.SIGKILL)
                status = process.wait()
        assert status == code, f"exit {status}, expected {code}: {self.said(to)}"

    def start(self, says_to="said"):
        """Runs in the background; with None it has no standard error."""
        with open(self.path(says_to or "nothing"), "ab", buffering=0) as said:
            self.process = subprocess.Popen([IFOGD, "--config", self.path("ifogd.toml")], stdout=subprocess.DEVNULL, stderr=said,
                                            preexec_fn=None if says_to else lambda: os.close(2))

    def end(self, number=signal.SIGTERM):
        """Ends the one in the background; returns its exit status, negative that of the signal that ended it."""
        process, self.process = self.process, None
        if process is None:
            return None
        process.send_signal(number)
        return process.wait(GENEROUS_S)

    def ends_well(self):
        assert self.end() == 0, self.said()

    def listen(self, seconds=0.05):
        if not self.listener:
            self.listener = Listener()
        self.listener.listen(seconds)

    def until(self, condition, what):
        end = time.monotonic() + GENEROUS_S
        while not condition():
            assert time.monotonic() < end, f"waited {GENEROUS_S} s for {what}: {self.said()}"
            self.listen()

    def nose(self):
        """Its last status."""
        return self.listener.last.get("IFOG_NOSE_STATUS") if self.listener else None

    def until_nose(self, condition, what):
        self.until(lambda: self.nose() and condition(self.nose()), what)

    def published(self, samples):
        self.until_nose(lambda status: status.samples_published == samples, f"{samples} samples")

    def seconds(self, count, channel="IFOG_NOSE_STATUS"):
        """So many status messages more."""
        self.listen(0)
        before = self.listener.heard[channel]
        self.until(lambda: self.listener.heard[channel] >= before + count, f"{count} status messages")

    def says(self, text, times=1):
        self.until(lambda: self.said().count(text) == times, f"{times} times '{text}'")

    def fifo(self, name):
        """The writing end of the FIFO of that name."""
        if name not in self.fifos:
            os.mkfifo(self.path(name))
            self.fifos[name] = os.open(self.path(name), os.O_RDWR)
        return self.fifos[name]

    def sensor(self, name, more=""):
        """A sensor that reads a FIFO, whose writing end is here."""
        self.fifo(name)
        return f'[[sensor]]\nname = "{name}"\ndriver = "kvh1750"\n{more}[sensor.transport]\ntype = "file"\npath = "{name}"\n{FILTER}'

    def send(self, name, count, rates=lambda sample: (0.01, 0.01, 0.01), temperature_degC=lambda sample: 25):
        """The next frames of a sensor; returns them."""
        first = self.sent[name]
        self.sent[name] += count
        packed = b"".join(frames.kvh1750_of(n, rates(n), temperature_degC(n)) for n in range(first, first + count))
        assert os.write(self.fifos[name], packed) == len(packed)
        return packed


def main_of(script):
    """Runs the checks of the script in a network of its own; one line each, `ok` or `FAILED` with the reason."""
    private_network.enter()
    failed = 0
    for name, check in list(script.items()):
        if not name.startswith("check_") or not any(part in name for part in sys.argv[2:] or [""]):
            continue
        with Daemon() as daemon:
            try:
                check(daemon)
                print(f"ok       {name[6:].replace('_', ' ')}", flush=True)
            except (AssertionError, OSError, LookupError, subprocess.TimeoutExpired) as error:
                failed += 1
                print(f"FAILED   {name[6:].replace('_', ' ')}: {error}", flush=True)
    sys.exit(failed > 0)

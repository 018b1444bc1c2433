# SPDX-License-Identifier: Apache-2.0
"""A daemon with one gyro in its own folder, and obstacles of an unprivileged user."""
import hashlib
import json
import os
import shutil
import signal
import subprocess
import sys
import tempfile
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import private_network  # noqa: E402

NOBODY = 65534
PYTHON = shutil.which("python3", path="/usr/bin:/bin") or "python3"  # executable by anybody
URL = "udpm://239.255.76.67:7667?ttl=0"
SECRET = "swordfish-4711"
# In the programs' format: its hash is its name.
MODEL = """version = 1
sensor = "nose"

[[effect]]
form = "linear"
channel = "temperature_degC"
reference = 25

[[effect.parameter]]
name = "coefficient"
value = %s
std_error = 0
unit = "rad/s/degC"

[source]
"""
CONFIG = """[daemon]
lock_memory = false
state_folder = "state"
lcm_url = "%s"
[[sensor]]
name = "nose"
driver = "dsp3000"
[sensor.transport]
type = "file"
path = "gyro"
[sensor.filter]
process_noise = 1e-12
measurement_noise = 1e-10
[[sensor.channel]]
name = "temperature_degC"
source = "file"
path = "temperature"
""" % URL


def as_nobody(*words):
    """Actions of a user without groups."""
    return subprocess.run(words, user=NOBODY, group=NOBODY, extra_groups=[], capture_output=True, text=True, check=False)


class Place:
    def __init__(self, build, work):
        self.build, self.work, self.failed, self.daemon, self.feeding = os.path.abspath(build), work, 0, None, False
        self.ifog, self.ifogd = os.path.join(self.build, "tools/ifog/ifog"), os.path.join(self.build, "daemon/ifogd")
        os.environ["IFOG_PLUGIN_PATH"] = os.path.join(self.build, "plugins")
        os.environ["HOME"] = work
        os.chdir(work)
        os.chmod(work, 0o755)
        os.mkdir("state")
        if os.geteuid() == 0:
            # As in the service: the folder belongs to the daemon's user.
            os.chown("state", NOBODY, NOBODY)
        os.chmod("state", 0o2775)
        with open("temperature", "w") as file:
            file.write("26.0\n")
        with open("ifogd.toml", "w") as file:
            file.write(CONFIG)
        with open("secret", "w") as file:
            file.write(f'password = "{SECRET}"\n')
        os.chmod("secret", 0o600)
        os.mkfifo("gyro")

    def check(self, good, what):
        self.failed += not good
        print(("ok       " if good else "FAILED   ") + what, flush=True)

    def ran(self, *words, code=None, seconds=60, **more):
        done = subprocess.run([self.ifog, *words], stdin=subprocess.DEVNULL, capture_output=True, text=True, timeout=seconds, check=False, **more)
        said = (done.stdout + done.stderr).strip()
        if code is not None and done.returncode != code:
            self.check(False, f"ifog {' '.join(words)}: exit {done.returncode}, expected {code}: {said}")
        return said

    def of(self, *words, **more):
        return self.ran(*words, "--config", "ifogd.toml", **more)

    def status(self):
        self.of("status", "--json", "status.json")
        with open("status.json") as file:
            return json.load(file)

    def model(self, value):
        text = MODEL % value
        return text, {"identity": hashlib.sha256(text.encode()).hexdigest()[:12], "sha256": hashlib.sha256(text.encode()).hexdigest()}

    def propose(self, value, against=None):
        """A proposal of a night; returns its model's name."""
        text, name = self.model(value)
        with open(f"state/nose.proposal-{name['identity']}.toml", "w") as file:
            file.write(text)
        index = {"schema": "ifog.proposal/1", "sensor": "nose", "made": "2026-01-01T00:00:00Z", "why": "it pays",
                 "against": against or {"identity": "", "sha256": ""}, "model": name,
                 "model_file": f"nose.proposal-{name['identity']}.toml", "report_file": f"nose.proposal-{name['identity']}.html", "gain": []}
        with open("state/nose.proposal.json", "w") as file:
            json.dump(index, file)
        return name

    def start(self, config="ifogd.toml", log="log"):
        daemon = subprocess.Popen([self.ifogd, "--config", config], stdin=subprocess.DEVNULL, stderr=open(log, "w"))
        self.await_(lambda: "reading" in open(log).read() or daemon.poll() is not None, "the daemon to begin")
        return daemon

    def run_daemon(self):
        self.fifo = os.open("gyro", os.O_RDWR)
        self.daemon = self.start()
        self.feed(self.fifo)

    def feed(self, fifo):
        """100 samples per second until the end."""
        self.feeding = True

        def send():
            number = 0
            while self.feeding:
                number += 1
                os.write(fifo, b"%11.6f 1\r\n" % (0.001 * (number % 7)))
                time.sleep(0.01)
        self.feeder = threading.Thread(target=send, daemon=True)
        self.feeder.start()

    def stop_feeding(self):
        self.feeding = False
        self.feeder.join()

    def await_(self, condition, what, seconds=30):
        end = time.monotonic() + seconds
        while not condition():
            if time.monotonic() > end:
                raise SystemExit(f"FAILED   waited {seconds} s for {what}")
            time.sleep(0.1)

    def running(self):
        sensors = self.status()["sensors"]
        return bool(sensors) and sensors[0].get("state") == "running"

    def stop(self):
        if self.daemon is not None:
            self.stop_feeding()
            self.daemon.send_signal(signal.SIGCONT)
            self.daemon.send_signal(signal.SIGTERM)
            self.daemon.wait(30)
        self.daemon = None


def main_of(usage, *parts, root_for="", after=lambda place: None):
    """Runs each part in its own place. root_for: parts that need root."""
    if len(sys.argv) != 2:
        sys.exit(usage)
    build = os.path.abspath(sys.argv[1])
    if root_for and os.geteuid() != 0:
        print(f"skipped  {root_for}: not root here")
        sys.exit(77)
    private_network.enter()
    work = tempfile.mkdtemp()
    place = Place(build, work)
    try:
        for part in parts:
            part(place)
    finally:
        after(place)
        os.chdir("/")
        shutil.rmtree(work, ignore_errors=True)
    sys.exit(place.failed > 0)

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Improvement of a model with faults: two sensors, one with its own model, killed nights, adopting and reverting twice, without a
daemon, on a full or read-only disk, for a sensor that is no longer configured, and with a clock that was set back between two
days.

usage: odd.py BUILD

In its own network namespace. One line per check, `ok` or `FAILED`. Exit 77, with the reason, if something required is missing.
"""
import json
import os
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "command_line"), os.path.join(HERE, "..")]
import flight_file  # noqa: E402
import private_network  # noqa: E402
import schema  # noqa: E402
import slow_gyro  # noqa: E402

HZ, DAY_S = 2, 16384
# Page size of such a disk, and space for the whole state folder.
PAGE, ROOM = 4096, 1 << 20
MODEL = """version = 1
[[effect]]
form = "linear"
channel = "temperature_degC"
reference = 25.0
parameter = [{name = "coefficient", value = 2e-8, std_error = 1e-11, unit = "rad/s/degC"}]
"""
DAEMON = """[daemon]
lock_memory = false
state_folder = "state"
lcm_url = "udpm://239.255.76.67:7667?ttl=0"
"""
SENSOR = """[[sensor]]
name = "{name}"
{model}
driver = "dbc"
[sensor.transport]
type = "file"
path = "{day}.log"
format = "candump"
[sensor.options]
{options}
[sensor.filter]
process_noise = 5e-18
measurement_noise = 1.25e-15
[sensor.record]
folder = "record"
"""


class Odd:
    def __init__(self, build, work):
        self.build, self.work, self.failed = os.path.abspath(build), work, 0
        self.ifog = os.path.join(self.build, "tools/ifog/ifog")
        os.environ["IFOG_PLUGIN_PATH"] = os.path.join(self.build, "plugins")
        os.chdir(work)

    def check(self, good, what):
        self.failed += not good
        print(("ok      " if good else "FAILED  ") + what, flush=True)

    def ran(self, *arguments, code=0, config="two.toml"):
        """The output; one line on failure."""
        done = subprocess.run([self.ifog, *arguments, *(["--config", config] if config else [])], stdin=subprocess.DEVNULL, capture_output=True,
                              text=True, timeout=280, check=False)
        said = (done.stdout + done.stderr).strip()
        if done.returncode != code or (code == 1 and len(done.stderr.strip().splitlines()) != 1):
            self.check(False, f"ifog {' '.join(arguments)}: exit {done.returncode}, expected {code}: {said}")
        return said

    def json(self, *arguments, code=0, config="two.toml"):
        if os.path.exists("out.json"):
            os.remove("out.json")
        said = self.ran(*arguments, "--json", "out.json", code=code, config=config)
        with open("out.json") as file:
            document = json.load(file)
        schema.check(document)
        return said, document

    def make(self):
        os.mkdir("state")
        with open("own.toml", "w") as file:
            file.write(MODEL)
        with open("gyro.toml", "w") as file:
            file.write(slow_gyro.scenario(HZ, DAY_S))
        dbc = os.path.abspath(os.path.join(HERE, "../../../drivers/dbc/examples/ifogd_gyro.dbc"))
        options = {"dbc": dbc, "signal": "Rate_x", "counter": "Counter", "rate_hz": HZ, "environment": "temperature_degC=Temperature"}
        for day in (1, 2):
            self.ran("simulate", "gyro.toml", "--seed", str(70 + day), "--output", f"day{day}.csv", config=None)
            self.ran("convert", f"day{day}.csv", f"day{day}.log", "--driver", "dbc",
                     *[word for key, value in options.items() for word in ("--option", f"{key}={value}")], config=None)
        words = "\n".join(f"{key} = {json.dumps(value)}" for key, value in options.items())
        nose, tail = ({"name": name, "model": model, "options": words} for name, model in (("nose", ""), ("ta-il_2", 'model = "own.toml"')))
        for name, sensors in (("two", ((nose, 1), (tail, 2))), ("second", ((nose, 2), (tail, 1))), ("tail", ((tail, 2),))):
            with open(name + ".toml", "w") as file:
                file.write(DAEMON + "".join(SENSOR.format(**sensor, day=f"day{day}") for sensor, day in sensors))

    def day(self, config):
        """The daemon processes a day at full speed."""
        done = subprocess.run([os.path.join(self.build, "daemon/ifogd"), "--config", config], stdin=subprocess.DEVNULL, capture_output=True, text=True,
                              timeout=200, check=False)
        self.check(done.returncode == 0 and done.stderr.count(f"{HZ * DAY_S} published, 0 missing") == 2, f"a day of two sensors, {config}")

    def model_in_use(self):
        _, status = self.json("status", "--wait", "0.1")
        return {sensor["sensor"]: sensor["model_file"] for sensor in status["sensors"]}

    def killed_night(self):
        night = subprocess.Popen([self.ifog, "night", "--config", "two.toml"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(0.3)
        night.send_signal(signal.SIGKILL)
        ended = night.wait(30)
        _, report = self.json("night")
        (nose, tail) = report["sensors"]
        self.check(ended == -signal.SIGKILL and "temperature_degC" in nose["said"] and nose["proposed"] and not nose["failed"],
                   "a night that was killed half way and begun again proposes: " + nose["said"])
        self.check((tail["sensor"], tail["proposed"]) == ("ta-il_2", "") and "model in use" in tail["said"], "and nothing to the sensor whose model is right: " + tail["said"])
        self.proposed = nose["proposed"]
        shutil.copytree("state", "proposed", ignore=shutil.ignore_patterns("*.socket"))

    def propose_again(self):
        for name in os.listdir("proposed"):
            if name.startswith("nose.proposal"):
                shutil.copy(os.path.join("proposed", name), "state")

    def no_longer_configured(self):
        said, listed = self.json("proposals", config="tail.toml")
        self.check(listed["proposals"][0]["stale"] and "tail.toml has no such sensor: not to be adopted" in said and "adopt with" not in said,
                   "a proposal of a sensor that is no longer configured is listed with that")
        said, status = self.json("status", "--wait", "0.1", config="tail.toml")
        self.check(status["sensors"][1]["proposal"]["stale"] and "the configuration has no such sensor: not to be adopted" in said and "adopt with" not in said,
                   "and the status says so, too")
        self.check("no sensor 'nose'" in self.ran("adopt", "nose", code=1, config="tail.toml"), "and adopting it is refused")

    def twice_without_a_daemon(self):
        said, adopted = self.json("adopt", "nose")
        self.check(adopted["verdict"] == "open" and adopted["watched_s"] == 0 and adopted["model"] == self.proposed and "does not run" in adopted["outcome"],
                   "adopted without a daemon: its JSON is there, too, and says that nothing was watched")
        self.check("no proposal waits" in self.ran("adopt", "nose", code=1), "adopting twice is refused")
        _, back = self.json("revert", "nose")
        self.check((back["model"], back["replaced"], back["running"]) == ("", self.proposed, False), "taken back, and its JSON says what")
        self.check("nothing was adopted" in self.ran("revert", "nose", code=1), "taking back twice is refused")
        self.check("nothing was adopted" in self.ran("revert", "ta-il_2", code=1), "and of a sensor of which nothing was adopted")
        # The same proposal again: it was made against no model, and none is in use.
        self.propose_again()
        # The change is done, but the failed report makes the command fail.
        self.check("cannot write" in self.ran("adopt", "nose", "--json", "/dev/full", code=1) and self.model_in_use()["nose"] == self.proposed,
                   "adopted, and its --json had no room")
        self.check("cannot write" in self.ran("revert", "nose", "--json", "/dev/full", code=1) and self.model_in_use()["nose"] == "",
                   "taken back, and its --json had no room")
        self.propose_again()
        self.ran("adopt", "nose")
        self.ran("revert", "nose")
        self.check(self.model_in_use()["nose"] == "", "adopted and taken back once more")

    def full_disk(self):
        """With space for 0, 1, 2 … more pages: the model is adopted or not, and the files agree."""
        shutil.move("state", "kept")
        os.mkdir("state")
        if subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={ROOM}", "none", "state"], capture_output=True, check=False).returncode != 0:
            print("skipped  a full and a read-only state folder: mounts are not allowed here", flush=True)
            os.rmdir("state")
            shutil.move("kept", "state")
            return
        shutil.copytree("kept", "state", dirs_exist_ok=True, ignore=shutil.ignore_patterns("*.socket"))
        refused = 0
        for pages in range(8):
            self.propose_again()
            room = os.statvfs("state").f_bavail * os.statvfs("state").f_frsize - pages * PAGE
            with open("state/ballast", "wb") as file:
                file.write(bytes(room))
            done = subprocess.run([self.ifog, "adopt", "nose", "--config", "two.toml"], capture_output=True, text=True, timeout=60, check=False)
            os.remove("state/ballast")
            in_use, waits = self.model_in_use()["nose"], os.path.exists("state/nose.proposal.json")
            if done.returncode != 0:
                refused += 1
                good = in_use == "" and waits and "No space left on device" in done.stderr and done.stderr.count("\n") == 1
            else:
                good = in_use == self.proposed and not waits
                self.ran("revert", "nose")
            self.check(good and self.model_in_use()["nose"] == "" and self.json("status", "--wait", "0.1")[1]["sensors"][0]["damaged"] == "",
                       f"a disk with {pages} pages left: {'refused and nothing changed' if done.returncode else 'adopted'}{'' if good else ': ' + done.stderr}")
        self.check(0 < refused < 8, f"{refused} of 8 found too little room")

        self.propose_again()
        # A new night has work, but no space to write.
        os.remove("state/nose.night.json")
        subprocess.run(["mount", "-o", "remount,ro", "state"], check=True)
        self.check("Read-only file system" in self.ran("adopt", "nose", code=1), "a state folder that is read-only: adopting is refused")
        said, report = self.json("night", "--sensor", "nose", code=1)
        self.check(report["sensors"][0]["failed"] and "Read-only file system" in said, "the night says that it has nowhere to write")
        self.check(self.json("proposals")[1]["proposals"][0]["model"] == self.proposed and self.model_in_use()["nose"] == "", "what waits is listed all the same")
        subprocess.run(["mount", "-o", "remount,rw", "state"], check=True)
        self.ran("adopt", "nose")
        self.ran("revert", "nose")
        subprocess.run(["umount", "state"], check=True)
        os.rmdir("state")
        shutil.move("kept", "state")

    def clock_set_back(self):
        """The second day is recorded with the adopted model, with a clock that was set back by a year."""
        self.propose_again()
        self.ran("adopt", "nose")
        self.day("second.toml")
        for name in ("nose", "ta-il_2"):
            folder = os.path.join("record", name)
            last = sorted(os.listdir(folder))[-1]
            with open(os.path.join(folder, last), "rb") as file:
                content = flight_file.shifted(file.read(), -365 * 86_400 * 10**9)
            os.remove(os.path.join(folder, last))
            year = int(re.search(r"-(\d{4})", last).group(1))
            with open(os.path.join(folder, last.replace(f"-{year}", f"-{year - 1}")), "wb") as file:
                file.write(content)
        said, report = self.json("night", config="second.toml")
        self.check(report["sensors"][0]["promise"].startswith("the promise came true"), "the night judges the adoption on a day before it by the clock: "
                   + report["sensors"][0]["promise"])
        self.check(self.json("status", "--wait", "0.1")[1]["sensors"][0]["last_change"]["outcome"].count("the promise came true") == 1, "and the status has it")
        # Both days at once, as in the first night of a new state folder.
        self.ran("revert", "nose", config="second.toml")
        os.remove("state/nose.night.json")
        said, report = self.json("night", "--sensor", "nose", config="second.toml")
        self.check(report["sensors"][0]["proposed"] != "" and "temperature_degC" in said, "both days together propose: " + report["sensors"][0]["said"])
        self.ran("denoise", "record/nose", "--output", "both.csv", config=None)
        with open("both.csv") as file:
            rows = sum(not line.startswith("#") for line in file) - 1
        self.check(rows == 2 * HZ * DAY_S, f"and are filtered whole, {rows} samples")


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    for tool in ("ip", "unshare", "mount"):
        if shutil.which(tool) is None:
            print(f"SKIPPED: {tool} is missing; tools/install-packages test brings it")
            sys.exit(77)
    build = os.path.abspath(sys.argv[1])
    private_network.enter(mounts=True)
    work = tempfile.mkdtemp()
    odd = Odd(build, work)
    try:
        odd.make()
        odd.day("two.toml")
        odd.killed_night()
        odd.no_longer_configured()
        odd.twice_without_a_daemon()
        odd.full_disk()
        odd.clock_set_back()
    finally:
        os.chdir("/")
        shutil.rmtree(work, ignore_errors=True)
    sys.exit(odd.failed > 0)


if __name__ == "__main__":
    main()

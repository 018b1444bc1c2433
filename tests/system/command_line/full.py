#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""On a full disk or with full standard output, every command gives exit status 1 and one line with the failed output; the final name
has its previous content or does not exist.

usage: full.py PATH_OF_IFOG SOURCE_DIR PATH_OF_IFOGD PATH_OF_LCM_RECORD

On a separate disk in a mount namespace. The program lists its commands and outputs; one without a case here is a failure. Exit 77
if mounts are not allowed.
"""
import json
import os
import pathlib
import subprocess
import sys
import tempfile
import time

from run import IFOG, SCENARIO, SOURCE

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import each_check  # noqa: E402
import private_network  # noqa: E402

IFOGD, LCM_RECORD = sys.argv[3:5]
PAGE, SIZE = 4096, 1 << 19
ROOMS = (0, 2, 9)  # pages that are left
OUTPUTS = {"--json", "--plot", "--output", "--write-model", "--report", "--truth"}
CONFIG = """[daemon]
lock_memory = false
lcm_url = "{url}"
state_folder = "{folder}/state"
[[sensor]]
name = "nose"
driver = "dbc"
[sensor.transport]
type = "file"
path = "{folder}/long.log"
format = "candump"
pace = "recorded"
[sensor.options]
dbc = "{source}/drivers/dbc/examples/ifogd_gyro.dbc"
signal = "Rate_x"
counter = "Counter"
rate_hz = 50
"""
URL = "udpm://239.255.76.67:7667?ttl=0"
FRAMES = ["--dbc", str(SOURCE / "drivers/dbc/examples/ifogd_gyro.dbc"), "--option", "signal=Rate_x", "--option", "counter=Counter", "--option", "rate_hz=50"]


class Checks:
    def __init__(self, folder):
        self.folder, self.disk = folder, folder / "disk"
        self.disk.mkdir()
        subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={SIZE}", "none", self.disk], check=True)
        self.disk.chmod(0o755)
        (folder / "state").mkdir()
        (folder / "record").mkdir()
        (folder / "rest.toml").write_text(SCENARIO.replace("duration_s = 400", "duration_s = 50"))
        self.capture = folder / "rest.csv"
        assert self.ran(["simulate", folder / "rest.toml", "--output", self.capture]).returncode == 0
        config = CONFIG.format(folder=folder, source=SOURCE, url=URL)
        (folder / "one.toml").write_text(config)
        (folder / "night.toml").write_text(config + f'[sensor.record]\nfolder = "{folder}/record"\n')
        (folder / "lot.toml").write_text('type = "T"\n' + "".join(f'[[gyro]]\nserial = "G{i}"\ncaptures = ["g{i}.csv"]\n' for i in range(3)))
        for i in range(3):
            assert self.ran(["simulate", folder / "rest.toml", "--seed", i, "--output", f"g{i}.csv"]).returncode == 0
        self.daemon = None

    def end(self):
        if self.daemon:
            self.daemon.terminate()
            self.daemon.wait(timeout=20)
        subprocess.run(["umount", self.disk], check=True)

    def publish(self):
        """For 400 s, longer than all of this takes; a log of two of them."""
        (self.folder / "long.toml").write_text(SCENARIO)
        assert self.ran(["simulate", "long.toml", "--output", "long.csv"]).returncode == 0
        assert self.ran(["convert", "long.csv", "long.log", *FRAMES]).returncode == 0
        quick = (self.folder / "one.toml").read_text().replace('pace = "recorded"', 'pace = "recorded"\nspeed = 200')
        (self.folder / "quick.toml").write_text(quick)
        recorder = subprocess.Popen([LCM_RECORD, URL, "IFOG_NOSE", self.folder / "nose.lcm"], stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL)
        time.sleep(0.5)
        assert self.ran(["--config", "quick.toml"], IFOGD).returncode == 0
        recorder.terminate()
        assert recorder.wait(timeout=20) == 0
        self.daemon = subprocess.Popen([IFOGD, "--config", self.folder / "one.toml"], stdin=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
        time.sleep(1)

    def ran(self, words, program=IFOG, stdout=subprocess.PIPE):
        return subprocess.run([program, *map(str, words)], cwd=self.folder, stdin=subprocess.DEVNULL, stdout=stdout, stderr=subprocess.PIPE, timeout=120,
                              check=False)

    def fill(self, pages):
        """Fills the disk except for this space."""
        ballast = self.disk / "ballast"
        ballast.unlink(missing_ok=True)
        disk = os.statvfs(self.disk)
        ballast.write_bytes(bytes(disk.f_bavail * disk.f_frsize - pages * PAGE))

    def commands(self):
        """For each command: quick arguments and its outputs, which are an option or an argument, with the name's ending."""
        capture, one = [self.capture], ["--config", self.folder / "one.toml"]
        tune = [*capture, "--samples", "2000", "--state", "random-walk"]
        heard = ["--seconds", "0.6", "--lcm-url", URL]
        return {
            "allan": (capture, {"--json": ".json", "--plot": ".svg"}),
            "compare": (capture, {"--json": ".json", "--plot": ".svg"}),
            "convert": (capture, {None: (".csv", ".h5", ".log", ".kvh")}),
            "denoise": ([*capture, "--filter", "ckf"], {"--output": (".csv", ".h5", ".csv.gz"), "--json": ".json", "--plot": ".png"}),
            "drivers": ([], {"--json": ".json"}),
            "monitor": (["--plain", *heard], {"--json": ".json"}),
            "picture": ([self.folder / "nose.lcm"], {"--output": ".svg"}),
            "record": (heard, {"--output": ""}),
            "replay": ([*capture, "--speed", "0", *FRAMES], {"--to": ".log", "--json": ".json"}),
            "tune": (tune, {"--json": ".json", "--write-model": ".toml"}),
            "diagnose": ([*capture, "--quiet"], {"--json": ".json", "--write-model": ".toml", "--report": ".html"}),
            "fleet": ([self.folder / "lot.toml", "--engine", "local", "--jobs", "1"], {"--results": ""}),
            "simulate": ([self.folder / "rest.toml"], {"--output": (".csv", ".h5"), "--truth": ".json"}),
            "status": ([*one, "--wait", "0.1"], {"--json": ".json"}),
            "proposals": (one, {"--json": ".json"}),
            "adopt": (None, {"--json": ".json"}),
            "revert": (None, {"--json": ".json"}),
            "night": (["--config", self.folder / "night.toml"], {"--json": ".json"}),
        }

    def cases(self):
        """(arguments, the output's option or None, the name's ending), one for each output of each command."""
        for command, (words, outputs) in self.commands().items():
            for option, endings in outputs.items() if words is not None else ():
                for ending in (endings,) if isinstance(endings, str) else endings:
                    more = ["--driver", "kvh1750", "--option", "format=b"] if ending == ".kvh" else FRAMES if command == "convert" and ending == ".log" else []
                    if command == "denoise" and option != "--output":
                        more = ["--output", "/dev/null"]
                    if command == "simulate" and option != "--output":
                        more = ["--output", "null.csv"]
                    if command == "replay" and option == "--json":
                        more = ["--to", "file:/dev/null"]
                    yield [command, *words, *more], option, ending

    @staticmethod
    def written(option, path):
        return [path] if option is None else [option, f"file:{path}" if option == "--to" else path]

    def check_every_output_there_is(self):
        described = json.loads(self.ran(["--describe"]).stdout)
        commands = self.commands()
        assert {command["name"] for command in described["commands"]} == set(commands), "a command without a case, or the other way round"
        for command in described["commands"]:
            options = {name for option in command["options"] for name in option.get("names", [])} & OUTPUTS
            assert options <= set(commands[command["name"]][1]), f"{command['name']}: {options} have no case"

    def check_a_disk_that_is_full(self):
        wrong = []
        for words, option, ending in self.cases():
            for pages in ROOMS:
                for old in (False, True) if ending and pages == 0 else (pages % 2 == 0 and ending != "",):
                    try:
                        self.on_a_full_disk(words, option, ending, pages, old)
                    except AssertionError as error:
                        wrong.append(str(error))
        assert not wrong, "\n".join(wrong)

    def on_a_full_disk(self, words, option, ending, pages, old):
        for each in self.disk.iterdir():
            subprocess.run(["rm", "-rf", each], check=True)
        target = self.disk / ("out" + ending)
        if old:
            target.write_text("old\n")
        self.fill(pages)
        before = sorted(os.listdir(self.disk))
        result = self.ran([*words, *self.written(option, target)])
        said, what = result.stderr.decode(), f"{words[0]} {option} *{ending}, {pages} pages left{', over an old one' if old else ''}"
        if result.returncode == 0:  # there was enough space
            assert pages > 0 and target.exists(), f"{what}: exit 0: {said}"
            assert ending == "" or not old or target.read_bytes() != b"old\n", f"{what}: exit 0 and nothing written"
            return
        assert result.returncode == 1, f"{what}: exit {result.returncode}: {said}"
        # A fleet reports it for each gyro; a recorder, which waits for space, at the first time and at its end.
        lines, most = said.splitlines(), {"fleet": 3, "record": 2}.get(words[0], 1)
        told = [line for line in lines if "No space left on device" in line and str(self.disk) in line]
        assert 1 <= len(told) <= most and (most == 1 or lines == told), f"{what}: {said}"
        if ending != "":
            assert sorted(os.listdir(self.disk)) == before, f"{what}: left {sorted(os.listdir(self.disk))}"
            assert not old or target.read_text() == "old\n", f"{what}: what was there is gone"

    def words_said(self):
        """Everything on standard output: a command's text, its data, its help."""
        for words, option, ending in self.cases():
            if option == "--to" or ending in ("", ".h5", ".csv.gz", ".png", ".kvh"):
                continue
            yield IFOG, [*words, *self.written(option, "-")]
        for command, (words, outputs) in self.commands().items():
            yield IFOG, [command, "--help"]
            if words is not None and command not in ("convert", "record", "replay", "picture"):
                needed = {"denoise": ["--output", "/dev/null"], "simulate": ["--output", "null.csv"]}.get(command, [])
                yield IFOG, [command, *(word for word in words if word != "--quiet"), *needed]
        for words in (["--help"], ["--version"], ["--describe"], ["convert", self.capture, "null.csv"]):
            yield IFOG, words
        for words in (["--help"], ["--version"], ["--check", "--config", self.folder / "one.toml"]):
            yield IFOGD, words

    def check_a_full_standard_output(self):
        self.fill(0)
        wrong = []
        for program, words in self.words_said():
            for where in ("/dev/full", self.disk / "said", None) if len(words) < 3 else ("/dev/full",):
                if where is None and program == IFOGD:
                    continue  # a daemon continues without its streams
                if where is None:  # closed
                    result = subprocess.run(["bash", "-c", '"$@" >&-', "bash", program, *map(str, words)], cwd=self.folder, stdin=subprocess.DEVNULL,
                                            stderr=subprocess.PIPE, timeout=120, check=False)
                else:
                    with open(where, "wb") as out:
                        result = self.ran(words, program, out)
                said, what = result.stderr.decode(), f"{os.path.basename(program)} {' '.join(map(str, words))} >{where or '&-'}"
                told = [line for line in said.splitlines() if "cannot write" in line]
                if result.returncode != 1 or len(told) != 1 or "standard output" not in told[0]:
                    wrong.append(f"{what}: exit {result.returncode}: {said}")
        assert not wrong, "\n".join(wrong)


if __name__ == "__main__":
    if subprocess.run(["unshare", "-m" if os.geteuid() == 0 else "-rm", "true"], capture_output=True, check=False).returncode != 0:
        print("skipped: mounts of one's own are not allowed here")
        sys.exit(77)
    private_network.enter(mounts=True)
    with tempfile.TemporaryDirectory() as work:
        checks = Checks(pathlib.Path(work))
        try:
            checks.publish()
            failed = each_check.failures_of(checks)
        finally:
            checks.end()
    sys.exit(1 if failed else 0)

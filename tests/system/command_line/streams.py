#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Inputs and outputs of `ifog` under attack: pipes and standard streams instead of files, devices, links, full disks, closed pipes,
interrupts, and names with a meaning for a shell, a terminal or a picture.

usage: streams.py PATH_OF_IFOG SOURCE_DIR
"""
import gzip
import json
import os
import resource
import shutil
import signal
import stat
import subprocess
import sys
import tempfile
import time
import xml.etree.ElementTree

from run import IFOG, SCENARIO, SOURCE, columns, ifog, main_of, ran, refused

FRAMES = ["--dbc", SOURCE / "drivers/dbc/examples/ifogd_gyro.dbc", "--option", "signal=Rate_x", "--option", "counter=Counter",
          "--option", "rate_hz=50"]


def piped(bytes_in, *arguments):
    return subprocess.run([IFOG, *map(str, arguments)], input=bytes_in, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, check=False)


def shell(line, **names):
    return subprocess.run(["bash", "-c", line], env={**os.environ, "ifog": IFOG, **{k: str(v) for k, v in names.items()}},
                          stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, timeout=120, check=False)


def one_line(text, *parts):
    assert len(text.strip().splitlines()) == 1, f"expected one line: {text}"
    for part in parts:
        assert part in text, f"'{part}' is not in '{text.strip()}'"


class Checks:
    def __init__(self, folder):
        self.folder = folder
        (folder / "rest.toml").write_text(SCENARIO.replace("duration_s = 400", "duration_s = 100"))
        self.capture = folder / "rest.csv"
        ifog("simulate", folder / "rest.toml", "--output", self.capture)

    def fresh(self, name):
        """An empty folder; afterwards it contains what the command left."""
        folder = self.folder / name
        folder.mkdir()
        return folder

    def link(self, name, to):
        link = self.folder / ("link_" + name)
        link.unlink(missing_ok=True)
        link.symlink_to(to)
        return link

    @staticmethod
    def ending(option):
        return {"--plot": ".svg", "--output": ".csv", "": ".csv"}.get(option, "")

    def outputs(self):
        """Every option with an output file, in a quick command."""
        model = self.folder / "m.toml"
        if not model.exists():
            ifog("tune", self.capture, "--samples", "2000", "--state", "random-walk", "--write-model", model)
        tune = ["tune", self.capture, "--samples", "2000", "--state", "random-walk"]
        compare = ["compare", self.capture]
        denoise = ["denoise", self.capture, "--filter", "ckf"]
        diagnose = ["diagnose", self.capture]
        return [(["allan", self.capture], "--json"), (["allan", self.capture], "--plot"), (denoise, "--output"),
                ([*denoise, "--output", "/dev/null"], "--json"), ([*denoise, "--output", "/dev/null"], "--plot"),
                (tune, "--json"), (tune, "--write-model"), (compare, "--json"), (compare, "--plot"),
                (diagnose, "--json"), (diagnose, "--write-model"), (diagnose, "--report"),
                (["simulate", self.folder / "rest.toml"], "--output"), (["convert", self.capture], ""),
                (["replay", self.capture, "--speed", "0", *FRAMES], "--to")]

    @staticmethod
    def target(option, path):
        if option == "--to":
            return [option, path if path == "-" else f"file:{path}"]
        return [option, path] if option else [path]

    # --- reading ---

    def check_standard_input_for_every_capture(self):
        """The same result as from the file, plain and packed."""
        text = self.capture.read_bytes()
        for command in (["allan"], ["tune", "--samples", "2000", "--state", "random-walk"], ["compare"], ["diagnose"]):
            path = self.folder / "in.json"
            ifog(command[0], self.capture, *command[1:], "--json", path)
            expected = json.loads(path.read_text())
            for sent in (text, gzip.compress(text)):
                result = piped(sent, command[0], "-", *command[1:], "--json", "-")
                assert result.returncode == 0, f"{command}: {result.stderr.decode()}"
                found = json.loads(result.stdout)
                for answer in (expected, found):
                    for key in ("capture", "notes"):
                        answer.pop(key, None)
                    for axis in answer.get("axes", []):
                        axis.pop("capture", None)
                        axis.pop("notes", None)  # they begin with the file's name
                assert found == expected, f"{command} says other things of standard input"
        out = self.folder / "in.csv"
        ifog("denoise", self.capture, "--output", out)
        assert piped(text, "denoise", "-", "--output", "-").stdout == out.read_bytes()

    def check_pipes_without_a_name(self):
        for command in ('allan <(cat "$capture")', 'allan <(gzip -c "$capture")', 'tune <(cat "$capture") --samples 2000 --state random-walk',
                        'denoise <(gzip -c "$capture") --output /dev/null', 'compare <(cat "$capture")', 'convert <(cat "$capture") "$out"'):
            result = shell(f'"$ifog" {command}', capture=self.capture, out=self.folder / "piped.csv")
            assert result.returncode == 0, f"{command}: {result.stderr}"
        assert columns(self.folder / "piped.csv") == columns(self.capture)

    def check_frames_through_a_pipe(self):
        log = self.folder / "rest.log"
        ifog("convert", self.capture, log, *FRAMES)
        ifog("convert", log, self.folder / "frames.csv", *FRAMES)
        result = piped(log.read_bytes(), "convert", "-", "-", *FRAMES)
        assert result.returncode == 0, result.stderr.decode()
        assert result.stdout == (self.folder / "frames.csv").read_bytes()
        back = piped(self.capture.read_bytes(), "convert", "-", "-", *FRAMES)
        assert back.returncode == 0 and back.stdout == log.read_bytes(), back.stderr.decode()

    def check_lines_are_named_without_a_second_look(self):
        lines = self.capture.read_text().splitlines()
        header = next(i for i, line in enumerate(lines) if line.startswith("time_s"))
        lines.insert(header + 11, "# a remark")
        del lines[header + 2002:header + 2102]
        result = piped(("\n".join(lines) + "\n").encode(), "allan", "-", "--gaps", "refuse")
        assert result.returncode == 1
        # Data row 2000, counted from one, is one line lower because of the comment.
        one_line(result.stderr.decode(), f"-:{header + 2002}: 1 gap")

    def check_standard_input_is_read_once(self):
        result = piped(self.capture.read_bytes(), "allan", "-", "-")
        assert result.returncode == 1
        one_line(result.stderr.decode(), "standard input", "once")

    # --- writing ---

    def check_standard_output_for_every_output(self):
        """Only data there, and no file of that name."""
        folder = self.fresh("standard_output")
        for command, option in self.outputs():
            result = subprocess.run([IFOG, *map(str, command), *self.target(option, "-")], cwd=folder, stdin=subprocess.DEVNULL,
                                    stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, check=False)
            what = f"{command[0]} {option} -"
            assert result.returncode == 0, f"{what}: {result.stderr.decode()}"
            text = result.stdout.decode()
            if option == "--json":
                json.loads(text)
            elif option in ("--plot", "--report"):
                assert text.startswith("<") and text.rstrip().endswith(("</svg>", "</html>")), f"{what}: {text[:80]}"
            elif option == "--write-model":
                assert text.startswith("version = "), f"{what}: {text[:80]}"
            elif option == "--to":
                assert text.startswith("(") and len(text.splitlines()) == 5000, f"{what}: {text[:80]}"
            else:
                assert text.lstrip("#").strip() and all("," in line or line.startswith("#") for line in text.splitlines()), f"{what}: {text[:80]}"
            assert result.stderr, f"{what}: the text for people is lost"
        assert not os.listdir(folder), os.listdir(folder)
        refused(2, "denoise", self.capture, "--output", "-", "--json", self.link("stdout", "/proc/self/fd/1"), says=["--json", "--output", "only one"])

    def check_a_link_to_standard_output(self):
        """Like /dev/stdout; a program that replaced it must not replace the system's."""
        stdout = self.link("out", "/proc/self/fd/1")
        expected = self.folder / "expected.csv"
        ifog("denoise", self.capture, "--output", expected)
        assert ran("denoise", self.capture, "--output", stdout).stdout == expected.read_text()
        into = self.folder / "into.csv"
        result = shell('{ echo before; "$ifog" denoise "$capture" --output "$stdout"; echo after; } > "$into"', capture=self.capture, into=into, stdout=stdout)
        assert result.returncode == 0 and into.read_text() == "before\n" + expected.read_text() + "after\n"
        assert stdout.is_symlink()

    def check_a_full_disk_and_a_closed_pipe(self):
        for command, option in self.outputs():
            full = self.link("full" + self.ending(option), "/dev/full")
            result = ran(*command, *self.target(option, full))
            assert result.returncode == 1, f"{command[0]} {option} {full}: exit {result.returncode}: {result.stderr}"
            assert str(full) in result.stderr and "No space left" in result.stderr, result.stderr
            for where in (">/dev/full", ">&-", "| true"):
                line = " ".join(["set -o pipefail; \"$ifog\"", *(f"'{part}'" for part in [*command, *self.target(option, "-")]), where])
                result = shell(line)
                assert result.returncode == 1, f"{line}: exit {result.returncode}: {result.stderr}"
                assert "cannot write" in result.stderr or "standard output" in result.stderr, f"{line}: {result.stderr}"
        for where in (">/dev/full", ">&-"):
            for command in ('allan "$capture"', "drivers", "--help"):
                result = shell(f'"$ifog" {command} {where}', capture=self.capture)
                assert result.returncode == 1, f"{command} {where}: exit {result.returncode}"
                one_line(result.stderr, "standard output: cannot write")
        for command in ('allan "$capture"', "drivers", 'compare "$capture"'):
            result = shell(f'set -o pipefail; "$ifog" {command} | true', capture=self.capture)
            assert result.returncode == 141 and not result.stderr, f"{command} | true: exit {result.returncode}: {result.stderr}"
        # An endless output ends when its reader closes it, even without data.
        result = shell('set -o pipefail; timeout 20 "$ifog" monitor --json - --seconds 15 --lcm-url memq:// | true')
        assert result.returncode == 141 and not result.stderr, f"monitor | true: exit {result.returncode}: {result.stderr}"
        folder = self.fresh("limit")
        result = shell('ulimit -f 8; cd "$folder" && "$ifog" denoise "$capture" --output out.csv', folder=folder, capture=self.capture)
        assert result.returncode == 1 and not os.listdir(folder), f"exit {result.returncode}: {os.listdir(folder)}"
        one_line(result.stderr, "out.csv: cannot write: File too large")

    def check_devices_and_links_stay(self):
        folder = self.fresh("devices")
        for command, option in self.outputs():
            # A separate device if possible, because the system's is needed.
            null = folder / ("null" + self.ending(option))
            if os.geteuid() == 0 and not null.exists():
                os.mknod(null, 0o666 | stat.S_IFCHR, os.makedev(1, 3))
            if null.exists():
                ifog(*command, *self.target(option, null))
                assert stat.S_ISCHR(os.stat(null).st_mode), f"{command[0]} {option} replaced the device"
            file = folder / "behind"
            file.write_text("old")
            file.chmod(0o600)
            link = self.link("link" + self.ending(option), file)
            ifog(*command, *self.target(option, link))
            assert link.is_symlink(), f"{command[0]} {option} replaced the link"
            assert len(file.read_text()) > 10 and stat.S_IMODE(file.stat().st_mode) == 0o600, f"{command[0]} {option}: the file behind the link"

    def check_killed_half_way(self):
        """A replay of 100 s into a file, ended within its first second."""
        folder = self.fresh("killed")
        target = folder / "out.log"
        target.write_text("old")
        for how in (signal.SIGKILL, signal.SIGHUP):
            player = subprocess.Popen([IFOG, "replay", str(self.capture), "--to", f"file:{target}", *map(str, FRAMES)],
                                      stdin=subprocess.DEVNULL, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(0.7)
            assert player.poll() is None, "the replay ended too soon to be killed"
            player.send_signal(how)
            player.wait(timeout=20)
            assert os.listdir(folder) == ["out.log"] and target.read_text() == "old", f"{how}: {os.listdir(folder)}"

    def check_no_picture_without_data(self):
        folder = self.fresh("pictures")
        bad = self.folder / "bad.csv"
        bad.write_text("time_s,rate_radps\n0,abc\n")
        for name in ("p.svg", "p.png"):
            refused(1, "allan", bad, "--plot", folder / name, says=["bad.csv:2"])
        refused(2, "allan", self.capture, "--plot", folder / "p.jpeg", says=[".svg or .png"])
        refused(1, "allan", self.capture, "--plot", folder / "no" / "p.svg", says=["No such file"])
        assert not os.listdir(folder), os.listdir(folder)

    # --- no further threads available ---

    def check_no_thread_to_be_had(self):
        """Parallel work is done by one thread, with the same bytes."""
        folder = self.fresh("alone")
        program = shutil.copy(IFOG, folder)
        long = folder / "long.csv"  # read in several blocks
        long.write_text("time_s,rate_radps\n" + "".join(f"{i / 100},{(i * 2654435761 % 1000003) / 1e9}\n" for i in range(40000)))
        for path in (self.folder, folder, program):
            os.chmod(path, 0o755)
        other = {"user": 65534, "group": 65534, "extra_groups": []} if os.geteuid() == 0 else {}  # root has no limit

        def alone(words):
            return subprocess.run(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, check=False, **other,
                                  preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_NPROC, (1, 1)))  # noqa: PLW1509

        started = alone([sys.executable, "-c", "import threading; threading.Thread(target=int).start()"])
        assert b"can't start new thread" in started.stderr, "the limit is none here"
        for command in (["allan", long, "--json", "-"], ["tune", long, "--json", "-"], ["denoise", long, "--output", "-"]):
            usual, result = ran(*command), alone([program, *map(str, command)])
            assert result.returncode == usual.returncode == 0, f"{command}: {result.stderr}"
            assert result.stdout == usual.stdout.encode(), command
        packed = folder / "long.h5"
        ifog("convert", long, packed)
        result = alone([program, "allan", packed])
        assert result.returncode == 1
        one_line(result.stderr.decode(), str(packed), "no process to read it")

    # --- names with a special meaning ---

    def check_no_name_is_a_command(self):
        """For a shell, a terminal, or a reader of a picture."""
        folder = self.fresh("names")
        text = self.capture.read_text()
        names = ["x`touch PWNED`.csv", "$(touch PWNED).csv", "\x1b]0;owned\x07\x1b[31m.csv", "<b>&amp;\"'.csv", "\x9b31m\u202e.csv", "line\nend.csv"]
        for name in names:
            (folder / name).write_text(text)
        (folder / "col.csv").write_text(text.replace("rate_radps", "rate_`touch PWNED`\x1b[2J<_radps"))
        for name in [*names, "col.csv"]:
            for command in (["allan", name, "--plot", "p.svg"], ["allan", name, "--plot", "p.png"],
                            ["denoise", name, "--output", "o.csv", "--plot", "d.svg"], ["compare", name, "--plot", "c.svg"],
                            ["diagnose", name, "--report", "r.html"], ["allan", name + "?"]):
                result = subprocess.run([IFOG, *command], cwd=folder, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                        stderr=subprocess.PIPE, timeout=120, check=False)
                assert result.returncode == (1 if name + "?" in command else 0), f"{command}: {result.stderr}"
                said = (result.stdout + result.stderr).decode()
                assert not [c for c in said if c != "\n" and (ord(c) < 32 or 127 <= ord(c) < 160 or c == "\u202e")], f"{command}: {said!r}"
            for picture in ("p.svg", "d.svg", "c.svg"):
                xml.etree.ElementTree.parse(folder / picture)
            page = (folder / "r.html").read_text()
            assert page.rstrip().endswith("</html>") and "<b>&" not in page, f"{name}: in the report as it is"
            assert (folder / "p.png").read_bytes().startswith(b"\x89PNG")
        assert not (folder / "PWNED").exists(), "a name was run as a command"

    def check_json_of_a_name_that_is_no_text(self):
        name = os.fsencode(self.folder) + b"/\xff\xfe.csv"
        with open(name, "wb") as file:
            file.write(self.capture.read_bytes())
        result = subprocess.run([os.fsencode(IFOG), b"allan", name, b"--json", b"-"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=120, check=False)
        assert result.returncode == 0, result.stderr
        json.loads(result.stdout)


if __name__ == "__main__":
    sys.exit(main_of(Checks))

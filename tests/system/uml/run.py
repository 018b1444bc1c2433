#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The daemon on a virtual CAN bus at full speed, in a real kernel that runs as a process (user-mode Linux).

usage: run.py BUILD WORK [FOLDER_WITH_REAL_CAPTURES [WORD]]

Prints one line for each check: `ok`, `FAILED` or `skipped`, its name, and the result. IFOG_UML_SECONDS (20): duration of each
transmission at 1 kHz. WORD: only checks with it in their name.
"""
import csv
import gzip
import json
import os
import re
import shutil
import subprocess
import sys
import time
import traceback

HERE = os.path.dirname(os.path.abspath(__file__))
sys.path[:0] = [os.path.join(HERE, "..", "box"), os.path.join(HERE, "..")]
import flight_file  # noqa: E402
import frames  # noqa: E402

HERTZ = 1000
SECONDS = float(os.environ.get("IFOG_UML_SECONDS", "20"))
# Value of one count of the DBC's Rate below, used part of a recording, and its speed factor.
RESOLUTION = 1e-11
CAPTURE_SAMPLES = 12000
SPEED = 2
# Replay of a recording: nearly all frames are on time within the limit, and half of them within MEDIAN_S, unless the host stopped
# the machine; on a busy host at least this share.
# host did not stop the whole machine; on a busy one that must be for this share of them at least.
ON_TIME_S, ON_TIME_SHARE, MEDIAN_S, LEAST_JUDGED = 0.005, 0.99, 0.001, 0.1


class Failure(Exception):
    """A failed check."""


class Skipped(Exception):
    """A skipped check; the text names the missing requirement."""


def dbc(factor, limit):
    return frames.DBC.replace("(1E-09,0) [-2|2]", f"({factor:G},0) [-{limit}|{limit}]")


def options(folder, hertz):
    return {"dbc": os.path.join(folder, "gyro.dbc"), "signal": "Rate", "counter": "Counter", "rate_hz": f"{hertz:g}"}


class Bus:
    def __init__(self, build, work, captures):
        self.build, self.work, self.captures = os.path.abspath(build), os.path.abspath(work), captures
        self.ifog = os.path.join(self.build, "tools/ifog/ifog")

    def folder(self, name, factor, limit, hertz):
        path = os.path.join(self.work, name)
        shutil.rmtree(path, ignore_errors=True)
        os.makedirs(path)
        with open(os.path.join(path, "gyro.dbc"), "w") as file:
            file.write(dbc(factor, limit))
        lines = [f'[daemon]\nplugin_folder = "{self.build}/plugins"', '[[sensor]]\nname = "gyro"\ndriver = "dbc"',
                 '[sensor.transport]\ntype = "can"\ninterface = "vcan0"', "[sensor.options]"]
        lines += [f'{key} = "{value}"' for key, value in options(path, hertz).items()]
        # The host may stop this machine for seconds, and then all pending data arrives at once: a longer ring than on a real
        # computer (1024).
        # computer of its own needs (1024).
        lines += ["[sensor.realtime]", "reader_priority = 50", "filter_priority = 49", "ring_slots = 16384"]
        with open(os.path.join(path, "ifogd.toml"), "w") as file:
            file.write("\n".join(lines) + "\n")
        return path

    def boot(self, seconds, *script):
        ran = subprocess.run([os.path.join(HERE, "boot"), self.build, str(int(seconds)), *script], stdin=subprocess.DEVNULL,
                             stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if ran.returncode != 0:
            raise Failure(ran.stdout.strip()[-1500:])
        return ran.stdout

    def stream_all(self, folder, seconds, want, *player):
        """Counts of each sensor, by LCM channel."""
        self.boot(4 * seconds + 240, os.path.join(HERE, "stream"), self.build, folder, want, *player)
        with open(os.path.join(folder, "count.json")) as file:
            return json.load(file)

    def stream(self, folder, seconds, want, *player):
        return self.stream_all(folder, seconds, want, *player).get("IFOG_GYRO", {"messages": 0})

    def every_sample(self, name, *player):
        folder = self.folder(name, 1e-9, 2, HERTZ)
        sent = int(SECONDS * HERTZ)
        log = os.path.join(folder, "can.log")
        with open(log, "w") as file:
            file.write(frames.candump(sent, HERTZ, "vcan0"))
        got = self.stream(folder, SECONDS, "count", *[part.replace("LOG", log) for part in player])
        wrong = [f"{key} {got[key]}" for key in ("missing", "out_of_order", "merged") if got.get(key)]
        if got["messages"] != sent or wrong:
            raise Failure(f"{got['messages']} messages of {sent} sent {' '.join(wrong)}")
        return f"{sent} of {sent} at {HERTZ} Hz, in order"

    def check_can_transport_tests(self):
        """The unit tests that are skipped without CAN."""
        said = self.boot(200, os.path.join(self.build, "tests/unit/transport/transport_test"), "--gtest_filter=Vcan.*", "--gtest_color=no")
        passed = re.search(r"\[  PASSED  \] (\d+) test", said)
        if not passed or int(passed.group(1)) == 0 or "SKIPPED" in said:
            raise Failure(said[-1500:])
        return f"{passed.group(1)} tests of the CAN transport pass on vcan0"

    def check_every_sample_with_canplayer(self):
        return self.every_sample("canplayer", "canplayer", "-I", "LOG")

    def check_every_sample_with_ifog_replay(self):
        return self.every_sample("replay", self.ifog, "replay", "LOG", "--to", "can:vcan0")

    def check_sixty_four_sensors(self):
        """64 gyros on one bus at 100 Hz, each with its own pipeline: every sample of each."""
        sensors, hertz, seconds = 64, 100, 10
        folder = self.folder("many", 1e-9, 2, hertz)
        ids = [0x200 + number for number in range(sensors)]
        tables = [f'[daemon]\nplugin_folder = "{self.build}/plugins"']
        for number, can_id in enumerate(ids):
            with open(os.path.join(folder, f"gyro{number}.dbc"), "w") as file:
                file.write(dbc(1e-9, 2).replace(f"BO_ {frames.CAN_ID} ", f"BO_ {can_id} "))
            tables.append(f'[[sensor]]\nname = "g{number}"\ndriver = "dbc"\n[sensor.transport]\ntype = "can"\ninterface = "vcan0"\n'
                          f'[sensor.options]\ndbc = "{folder}/gyro{number}.dbc"\nsignal = "Rate"\ncounter = "Counter"\nrate_hz = {hertz}\n'
                          "[sensor.filter]\nprocess_noise = 1e-6\nmeasurement_noise = 1e-9\n")
        with open(os.path.join(folder, "ifogd.toml"), "w") as file:
            file.write("\n".join(tables))
        log = os.path.join(folder, "can.log")
        with open(log, "w") as file:
            for number, line in enumerate(frames.candump(seconds * hertz, hertz, "vcan0").splitlines()):
                for later, can_id in enumerate(ids):
                    stamp = 1_700_000_000 + number / hertz + later * 1e-4
                    file.write(f"({stamp:.6f}) vcan0 {can_id:03X}#{line.split('#')[1]}\n")
        got = self.stream_all(folder, seconds, "count", "canplayer", "-I", log)
        wrong = [f"{name}: {count['messages']} messages, {count['missing']} missing, {count['merged']} merged"
                 for name, count in got.items() if count["messages"] != seconds * hertz or count["missing"] or count["merged"]]
        if len(got) != sensors or wrong:
            raise Failure(f"{len(got)} of {sensors} sensors published; of {seconds * hertz} samples: {'; '.join(wrong[:5])}")
        return f"{sensors} sensors, {seconds * hertz} of {seconds * hertz} samples of each at {hertz} Hz"

    def check_a_channel_from_another_can_frame(self):
        """A temperature from another unit on the bus, in the sensor's status."""
        folder = self.folder("channel", 1e-9, 2, 100)
        with open(os.path.join(folder, "coil.dbc"), "w") as file:
            file.write('VERSION ""\nBS_:\nBU_: UNIT\nBO_ 801 Coil: 2 UNIT\n SG_ Temperature : 7|16@0- (0.01,0) [-100|100] "degC" UNIT\n')
        with open(os.path.join(folder, "ifogd.toml"), "a") as file:
            file.write('[[sensor.channel]]\nname = "coil_degC"\nsource = "can"\ninterface = "vcan0"\ndbc = "coil.dbc"\n'
                       'signal = "Coil.Temperature"\n')
        lines = []
        for number, line in enumerate(frames.candump(800, 100, "vcan0").splitlines()):
            lines.append(line)
            if number % 50 == 0:  # -12.34 °C, big-endian hundredths
                lines.append(f"{line.split()[0]} vcan0 321#{(-1234 & 0xFFFF):04X}")
        log, seen = os.path.join(folder, "can.log"), os.path.join(folder, "monitor.txt")
        with open(log, "w") as file:
            file.write("\n".join(lines) + "\n")
        self.stream(folder, 8, "count", "bash", "-c", f"'{self.ifog}' monitor --seconds 7 >'{seen}' & canplayer -I '{log}'; wait")
        with open(seen) as file:
            said = file.read()
        if "coil_degC -12.34" not in said:
            raise Failure(f"expected coil_degC -12.34 in what the monitor shows: {said[-600:]}")
        return "coil_degC -12.34 in the sensor's status"

    def recorded(self, folder, name):
        """The frames of a folder of recordings as words of a candump log, and the messages."""
        log = os.path.join(folder, name + ".log")
        said = self.tool("replay", os.path.join(folder, name), "--speed", "0", "--to", "file:" + log)
        with open(log) as file:
            return [line.split()[2] for line in file], said

    def check_recorded_to_the_last_second_through_a_kill(self):
        """The recorder at full rate: the daemon is killed during transmission. The recording has the sent frames except those of
        the last second; the next start closes that file and records until the end."""
        folder = self.folder("killed", 1e-9, 2, HERTZ)
        with open(os.path.join(folder, "ifogd.toml"), "a") as file:
            file.write('[sensor.record]\nfolder = "record"\n')
        before_s, after_s = 6, 6
        log = os.path.join(folder, "can.log")
        with open(log, "w") as file:
            file.write(frames.candump((before_s + after_s) * HERTZ, HERTZ, "vcan0"))
        with open(log) as file:
            sent = [line.split()[2] for line in file]
        self.boot(240, os.path.join(HERE, "killed"), self.build, folder, str(before_s), "canplayer", "-I", log)
        with open(os.path.join(folder, "milliseconds")) as file:
            killed_s = int(file.read()) / 1000
        left, said = self.recorded(folder, "left")
        with open(os.path.join(folder, "due")) as file:
            due = int(file.read())
        if left != sent[:len(left)] or len(left) < due:
            raise Failure(f"{len(left)} frames recorded of those sent before the kill, {due} were due: {said}")
        if not any(name.endswith(".open") for name in os.listdir(os.path.join(folder, "left"))):
            raise Failure("the killed daemon left no open file")
        files = sorted(os.listdir(os.path.join(folder, "record", "gyro")))
        if len(files) != 2 or any(name.endswith(".open") for name in files):
            raise Failure(f"expected two closed files, found {files}")
        shutil.rmtree(os.path.join(folder, "left"))
        os.makedirs(os.path.join(folder, "second"))
        shutil.copy(os.path.join(folder, "record", "gyro", files[1]), os.path.join(folder, "second"))
        second, said = self.recorded(folder, "second")
        if not second or second != sent[-len(second):] or re.search("damaged|missing|lost", said):
            raise Failure(f"the {len(second)} frames recorded after the kill are not the last of those sent: {said}")
        return (f"killed {killed_s:.2f} s after the player began at {HERTZ} Hz: {len(left)} frames as sent, "
                f"then the last {len(second)} of {len(sent)}")

    def check_recording_sent_again_as_it_came(self):
        """`ifog replay` of a flight recording to a real bus: candump receives the same frames at their times, and a second daemon
        publishes the values of the recording to the last bit, with the same angle."""
        hertz = 200  # the rest of one processor with so many listeners and system calls
        folder = self.folder("again", 1e-9, 2, hertz)
        config = os.path.join(folder, "ifogd.toml")
        shutil.copy(config, os.path.join(folder, "again.toml"))
        with open(config, "a") as file:
            file.write('[sensor.record]\nfolder = "record"\n')
        log, sent = os.path.join(folder, "can.log"), int(8.5 * hertz)
        with open(log, "w") as file:
            file.write(frames.unevenly(frames.candump(sent, hertz, "vcan0")))
        self.boot(240, os.path.join(HERE, "replayed"), self.build, folder, self.ifog, "replay", log, "--to", "can:vcan0", "--realtime")
        recorded = []
        for name in sorted(os.listdir(os.path.join(folder, "record", "gyro"))):
            with open(os.path.join(folder, "record", "gyro", name), "rb") as file:
                recorded += [(time_ns / 1e9, flight_file.frame_text(payload)) for time_ns, _, payload in flight_file.deliveries(file.read())]
        heard = {which: frames.heard(os.path.join(folder, which + ".log")) for which in ("first", "second")}
        for which, what in (("recorded", recorded), ("heard again", heard["second"])):
            if [frame for _, frame in what] != [frame for _, frame in heard["first"]] or len(what) != sent:
                raise Failure(f"{len(what)} frames {which} are not the {len(heard['first'])} that were heard")
        count = {which: json.load(open(os.path.join(folder, which + ".json")))["IFOG_GYRO"] for which in heard}
        if count["second"]["angle"] != count["first"]["angle"] or any(each["messages"] != sent or each["missing"] for each in count.values()):
            raise Failure(f"published again: {count['second']}, the first time {count['first']}")
        denoised = os.path.join(folder, "denoised.csv")
        self.tool("denoise", os.path.join(folder, "record", "gyro"), "--output", denoised)
        same = subprocess.run([os.path.join(self.build, "tests/system/log_equals"), os.path.join(folder, "second.lcm"), "IFOG_GYRO", denoised],
                              stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if same.returncode != 0:
            raise Failure(f"published again, against `ifog denoise` of the recording: {same.stdout.strip()[-800:]}")
        with open(os.path.join(folder, "second.stops")) as file:
            stops = [tuple(map(float, line.split())) for line in file]
        late = frames.off_time(recorded, heard["second"], stops)
        on_time = sum(each <= ON_TIME_S for each in late) / max(1, len(late))
        text = (f"{sent} of {sent} frames as recorded; {len(late)} while the host did not stop the machine, {100 * on_time:.2f} % of them within "
                f"{ON_TIME_S * 1e3:g} ms of when they came at some {hertz} Hz (median {sorted(late)[len(late) // 2] * 1e6:.0f} µs, at most {max(late) * 1e3:.1f} ms); "
                f"angle {count['second']['angle']!r} rad both times, {same.stdout.strip()}")
        if on_time < ON_TIME_SHARE or sorted(late)[len(late) // 2] > MEDIAN_S or len(late) < LEAST_JUDGED * sent:
            raise Failure(text)
        return text

    def check_published_equals_offline_bit_for_bit(self):
        """capture → frames → vcan → daemon → LCM → log, compared with `ifog denoise` of the same frames."""
        folder = self.folder("bits", RESOLUTION, 0.02, 200)
        name, capture = self.capture(folder)
        log = os.path.join(folder, "can.log")
        driver = ["--driver", "dbc"] + [part for key, value in options(folder, 200).items() for part in ("--option", f"{key}={value}")]
        self.tool("convert", capture, log, *driver)
        got = self.stream(folder, CAPTURE_SAMPLES / 200 / SPEED, "log", self.ifog, "replay", log, "--to", "can:vcan0", "--speed", str(SPEED))
        if got["messages"] != CAPTURE_SAMPLES:
            raise Failure(f"{got['messages']} messages of {CAPTURE_SAMPLES} sent")
        denoised = os.path.join(folder, "denoised.csv")
        self.tool("denoise", log, "--output", denoised, "--config", os.path.join(folder, "ifogd.toml"))
        compared = subprocess.run([os.path.join(self.build, "tests/system/log_equals"), os.path.join(folder, "log.lcm"), "IFOG_GYRO", denoised,
                                   capture, str(RESOLUTION)], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if compared.returncode != 0:
            raise Failure(compared.stdout.strip()[-1500:])
        return f"{name}: {compared.stdout.strip()}"

    def tool(self, *arguments):
        ran = subprocess.run([self.ifog, *arguments], stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, check=False)
        if ran.returncode != 0:
            raise Failure(f"ifog {' '.join(arguments)}: {ran.stdout.strip()[-800:]}")
        return ran.stdout.strip()

    def capture(self, folder):
        """A capture of a real gyro if available, otherwise a simulated one; only the rate column, with an even clock."""
        target = os.path.join(folder, "capture.csv")
        real = os.path.join(self.captures or "", "blueseis_bs1_ramp.csv.gz")
        rates = []
        if os.path.exists(real):
            with gzip.open(real, "rt") as file:
                rows = csv.DictReader(line for line in file if not line.startswith("#"))
                for row in rows:
                    rates.append(row["rate_radps"])
                    if len(rates) == CAPTURE_SAMPLES:
                        break
            name = "blueseis_bs1_ramp"
        else:
            import random
            generator = random.Random(1)
            rates = [repr(7e-5 + generator.gauss(0.0, 6e-7)) for _ in range(CAPTURE_SAMPLES)]
            name = "a simulated gyro (real captures are not beside this tree)"
        with open(target, "w") as file:
            file.write("time_s,rate_radps\n")
            for index, rate in enumerate(rates):
                file.write(f"{index / 200!r},{rate}\n")
        return name, target


def main():
    bus = Bus(sys.argv[1], sys.argv[2], sys.argv[3] if len(sys.argv) > 3 else None)
    failed = 0
    word = sys.argv[4] if len(sys.argv) > 4 else ""
    for name in [name for name in vars(Bus) if name.startswith("check_") and word in name]:
        title = name.removeprefix("check_").replace("_", " ")
        began = time.monotonic()
        try:
            print(f"ok       {title}: {getattr(bus, name)()} ({time.monotonic() - began:.0f} s)", flush=True)
        except Skipped as why:
            print(f"skipped  {title}: {why}", flush=True)
        except Exception as error:  # pylint: disable=broad-except
            failed += 1
            print(f"FAILED   {title}: {error if isinstance(error, Failure) else traceback.format_exc()}", flush=True)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())

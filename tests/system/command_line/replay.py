#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`ifog replay` as a user runs it: nothing comes early or is lost, and what was not sent is said. Its delay is measured next to
canplayer in tests/bench/replay.

usage: replay.py PATH_OF_IFOG SOURCE_DIR
"""
import json
import os
import signal
import subprocess
import sys
import threading
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
from each_check import running  # noqa: E402
from run import IFOG, main_of, ran  # noqa: E402

KVH = ["--driver", "kvh1750", "--option", "format=b"]


class Checks:
    def __init__(self, folder):
        self.folder, self.log, self.again, self.report = folder, folder / "gyro.log", folder / "again.log", folder / "report.json"
        # 100 frames, 1 ms apart.
        self.log.write_text("".join(f"(1700000000.{100_000 + 1000 * n}) can3 12345678#{1000 + n}\n" for n in range(100)))

    def replay(self, *arguments, code=0, says=()):
        done = ran("replay", *arguments)
        said = done.stdout + done.stderr
        assert done.returncode == code, f"replay {arguments}: exit {done.returncode}, expected {code}: {said}"
        for part in says:
            assert part in said, f"replay {arguments}: no '{part}' in '{said}'"

    def started(self, *words):
        return running(IFOG, "replay", self.log, *words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT)

    def written(self):
        return json.loads(self.report.read_text())

    def check_the_same_log_is_written_never_early(self):
        before = time.monotonic()
        self.replay(self.log, "--to", f"file:{self.again}", "--json", self.report)
        assert time.monotonic() - before >= 0.099
        assert self.again.read_text() == self.log.read_text()
        report = self.written()
        late = report["lateness_us"]
        assert (report["schema"], report["sent"], report["unit"]) == ("ifog.replay/1", 100, "frame") and report["seconds"] >= 0.099, report
        assert late["p50"] <= late["p99"] <= late["max"], late

    def check_each_frame_goes_to_a_log_with_its_interface_and_two_devices_not_onto_one_bus(self):
        two = self.folder / "two.log"
        two.write_text("(1.000000) vcan0 123#11\n(1.000000) vcan1 123#22\n(1.001000) vcan0 123#33\n")
        self.replay(two, "--speed", 0, "--to", f"file:{self.again}")
        assert self.again.read_text() == "".join(line.replace("(1", "(0000000001") for line in two.read_text().splitlines(True))
        self.replay(two, "--channel", "vcan1", "--speed", 0, "--to", f"file:{self.again}")
        assert self.again.read_text() == "(0000000001.000000) vcan1 123#22\n"
        self.replay(two, "--to", "can:vcan0", code=1, says=[
            f"ifog: {two}: frames of one id come on 'vcan0' and on 'vcan1', as from two devices, expected --channel with one of them\n"])

    def check_it_loops_and_scales(self):
        for speed in (20, 0):
            self.replay(self.log, "--to", f"file:{self.again}", "--loop", 3, "--speed", speed)
            assert self.again.read_text() == 3 * self.log.read_text()

    def check_raw_bytes_are_sent_in_blocks(self):
        sent, again = self.folder / "gyro.bin", self.folder / "again.bin"
        sent.write_bytes(bytes(7 * n % 256 for n in range(1001)))
        self.replay(sent, "--block", 100, "--rate", 1000, "--to", f"file:{again}", says=["sent 11 blocks"])
        assert again.read_bytes() == sent.read_bytes()
        self.replay(sent, "--to", f"file:{again}", code=1, says=[
            f"ifog: {sent}: raw bytes carry no times, expected --block BYTES and --rate HZ, or --driver NAME\n"])

    def check_a_capture_is_encoded_and_bytes_are_cut_by_the_driver(self):
        """Rows become KVH frames of 40 bytes, which the driver cuts again at the end of each."""
        rows, sent, again = (self.folder / name for name in ("gyro.csv", "gyro.kvh", "again.kvh"))
        rows.write_text("time_s,rate_x_radps,rate_y_radps,rate_z_radps\n" + "".join(f"{n * 1e-3},{n * 1e-3},0,0\n" for n in range(50)))
        self.replay(rows, *KVH, "--to", f"file:{sent}")
        assert len(sent.read_bytes()) == 50 * 40 and sent.read_bytes().startswith(b"\xfe\x81\xff\x56")
        self.replay(sent, *KVH, "--to", f"file:{again}", says=["sent 50 blocks"])
        assert again.read_bytes() == sent.read_bytes()
        self.replay(rows, "--to", f"file:{again}", code=1)

    def check_an_interrupt_ends_it_with_the_report(self):
        """Of a replay without end that is the end; of another it is less than requested, a failure that says how much was sent."""
        for loops in (0, 20_000):
            with self.started("--to", f"file:{self.again}", "--json", self.report, "--loop", str(loops)) as player:
                while self.nameless(player) < 1000:
                    assert player.poll() is None, player.stdout.read()
                    time.sleep(0.005)
                player.send_signal(signal.SIGINT)
                said = player.communicate(timeout=60)[0]
            report = self.written()
            assert player.returncode == (1 if loops else 0) and report["interrupted"] and not report["failed"], said
            assert report["of"] == (2_000_000 if loops else None), report
            assert report["sent"] == len(self.again.read_text().splitlines()), report
            assert said.startswith(f"interrupted: sent {report['sent']} of 2000000 frames in ") == bool(loops), said

    def nameless(self, player):
        """Bytes of the largest file in this folder that the process has open and that has no name yet, because it is not complete."""
        sizes = [0]
        for each in os.scandir(f"/proc/{player.pid}/fd"):
            try:
                if os.readlink(each).startswith(str(self.folder)) and os.stat(each).st_nlink == 0:
                    sizes.append(os.stat(each).st_size)
            except FileNotFoundError:
                pass
        return max(sizes)

    def check_an_interrupted_wait_for_a_reader_is_said(self):
        with self.started("--to", f"fifo:{self.folder / 'unread'}") as player:
            said = player.stdout.readline()
            assert "waiting for a reader" in said, said
            while player.poll() is None:  # the first signal may have come before the wait
                player.send_signal(signal.SIGINT)
                time.sleep(0.05)
            said = player.stdout.read()
        # A second signal ends it by itself.
        assert player.returncode == -signal.SIGINT or player.returncode == 1 and "interrupted before anything was sent" in said, said

    def check_what_the_target_did_not_take_is_not_said_to_be_sent(self):
        self.replay(self.log, "--speed", 0, "--loop", 5, "--to", "file:/dev/full", "--json", self.report, code=1, says=["failed: sent 0 of 500 frames in "])
        report = self.written()
        assert (report["sent"], report["of"], report["failed"]) == (0, 500, True), report

    def check_a_reader_that_goes_away_is_a_failure_with_a_report(self):
        fifo = self.folder / "fifo"
        os.mkfifo(fifo)

        def read_a_line():
            with open(fifo, buffering=1) as file:
                file.readline()
        reader = threading.Thread(target=read_a_line)
        reader.start()
        self.replay(self.log, "--loop", 0, "--to", f"fifo:{fifo}", code=1, says=["fifo: the reader went away", "failed: sent ", "lateness p50"])
        reader.join()

    def check_wrong_use_is_two_and_what_cannot_be_sent_is_one(self):
        empty = self.folder / "empty.log"
        empty.write_text("")
        self.replay(self.log, "--to", "nowhere", code=2)
        self.replay(self.log, code=2)
        self.replay(self.log, "--to", f"file:{self.again}", "--speed", -1, code=2)
        self.replay(self.log, "--to", "serial:/dev/null", code=1, says=["ifog: /dev/null: CAN frames cannot go onto a serial line, expected bytes\n"])
        self.replay(empty, "--to", f"file:{self.again}", code=1, says=[f"ifog: {empty}: nothing in it to send\n"])


if __name__ == "__main__":
    sys.exit(main_of(Checks))

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A forger on the multicast group can neither prevent the adoption of a model nor simulate one: the commands ask the process that
has locked the state folder, through its socket, and detect another process there.

usage: forger.py BUILD

In its own network namespace. One line per check, `ok` or `FAILED`; `skipped` if not root.
"""
import json
import os
import shutil
import signal
import socket
import struct
import subprocess
import threading
import time

from place import NOBODY, PYTHON, main_of
from private_network import GROUP, PORT, group_socket


class Forger:
    """Repeats an old status much more often than the daemon sends its own; after an exchange of the model, with another model."""

    def __init__(self, packet, behind=None):
        self.going, self.packet, self.behind = True, packet, behind or packet
        self.thread = threading.Thread(target=self.send, daemon=True)
        self.thread.start()

    def send(self):
        out = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
        number = 0
        while self.going:
            number += 1
            packet = self.behind if os.path.exists("state/nose.model.toml") else self.packet
            out.sendto(packet[:4] + struct.pack(">I", number) + packet[8:], (GROUP, PORT))
            time.sleep(0.01)

    def stop(self):
        self.going = False
        self.thread.join()


def status_of(model):
    """A packet in which a sensor named nose runs with the model of this name."""
    with group_socket() as group:
        group.settimeout(20)
        for _ in range(2000):
            packet = group.recv(65536)
            if packet[8:].startswith(b"IFOG_NOSE_STATUS\0") and model.encode() in packet:
                return packet
    raise SystemExit("FAILED   no status with that model came")


def other_daemon(place, value):
    """Messages of another daemon with a sensor of the same name that already runs with this model; then the daemon is ended."""
    os.mkdir("other")
    with open("ifogd.toml") as file:
        text = file.read().replace('"state"', '"other"').replace('"gyro"', '"gyro2"')
    with open("other.toml", "w") as file:
        file.write(text)
    model, name = place.model(value)
    with open("other/nose.model.toml", "w") as file:
        file.write(model)
    os.mkfifo("gyro2")
    fifo = os.open("gyro2", os.O_RDWR)
    daemon = place.start("other.toml", "other.log")
    place.feed(fifo)
    packet = status_of(name["identity"])
    place.stop_feeding()
    daemon.terminate()
    daemon.wait(30)
    os.close(fifo)
    return packet


def vetoed(place, packet):
    """Claims that another model is in use."""
    place.run_daemon()
    place.await_(place.running, "the sensor to run")
    forger = Forger(packet)
    try:
        time.sleep(1.5)
        place.propose("2e-08")
        said = place.of("adopt", "nose", "--watch", "0", code=0)
        place.check("the daemon uses it" in said, "a status of another model does not keep adopt from it: " + said)
        said = place.of("revert", "nose", code=0)
        place.check("model none is in place again" in said and place.status()["sensors"][0]["model"] == "", "nor revert, and status says what the daemon does")
    finally:
        forger.stop()


def satisfied(place, packet, value):
    """Claims that the model is in use, while the daemon does not answer."""
    forger = Forger(status_of(""), packet)
    try:
        place.propose(value)
        place.daemon.send_signal(signal.SIGSTOP)
        done = subprocess.run([place.ifog, "adopt", "nose", "--watch", "0", "--config", "ifogd.toml"], capture_output=True, text=True, timeout=60, check=False)
        place.daemon.send_signal(signal.SIGCONT)
        said = done.stdout + done.stderr
        place.check(done.returncode == 1 and not os.path.exists("state/nose.model.toml"), "a daemon that does not answer has taken nothing, whoever says so: " + said.strip())
    finally:
        forger.stop()


def who_sits_there(place):
    """Another process, and another user, at the daemon's socket."""
    os.rename("state/ifogd.socket", "state/mine")
    fake = subprocess.Popen([PYTHON, "-c", "import socket, time\ns = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)\n"
                             "s.bind('state/ifogd.socket')\ns.listen()\nprint('there', flush=True)\ntime.sleep(60)"],
                            user=NOBODY, group=NOBODY, extra_groups=[], stdout=subprocess.PIPE)
    fake.stdout.readline()
    place.propose("2e-08")
    said = place.of("adopt", "nose", code=1)
    place.check(f"of process {fake.pid} of user {NOBODY}" in said and "\n" not in said, "another process at the socket is not asked: " + said)
    fake.kill()
    fake.wait()
    os.remove("state/ifogd.socket")
    os.symlink("/run/elsewhere", "state/ifogd.socket")
    said = place.of("adopt", "nose", code=1)
    place.check("is no socket" in said and "\n" not in said, "and a link is not followed: " + said)
    os.rename("state/mine", "state/ifogd.socket")
    # The daemon was stopped a moment ago; its sensor has no data until a second later.
    deadline = time.monotonic() + 20
    while place.status()["sensors"][0]["state"] != "running" and time.monotonic() < deadline:
        time.sleep(0.2)
    for group, told in ((NOBODY, True), (NOBODY - 1, False)):
        done = subprocess.run([place.ifog, "status", "--config", "ifogd.toml"], user=NOBODY - 1, group=group, extra_groups=[], capture_output=True, text=True,
                              check=False)
        place.check("ifogd runs" in done.stdout and ("running" in done.stdout) == told and ("cannot be asked" in done.stderr) != told,
                    f"a user {'of' if told else 'outside'} the folder's group is told {'all' if told else 'nothing: ' + done.stderr.strip()}")
    # A client that does not read does not block anything.
    deaf = []
    for _ in range(40):
        asking = socket.socket(socket.AF_UNIX, socket.SOCK_STREAM)
        asking.settimeout(5)
        try:
            asking.connect("state/ifogd.socket")
            for _ in range(100):
                asking.send(b"R")
        except OSError:
            pass
        deaf.append(asking)
    time.sleep(3)
    for asking in deaf:
        asking.close()
    place.await_(place.running, "the daemon to answer again")
    place.check(True, "forty who ask and never listen hold nothing up")


def forged(place):
    other = other_daemon(place, "5e-08")
    shutil.rmtree("other")
    os.remove("gyro2")
    wanted = other_daemon(place, "2e-08")
    vetoed(place, other)
    satisfied(place, wanted, "2e-08")
    who_sits_there(place)


def ended(place):
    place.stop()
    if place.failed:
        print(open("log").read()[-1500:])


if __name__ == "__main__":
    main_of(__doc__, forged, root_for="a forger of another user", after=ended)

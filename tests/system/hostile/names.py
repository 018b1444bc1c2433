#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""`ifog monitor` shows what anybody on the network may send: names are shown, never obeyed, and a message of another type is counted.

usage: names.py BUILD
"""
import os
import subprocess
import sys
import time

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "daemon"))
import process  # noqa: E402

SENSOR = b"IFOG_NO\x1b[31mSE,"
AXES_AT = 8 + 5 * 8 + 3 * 4  # in a rate_t, after the type's hash and the fields before


def check_names_from_the_network_are_shown_and_none_is_obeyed(daemon):
    listener = process.Listener()
    sample, health = listener.rate_t(), listener.status_t()
    sample.axes = health.axes = health.channels = 1
    for name in ("raw", "compensated", "denoised", "variance", "delta_theta", "covered", "angle", "innovation", "innovation_variance", "gain"):
        setattr(sample, name, [1.0])
    sample.model = "\x1b]52;c;aWZvZw==\x07"  # writes the terminal's clipboard
    health.nis_mean = health.whiteness = health.measurement_noise = [1.0]
    health.channel_name, health.channel_value, health.channel_age_s = ["temp\x1b[2J~31m\nX_degC"], [20.0], [0.1]
    health.allan_rate_radps = [[]]
    health.fault = "gone\r\x1b[1A"
    health.frames_read, health.frames_good, health.frames_format, health.frames_other = 60, 50, 7, 3
    health.samples_in, health.samples_published, health.samples_merged, health.kernel_drops = 50, 46, 2, 11
    health.lcm_failures = health.samples_waiting = health.channel_drops = 1
    good = sample.encode()
    assert good[AXES_AT] == 1
    # A number of axes that no vector can have, and a message that is cut off.
    messages = ((SENSOR, good), (SENSOR + b"_STATUS", health.encode().replace(b"~", b"\x9b")),
                (b"IFOG_BAD", good[:AXES_AT] + b"\xff" + good[AXES_AT + 1:]), (b"IFOG_BAD_STATUS", good[:5]))
    with open(daemon.path("said"), "wb") as said, subprocess.Popen([process.IFOG, "monitor", "--seconds", "3"], stdout=said, stderr=said) as monitor:
        for _ in range(60):
            for channel, message in messages:
                listener.send(channel, message)
            time.sleep(0.05)
    listener.socket.close()
    shown = daemon.path("said").read_bytes()
    assert monitor.returncode == 0, shown
    assert not [byte for byte in shown if byte != 0x0a and (byte < 0x20 or byte in (0x7f, 0x9b))], shown
    for part in ("NO\\x1b[31mSE,  ", "temp\\x1b[2J\\x9b31m\\nX_degC 20", "gone\\x0d\\x1b[1A", "kernel drops 11", "channel messages dropped 1",
                 "books: 60 CAN frames = 50 decoded + 7 refused + 3 not the sensor's; 50 samples = 46 published + 2 merged + 1 not sent + 1 waiting",
                 "model \\x1b]52", "messages that are none of ours"):
        assert part in shown.decode(), f"{part} is not in\n{shown.decode()}"


if __name__ == "__main__":
    process.main_of(globals())

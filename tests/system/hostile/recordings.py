#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A foreign recording names files of the computer on which it is read: none of them is opened, and the user must name missing ones.
Also links in a spool that lead to files that only the reader may read.

usage: recordings.py BUILD

One line per check, `ok` or `FAILED`.
"""
import json
import os
import shutil
import subprocess
import sys

sys.path.insert(0, os.path.join(os.path.dirname(os.path.abspath(__file__)), ".."))
import flight_file  # noqa: E402

from place import SECRET, URL, main_of  # noqa: E402

DBC = os.path.abspath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "../../../drivers/dbc/examples/ifogd_gyro.dbc"))
CONFIG = """[daemon]
lock_memory = false
state_folder = "state"
lcm_url = "%s"
[[sensor]]
name = "nose"
driver = "dbc"
model = "own.toml"
[sensor.transport]
type = "file"
path = "day.log"
format = "candump"
[sensor.options]
dbc = "gyro.dbc"
signal = "Rate_x"
counter = "Counter"
rate_hz = 100
environment = "temperature_degC=Temperature"
[sensor.filter]
process_noise = 1e-12
measurement_noise = 1e-10
[sensor.record]
folder = "record"
""" % URL


def record(place):
    """As written by the daemon."""
    shutil.copy(DBC, "gyro.dbc")
    with open("own.toml", "w") as file:
        file.write(place.model("2e-08")[0])
    with open("dbc.toml", "w") as file:
        file.write(CONFIG)
    with open("rates.csv", "w") as file:
        file.write("time_s,rate_radps,temperature_degC\n" + "".join(f"{i / 100},{1e-3 * (i % 5)},25\n" for i in range(2000)))
    place.ran("convert", "rates.csv", "day.log", "--driver", "dbc", "--option", "dbc=gyro.dbc", "--option", "signal=Rate_x", "--option", "counter=Counter",
              "--option", "rate_hz=100", "--option", "environment=temperature_degC=Temperature", code=0)
    subprocess.run([place.ifogd, "--config", "dbc.toml"], capture_output=True, timeout=60, check=True)
    (name,) = os.listdir("record/nose")
    return os.path.join("record/nose", name)


def changed(path, to, *edits):
    """The recording with another header."""
    with open(path, "rb") as file:
        content = file.read()

    def edit(text):
        lines = text.decode().split("\n")
        for take_out, put_in in edits:
            lines = [line for line in lines if not line.startswith(take_out)] + ([put_in] if put_in else [])
        return "\n".join(line for line in lines if line).encode() + b"\n"
    with open(to, "wb") as file:
        file.write(flight_file.with_header(content, edit))


def a_file_of_this_computer(place, recording):
    for name, text in (("secret.dbc", f'VERSION ""\nBO_ {SECRET} x\n'), ("secret.toml", f'version = 1\n[[effect]]\nform = "{SECRET}"\n')):
        with open(name, "w") as file:
            file.write(text)
    # An old recording, or one made to look old.
    whole = os.path.abspath("gyro.dbc")
    changed(recording, "old.ifr", (f"file.{whole}", ""))
    changed(recording, "foreign.ifr", (f"file.{whole}", ""), ("option.dbc", f"option.dbc={os.path.abspath('secret.dbc')}"))
    changed(recording, "model.ifr", (f"file.{os.path.abspath('own.toml')}", ""), ("configuration=", ""), ("configuration_file=", ""),
            ("none", "configuration_file=" + os.path.abspath("dbc.toml")),
            ("none", "configuration=" + CONFIG.split("[[sensor]]")[1].join(["[[sensor]]", ""]).replace("own.toml", "secret.toml").replace("\n", "\\n")))
    place.ran("denoise", recording, "--output", "whole.csv", code=0)
    for command in (("denoise", "--output", "x.csv"), ("allan",), ("convert", "x.csv")):
        for file in ("old.ifr", "foreign.ifr"):
            said = place.ran(command[0], file, *command[1:], code=1)
            place.check("does not carry the file of its driver's option dbc, expected --dbc FILE" in said and "\n" not in said and SECRET not in said,
                        f"{command[0]} of {file} opens no file that the recording names: {said}")
    place.ran("denoise", "old.ifr", "--dbc", "gyro.dbc", "--output", "named.csv", "--model", "own.toml", code=0)
    with open("whole.csv") as one, open("named.csv") as other:
        rows = [[line for line in file if not line.startswith("#")] for file in (one, other)]
    place.check(rows[0] == rows[1] and len(rows[0]) > 1000, "with the file that the user names it is read as it was")
    said = place.ran("denoise", "model.ifr", "--output", "x.csv", code=1)
    place.check("does not carry the model" in said and "\n" not in said and SECRET not in said, "nor a model: " + said)
    place.ran("denoise", "model.ifr", "--output", "x.csv", "--model", "own.toml", code=0)


def a_spool_with_links(place, recording):
    """Read with rights on the links' targets, also into the history and the night's bookmark."""
    shutil.copy(recording, "kept.ifr")
    os.symlink(os.path.abspath("secret.dbc"), "record/nose/000000000009-20260101T000000.000Z.ifr")
    said = place.ran("night", "--config", "dbc.toml") + place.ran("denoise", "record/nose", "--output", "x.csv") + place.ran("allan", "record/nose")
    place.check(SECRET not in said and "symbolic links" in said, "a link among recordings is not followed")
    shutil.move(recording, "gone.ifr")
    os.remove("record/nose/000000000009-20260101T000000.000Z.ifr")
    os.link("secret.dbc", "record/nose/000000000009-20260101T000000.000Z.ifr")
    said = place.ran("night", "--config", "dbc.toml") + place.ran("denoise", "record/nose", "--output", "x.csv")
    kept = "".join(open(os.path.join("state", name)).read() for name in os.listdir("state") if name.endswith("json"))
    place.check(SECRET not in said + kept and "one name" in said, "nor what has another name")
    os.remove("record/nose/000000000009-20260101T000000.000Z.ifr")
    # A header with arbitrary content, and the night's files.
    changed("gone.ifr", "record/nose/000000000010-20260101T000000.000Z.ifr", ("carries=", f"carries={SECRET}"))
    place.ran("night", "--config", "dbc.toml")
    kept = "".join(open(os.path.join("state", name)).read() for name in os.listdir("state") if name.endswith("json"))
    place.check(SECRET not in kept and "night.json" in "".join(os.listdir("state")), "the night keeps nothing of what a recording holds")
    os.remove("record/nose/000000000010-20260101T000000.000Z.ifr")
    # Missing parts of the header are taken from this computer's configuration.
    changed("gone.ifr", "record/nose/000000000011-20260101T000000.000Z.ifr", (f"file.{os.path.abspath('gyro.dbc')}", ""))
    said = place.ran("night", "--config", "dbc.toml")
    place.check("at rest for" in said, "an old recording in the spool is read by the configuration: " + said)


def recordings(place):
    recording = record(place)
    a_file_of_this_computer(place, recording)
    a_spool_with_links(place, recording)


if __name__ == "__main__":
    main_of(__doc__, recordings)

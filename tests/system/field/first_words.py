# SPDX-License-Identifier: Apache-2.0
"""Output of `status -c` compared with the JSON of the same sensor, and a night before the first recording is closed."""
import csv
import os


def table(field):
    return list(csv.DictReader(field.run("status", "-c", "--config", field.config).splitlines()))


def before_the_daemon(field):
    found = [(row["sensor"], row["heard"], row["state"], row["samples_published"]) for row in table(field)]
    field.check(found == [("nose", "false", "", "")], f"status as CSV says nothing that it does not know: {found}")
    os.makedirs(field.path("record/nose"))
    half = field.path("record/nose/000001-20260131T130509Z.ifr.open")
    with open(half, "wb") as file:
        file.truncate(5_000_000)
    field.check("closes at 16.0 MB or at 2026-01-31T13:05:12Z, which is over: does ifogd run?" in field.run("night", "--config", field.config),
                "a night says when the recording will be closed")
    os.remove(half)


def of_the_day(field, sensor):
    row, = table(field)
    field.check(row["sensor"] == "nose" and row["heard"] == row["balanced"] == "true" and row["state"] == sensor["state"]
                and int(row["samples_published"]) == sensor["books"]["samples_published"] and row["model"] == row["proposal"] == ""
                and row["model_since"] == (sensor["model_since"] or "") and all(int(row[name]) == n for name, n in sensor["losses"].items()),
                f"status as CSV: {row}")

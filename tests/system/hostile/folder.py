#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""A user who may write into the state folder cannot make root write outside of it or print a file that he may not read. Root against
the user nobody.

usage: folder.py BUILD

One line per check, `ok` or `FAILED`; `skipped` if not root. Exit 77 if nothing could be run.
"""
import os
import shutil
import subprocess

from place import NOBODY, PYTHON, SECRET, as_nobody, main_of


def content(path):
    with open(path) as file:
        return file.read()


def clear(place):
    for name in os.listdir("state"):
        os.remove(os.path.join("state", name))
    if os.path.exists("secret"):
        os.remove("secret")
    with open("secret", "w") as file:
        file.write(f'version = 1\n[[effect]]\nform = "{SECRET}"\n')
    os.chmod("secret", 0o600)
    place.check(as_nobody("cat", "secret").returncode != 0, "nobody cannot read what is root's")


def link(name, to="../secret"):
    done = as_nobody("ln", "-sf", to, os.path.join("state", name))
    assert done.returncode == 0, done.stderr


def adopting(place):
    """A model replaced by a link, for adopt and revert."""
    clear(place)
    name = place.propose("2e-08")
    link("nose.model.toml")
    said = place.of("adopt", "nose")
    place.check(SECRET in content("secret") and SECRET not in said, "adopt writes no model through a link: " + said)
    clear(place)
    place.propose("2e-08")
    place.of("adopt", "nose", code=0)
    place.check(place.model("2e-08")[0] == content("state/nose.model.toml"), "and adopts one where there is none")
    os.remove("state/nose.model.toml")
    link("nose.model.toml")
    said = place.of("revert", "nose")
    place.check(SECRET in content("secret") and SECRET not in said, "nor does revert: " + said)
    # With another model stored, which revert would write.
    clear(place)
    place.propose("2e-08")
    place.of("adopt", "nose", code=0)
    place.propose("3e-08", against=name)
    place.of("adopt", "nose", code=0)
    shutil.move("state/nose.model.toml", "kept")
    os.symlink(os.path.abspath("kept"), "state/nose.model.toml")
    os.chmod("kept", 0o600)
    before = content("kept")
    said = place.of("revert", "nose", code=1)
    place.check(content("kept") == before and "link" in said and "\n" not in said, "revert says that it is a link: " + said)


def reading(place):
    """Every file that is read there, as symbolic and hard link to a file that nobody may not read."""
    for how in ("link", "second name"):
        for name, commands in (("nose.proposal.json", ("proposals", "status", "adopt")), ("nose.history.json", ("status", "revert", "adopt")),
                               ("nose.model.toml", ("status", "proposals", "adopt")), ("nose.night.json", ("night",)),
                               ("nose.proposal-{}.toml", ("adopt",)), ("nose.kept-{}.toml", ("revert",)), ("nose.noise.toml", ("check",))):
            clear(place)
            first = place.propose("2e-08")
            if "kept" in name:
                place.of("adopt", "nose", code=0)
                place.propose("3e-08", against=first)
                place.of("adopt", "nose", code=0)
            name = name.format(first["identity"])
            if os.path.exists(os.path.join("state", name)):
                os.remove(os.path.join("state", name))
            if how == "link":
                link(name)
            else:
                os.link("secret", os.path.join("state", name))
            said = ""
            for command in commands:
                if command == "check":
                    done = subprocess.run([place.ifogd, "--check", "--config", "ifogd.toml"], capture_output=True, text=True, check=False)
                    said += done.stdout + done.stderr
                else:
                    said += place.of(command, *(["nose"] if command in ("adopt", "revert") else []))
            kept = "".join(content(os.path.join("state", each)) for each in os.listdir("state") if not os.path.samefile(os.path.join("state", each), "secret"))
            place.check(SECRET not in said and SECRET not in kept and SECRET in content("secret"), f"{name} as a {how}: nothing of it is shown or written")


def quoting(place):
    """Files with foreign content: the message gives their kind, not their content."""
    for name, text in (("nose.proposal.json", '{"schema": "%s"}'), ("nose.proposal.json", '{"schema": {"%s": 1}}'), ("nose.history.json", '{"schema": "%s"}'),
                       ("nose.history.json", "%s"), ("nose.model.toml", "%s = 1\n"), ("nose.model.toml", 'version = 1\n[[effect]]\nform = "%s"\n'),
                       ("nose.model.toml", 'version = "\\q%s"\n'), ("nose.noise.toml", 'version = "%s"\n')):
        clear(place)
        place.propose("2e-08")
        with open(os.path.join("state", name), "w") as file:
            file.write(text % SECRET)
        said = place.of("status") + place.of("proposals") + place.of("adopt", "nose") + place.of("revert", "nose")
        place.check(SECRET not in said, f"{name} with {text!r}: not quoted")


def deep(place):
    for name, text in (("nose.proposal.json", '{"schema":' + "\n[" * 1_000_000), ("nose.history.json", "[\n" * 1_000_000), ("nose.model.toml", "a" + ".a" * 50_000 + " = 1\n"),
                       ("nose.noise.toml", "a" + ".a" * 50_000 + " = 1\n"), ("nose.model.toml", "a = " + "[" * 100_000)):
        clear(place)
        place.propose("2e-08")
        with open(os.path.join("state", name), "w") as file:
            file.write(text)
        good = True
        for words in (("status",), ("proposals",), ("adopt", "nose"), ("revert", "nose")):
            done = subprocess.run([place.ifog, *words, "--config", "ifogd.toml"], capture_output=True, text=True, check=False, timeout=30)
            good = good and done.returncode in (0, 1)
        done = subprocess.run([place.ifogd, "--check", "--config", "ifogd.toml"], capture_output=True, text=True, check=False, timeout=30)
        place.check(good and done.returncode in (0, 2), f"{name} of {len(text)} bytes, deeper than any: every program ends with a line")


SWAPS = """
import os
for at in range(1 << 40):
    os.symlink("../mine", "state/x")
    os.rename("state/x", "state/nose.history.json")
    os.remove("state/nose.history.json")
    if at == 200:
        print("swapped", flush=True)
"""


def races(place):
    """A file that is exchanged with a link more than 200 times while root writes it."""
    clear(place)
    with open("mine", "w") as file:
        file.write("mine")
    # A lost race does not stop root.
    swapper = subprocess.Popen([PYTHON, "-c", SWAPS.replace("    os.", "    with __import__('contextlib').suppress(OSError): os.")],
                               user=NOBODY, group=NOBODY, extra_groups=[], stdout=subprocess.PIPE)
    swapped = swapper.stdout.readline()
    for _ in range(20):
        place.propose("2e-08")
        place.of("adopt", "nose")
        place.of("revert", "nose")
    swapper.kill()
    swapper.wait()
    place.check(swapped == b"swapped\n" and content("mine") == "mine", "the history is swapped with a link while it is written: what that leads to is as it was")


if __name__ == "__main__":
    main_of(__doc__, adopting, reading, quoting, deep, races, root_for="root against another user")

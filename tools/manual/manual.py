#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The manual pages, made from what the programs themselves say and from the pages of the tree.

usage: manual.py SOURCE_DIR OUTPUT_DIR COMMAND_LINE.json DRIVERS.json 'DRIVER;DRIVER;...' IFOGD_HELP VERSION

Options come from `ifog --describe`, `ifog drivers --json` and `ifogd --help`; keys from the reference configuration and the
reference model; states, faults, formats from the maps of the folders. pages/*.md hold the rest, and name where each belongs:

  @options                 the options of the page's program
  @commands                every command of ifog with its page
  @drivers                 every driver with its options
  @reference FILE          the keys of a commented TOML file
  @section FILE HEADING    what stands under that heading in a Markdown file
  @page FILE               a whole Markdown file without its title
A new command needs nothing here: its page is made of its options, its examples, its row in README.md and its part of
tools/README.md, where it has them.
"""
import gzip
import json
import pathlib
import re
import sys
import time

import reference
import roff

VOLUMES = {"1": "User commands", "5": "File formats", "8": "System administration"}


def changelog_date(source):
    """Of the newest entry of the package's changelog: the same pages from the same tree, whenever they are made."""
    stamp = re.search(r"^ -- .*>  (.*)$", (source / "systemd/debian/changelog").read_text(), re.M).group(1)
    return time.strftime("%Y-%m-%d", time.strptime(stamp[:25].strip(), "%a, %d %b %Y %H:%M:%S"))


def capital(text):
    """As a sentence begins; of a unit (µs) no capital is made."""
    return text[:1].upper() + text[1:] if text[:1].isascii() else text


def section(text, heading):
    """What stands under a heading, to the next one of its level or above."""
    found = re.search(rf"^(#+) {re.escape(heading)}\n(.*?)(?=^#{{1,6}} |\Z)", text, re.M | re.S)
    if not found:
        raise SystemExit(f"no heading '{heading}'")
    return less_of_the_source(found.group(2))


def less_of_the_source(text):
    """Who reads an installed page has no source to look into: neither (`health/step_test.h`) nor (see [tests](../tests/x))."""
    named = r"[^()]*`[\w./]+\.(?:h|cpp|py)`[^()]*"
    linked = r"[^()]*\]\((?!http)[\w./#-]*\)[^()]*"
    return re.sub(rf"\s*\((?:{linked}|{named})\)", "", text)


def option_lines(options):
    """Each as a tagged paragraph, with what --help says of it, in its order."""
    out, group = [], ""
    for option in options:
        if not option["positional"] and option["group"] not in ("Options", group):
            group = option["group"]
            out.append(f'.SS "{roff.inline(group)}"')
        value = option["value"]
        name = option["positional"] or ", ".join(option["names"])
        term = f"`{name}`" + (f" *{value}*" if value and not option["positional"] else "") + (" ..." if option["repeats"] else "")
        remarks = ["required"] if option["required"] else []
        if option["default"]:
            remarks.append(f"default {option['default']}")
        text = option["help"] + (f" ({', '.join(remarks)})" if remarks else "")
        out += roff.tagged(term, capital(text))
    return out


def options_of_help(text):
    """The options of a program that says them only to people: `ifogd --help`."""
    found = []
    for line in text.split("Options:")[1].splitlines():
        match = re.match(r"  (-\S+)(?: (\S+))?(?: REQUIRED)? {2,}(.*)$", line)
        if match:
            found.append({"names": match.group(1).split(","), "positional": "", "value": match.group(2) or "", "choices": [], "default": "",
                          "required": " REQUIRED" in line, "repeats": False, "group": "Options", "help": match.group(3)})
        elif line.strip():
            found[-1]["help"] += " " + line.strip()
    return found


def synopsis(program, options):
    words = [f"\\fB{roff.exact(program)}\\fR", "[\\fIOPTIONS\\fR]"]
    for option in options:
        if option["required"] and not option["positional"]:
            words.append(f"\\fB{roff.exact(option['names'][-1])}\\fR \\fI{roff.escaped(option['value'])}\\fR")
    for option in options:
        if option["positional"]:
            word = f"\\fI{option['positional']}\\fR" + (" ..." if option["repeats"] else "")
            words.append(word if option["required"] else f"[{word}]")
    return [" ".join(words)]


def command_examples(text, name):
    """The parts of tools/README.md that run the command, in the folders of who has installed it: (what for, lines)."""
    out, setting = [], {}
    for found in re.finditer(r"((?:^[^\n`#|][^\n]*\n|^`[^`]+`[^\n]*\n)+)\n^```sh\n(.*?)^```$", text, re.M | re.S):
        logical = found.group(2).replace("\\\n", "\0").splitlines()
        # What is further in is of a loop, and says little by itself.
        wanted = [line for line in logical if re.search(rf"^\S.*\$ifog {name}\b|^\$ifog {name}\b", line)]
        setting |= {m.group(1): m.group(2) for m in (re.match(r'(\w+)="(.*)"$', line) for line in logical) if m}
        lines = []
        for line in wanted:
            for variable, value in setting.items():
                line = line.replace("$" + variable, value)
            line = re.sub(r" &$", "", line).replace("$ifog", "ifog").replace("build/example/", "")
            for here, installed in (("tools/simulate/scenarios/", "scenarios/"), ("drivers/dbc/examples/", "dbc/")):
                line = line.replace(here, "/usr/share/ifogd/" + installed)
            lines += line.replace("\0", "\\\n").split("\n")
        if lines:
            what = re.sub(r" See \[[^\]]*\]\([^)]*\)\.", "", " ".join(found.group(1).split()))
            out.append((less_of_the_source(what), lines))
    return out


class Manual:
    def __init__(self, source, version, commands, drivers, ifogd_options):
        self.source, self.commands, self.drivers, self.ifogd_options = source, commands, drivers, ifogd_options
        self.date, self.version = changelog_date(source), "ifogd " + version

    def page(self, title, number):
        return roff.Page(title, number, self.date, self.version, VOLUMES[number])

    def file(self, path):
        return (self.source / path).read_text()

    def directive(self, page, words):
        kind = words[0]
        if kind == "@options":
            page.add(option_lines(self.ifogd_options if words[1] == "ifogd" else self.commands["options"]))
        elif kind == "@commands":
            for command in self.commands["commands"]:
                page.add(roff.tagged(f"`ifog {command['name']}`", command["help"][:1].upper() + command["help"][1:] + f"; **ifog-{command['name']}**(1)"))
        elif kind == "@drivers":
            for driver in self.drivers:
                page.subheading(f"{driver['name']}: {driver['summary']}")
                for option in driver["options"]:
                    standard = {None: "must be given", "": "default none"}.get(option["default"], f"default {option['default']}")
                    page.add(roff.tagged(f"`{option['key']}`", f"{option['help']}; {option['values']}; {standard}"))
        elif kind == "@reference":
            page.add(reference.lines(self.file(words[1])))
        elif kind == "@section":
            page.markdown(section(self.file(words[1]), " ".join(words[2:])), demote=1)
        elif kind == "@page":
            page.markdown(less_of_the_source(re.sub(r"\A# .*\n", "", self.file(words[1]))), demote=1)
        else:
            raise SystemExit(f"'{kind}' is no directive of a manual page")

    def written(self, path):
        """A page of pages/: Markdown with directives in lines of their own."""
        title, number = path.stem.rsplit(".", 1)
        page = self.page(title, number)
        for part in re.split(r"^(@.*)$", path.read_text(), flags=re.M):
            if part.startswith("@"):
                self.directive(page, part.split())
            else:
                page.markdown(part)
        return page.text()

    def command(self, command):
        name, options = command["name"], command["options"]
        page = self.page("ifog-" + name, "1")
        page.heading("Name")
        page.add([f"ifog\\-{name} \\- {roff.inline(command['help'][:1].lower() + command['help'][1:])}"])
        page.heading("Synopsis")
        page.add(synopsis("ifog " + name, options))
        page.heading("Description")
        row = re.search(rf"^\| `ifog {name}[^`]*` \| (.*) \|$", self.file("README.md"), re.M)
        said = row.group(1) if row else command["help"]
        page.markdown(capital(said) + ".")
        page.markdown("What holds for all commands (captures, outputs, `-`, exit status) is in **ifog**(1).")
        for title, chosen in (("Arguments", [o for o in options if o["positional"]]), ("Options", [o for o in options if not o["positional"]])):
            if chosen:
                page.heading(title)
                page.add(option_lines(chosen))
        examples = command_examples(self.file("tools/README.md"), name)
        footer = command["examples"].strip().splitlines()
        if examples or footer:
            page.heading("Examples")
            for what, lines in examples:
                what = re.sub(r"^`\w+`: ", "", what)
                page.markdown(capital(what))
                page.add(roff.code(lines))
            if footer:
                page.add(roff.code([line.removeprefix("  ") for line in footer if line not in ("Examples:", "Example:")]))
        if any("--json" in option["names"] for option in options):
            page.heading("Files")
            page.markdown(f"What `--json` writes is described by the JSON schemas in `/usr/share/ifogd/schemas`.")
        page.heading("See also")
        page.markdown("**ifog**(1), **ifogd**(8), **ifog-capture**(5), **ifog-model**(5), **ifog-scenario**(5)")
        return page.text()


def write(folder, name, text):
    """Packed as Debian wants it, with no time in it."""
    (folder / (name + ".gz")).write_bytes(gzip.compress(text.encode(), 9, mtime=0))


def main():
    source, folder, commands, drivers, installed, ifogd_help, version = sys.argv[1:]
    source, folder = pathlib.Path(source), pathlib.Path(folder)
    all_drivers = json.loads(pathlib.Path(drivers).read_text())["drivers"]
    manual = Manual(source, version, json.loads(pathlib.Path(commands).read_text()),
                    [driver for driver in all_drivers if driver["name"] in installed.split(";")], options_of_help(pathlib.Path(ifogd_help).read_text()))
    for kind in "158":
        (folder / f"man{kind}").mkdir(parents=True, exist_ok=True)
        for old in (folder / f"man{kind}").iterdir():  # a command that went takes its page along
            old.unlink()
    for path in sorted((source / "tools/manual/pages").glob("*.md")):
        write(folder / f"man{path.stem[-1]}", path.stem, manual.written(path))
    for command in manual.commands["commands"]:
        write(folder / "man1", f"ifog-{command['name']}.1", manual.command(command))


if __name__ == "__main__":
    main()

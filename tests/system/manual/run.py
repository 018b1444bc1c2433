#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The manual compared with the programs and read by `man` and `mandoc`, and the shell completion.

usage: run.py PATH_OF_IFOG PATH_OF_IFOGD SOURCE_DIR MANUAL_DIR

Expected content comes from `--help`, `ifog drivers` and the sources, not from the input of the pages. Exit 77 if mandoc, man or
bash-completion is missing.
"""
import gzip
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import each_check  # noqa: E402

IFOG, IFOGD = map(os.path.abspath, sys.argv[1:3])
SOURCE, MANUAL = (pathlib.Path(argument).resolve() for argument in sys.argv[3:])
COMPLETION = "/usr/share/bash-completion/bash_completion"


def said(*command):
    result = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
    assert result.returncode == 0, f"{command}: exit {result.returncode}: {result.stderr}"
    return result.stdout


def page(name):
    """As read by a person, in one line, with hyphenated words joined."""
    text = subprocess.run(["man", "-l", str(MANUAL / f"man{name[-1]}" / (name + ".gz"))], capture_output=True, text=True, timeout=60,
                          check=True, env={**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "1000", "MANPAGER": "cat", "MANROFFOPT": "-rHY=0"}).stdout
    return " ".join(text.split())


def options_of_help(*program):
    return {name for names in re.findall(r"^  (-\S+)", said(*program, "--help"), re.M) for name in names.split(",")}


def commands():
    return re.findall(r"^  (\w+) ", said(IFOG, "--help").split("Subcommands:")[1], re.M)


def holds(text, words, what):
    missing = sorted(word for word in words if not re.search(r"(?<![\w-])" + re.escape(word) + r"(?![\w-])", text))
    assert not missing, f"{what} lacks {missing}"


class Checks:
    def check_every_page_is_clean(self):
        pages = sorted(MANUAL.glob("man?/*.gz"))
        assert len(pages) >= 5 + len(commands()), f"{len(pages)} pages"
        for path in pages:
            lint = subprocess.run(["mandoc", "-T", "lint", "-W", "warning", str(path)], capture_output=True, text=True, check=False)
            assert not lint.stdout + lint.stderr, lint.stdout + lint.stderr
            groff = subprocess.run(["man", "--warnings", "-E", "UTF-8", "-l", "-Tutf8", "-Z", str(path)], capture_output=True, text=True, check=False,
                                   env={**os.environ, "LC_ALL": "C.UTF-8", "MANWIDTH": "80"})
            assert groff.returncode == 0 and not groff.stderr, f"{path.name}: {groff.stderr}"
            assert gzip.decompress(path.read_bytes()).count(b"\n") > 20, path
            # Entries of apropos(1) and whatis(1).
            known = subprocess.run(["lexgrog", "-m", str(path)], capture_output=True, text=True, check=False)
            assert known.returncode == 0 and path.name.split(".")[0] in known.stdout, f"{path.name}: {known.stdout}{known.stderr}"

    def check_options_are_told_in_plain_words(self):
        """No type of a programming language and no name of a check in help, manual and completion."""
        foreign = re.compile(r"\b(TEXT|FLOAT|UINT|INT|BOOLEAN|NONNEGATIVE|POSITIVE)\b|:\{|:FILE\b| in \[")
        for command in [[], *([name] for name in commands())]:
            found = foreign.search(said(IFOG, *command, "--help"))
            assert not found, f"ifog {' '.join(command)} --help: {found}"
        for path in sorted(MANUAL.glob("man?/ifog*.gz")):
            found = re.search(r"\b(TEXT|FLOAT|UINT|NONNEGATIVE)\b", gzip.decompress(path.read_bytes()).decode())
            assert not found, f"{path.name}: {found}"

    def check_each_command_has_its_page_with_its_options(self):
        for command in commands():
            options = options_of_help(IFOG, command)
            assert "--help" in options, options
            holds(page(f"ifog-{command}.1"), options, f"ifog-{command}(1)")
            holds(page("ifog.1"), [f"ifog {command}", f"ifog-{command}(1)"], "ifog(1)")
        listed = {path.name for path in (MANUAL / "man1").iterdir()}
        assert listed == {"ifog.1.gz"} | {f"ifog-{command}.1.gz" for command in commands()}, listed

    def check_what_help_says_is_in_the_page(self):
        """Each option's text, not only its name."""
        for command in ("allan", "denoise", "replay"):
            text = page(f"ifog-{command}.1").lower()
            told = re.findall(r"^  -\S+.*?(?: {2,}|\n {20,})(\S.*)$", said(IFOG, command, "--help"), re.M)
            assert len(told) > 8, told
            for words in told:
                assert " ".join(words.lower().split()) in text, f"ifog-{command}(1) lacks '{words}'"

    def check_what_is_told_is_of_an_installed_program(self):
        """No paths of the sources and no variables of a script; files that are read are installed or made by an example."""
        for path in sorted(MANUAL.glob("man?/*.gz")):
            text = page(path.name.removesuffix(".gz"))
            found = re.search(r"\w+/\w+\.(?:h|cpp|py|md)\b|\btests/|tools/|drivers/|\.\./", text)
            assert not found, f"{path.name}: {found.group(0)} in '{text[max(0, found.start() - 60):found.end() + 40]}'"
        for command in commands():
            examples = re.findall(r"^\.EX\n(.*?)^\.EE", gzip.decompress((MANUAL / f"man1/ifog-{command}.1.gz").read_bytes()).decode(), re.M | re.S)
            for line in "\n".join(examples).splitlines():
                assert "$" not in line, f"ifog-{command}(1): {line}"
                for kind, name in re.findall(r"/usr/share/ifogd/(scenarios|dbc)/(\S+)", line.replace("\\", "")):
                    assert (SOURCE / {"scenarios": "tools/simulate/scenarios", "dbc": "drivers/dbc/examples"}[kind] / name).exists(), line

    def check_examples_run_as_they_are_printed(self):
        """Of ifog-simulate(1), in an empty folder; installed files are taken from the sources."""
        lines = gzip.decompress((MANUAL / "man1/ifog-simulate.1.gz").read_bytes()).decode().split('.SH "EXAMPLES"')[1].split(".SH")[0]
        printed = [re.sub(r"\\[&-]", lambda each: each.group()[1].replace("&", ""), line) for line in lines.splitlines()]
        wanted = [line for line in printed if line.startswith("ifog simulate ")]
        assert len(wanted) > 2, printed
        with tempfile.TemporaryDirectory() as folder:
            for line in wanted:
                here = line.replace("/usr/share/ifogd/scenarios/", f"{SOURCE}/tools/simulate/scenarios/").replace("ifog ", IFOG + " ", 1)
                assert here != line and "$" not in line, line
                result = subprocess.run(["sh", "-c", here], cwd=folder, capture_output=True, text=True, timeout=120, check=False)
                assert result.returncode == 0, f"{line}: {result.stderr}"
        for path in MANUAL.glob("man1/*.gz"):
            assert "thousand nodes." not in gzip.decompress(path.read_bytes()).decode(), path

    def check_the_daemon(self):
        holds(page("ifogd.8"), options_of_help(IFOGD), "ifogd(8)")
        # States and faults are described in daemon/README.md; samples from there.
        holds(page("ifogd.8"), ["device gone", "SIGHUP", "buffer_bytes", "noise.toml"], "ifogd(8)")

    def check_the_configuration_has_every_key_that_is_read(self):
        sources = "".join(path.read_text() for path in sorted((SOURCE / "daemon/config").glob("*.cpp")))
        read = set(re.findall(r'\bin\.\w+\(\s*"([a-z_0-9]+)"', sources))
        read |= set(re.findall(r'FilterSetting\{\s*"(\w+)"', (SOURCE / "filters/settings/filter_table.cpp").read_text()))
        assert len(read) > 60, len(read)
        text = page("ifogd.toml.5")
        holds(text, [key + " =" for key in read if f"{key} = " not in text and f".{key}]" not in text and f"[{key}]" not in text], "ifogd.toml(5)")

    def check_the_drivers_options(self):
        text = page("ifogd.toml.5")
        for driver in ("kvh1750", "dsp3000", "dbc"):
            told = said(IFOG, "drivers", driver)
            options = re.findall(r"^    ([a-z_0-9]+)  ", told, re.M)
            assert options and driver in text, told
            holds(text.split(driver + ":")[1], options, f"{driver} in ifogd.toml(5)")

    def check_formats(self):
        capture, model = page("ifog-capture.5"), page("ifog-model.5")
        holds(capture, ["time_s", "rate_x_radps", "RFC 1950", "opened_ns"], "ifog-capture(5)")
        read = set(re.findall(r'\.(?:words|number|required|numbers|yes|not_negative|number_or_unknown|tables)\("(\w+)"',
                              (SOURCE / "filters/model_file/model_read.cpp").read_text()))
        assert len(read) > 25, read
        holds(model, read | {"second_rate", "band_power"}, "ifog-model(5)")

    def check_scenarios(self):
        """Every key of the reader, and every kind, key and list of the parts."""
        text = page("ifog-scenario.5")
        parts = (SOURCE / "tools/simulate/recipe.cpp").read_text().split("complete_numbers")[0]
        reader = (SOURCE / "tools/simulate/scenario.cpp").read_text()
        words = set(re.findall(r'[{(]"(\w+)"', parts)) | set(re.findall(r'\bkey == "(\w+)"', reader)) | set(re.findall(r'local == "(\w+)"', reader))
        assert len(words) > 80, words
        holds(text, words, "ifog-scenario(5)")

    def typed(self, *words):
        """The completions of the last word."""
        script = f"""source {COMPLETION}; source {MANUAL}/completion/ifog; source {MANUAL}/completion/ifogd
          COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); COMP_LINE="$*"; COMP_POINT=${{#COMP_LINE}}; COMP_TYPE=9
          compopt() {{ :; }}
          _$(basename "$1"); printf '%s\\n' "${{COMPREPLY[@]}}" """
        # A separate name for the program, so that drivers are listed by the built one.
        link = MANUAL / "completion" / "path"
        link.mkdir(exist_ok=True)
        for name, program in (("ifog", IFOG), ("ifogd", IFOGD)):
            (link / name).unlink(missing_ok=True)
            (link / name).symlink_to(program)
        result = subprocess.run(["bash", "-c", script, "bash", *words], capture_output=True, text=True, timeout=60, check=False, cwd=SOURCE / "daemon/examples",
                                env={**os.environ, "PATH": f"{link}:{os.environ['PATH']}"})
        assert not result.stderr, f"{words}: {result.stderr}"
        return {word.strip() for word in result.stdout.split("\n") if word.strip()}

    def check_completion(self):
        for words, offered in (
                (["ifog", "al"], {"allan"}), (["ifog", "allan", "--estimator", ""], {"overlapping", "modified", "hadamard"}),
                (["ifog", "denoise", "--filter", "ir"], {"irwe-akfg"}), (["ifog", "compare", "--state", "gauss"], {"gauss-markov"}),
                (["ifog", "allan", "--tau", ""], set()),
                (["ifog", "allan", "--driver", "kv"], {"kvh1750"}), (["ifog", "drivers", "kv"], {"kvh1750"}),
                (["ifog", "convert", "--driver", "kvh1750", "--option", "ra"], {"rate_hz="}),
                (["ifog", "convert", "--dbc", "x.dbc", "--option", "signa"], {"signal="}),
                (["ifog", "denoise", "--config", "reference.toml", "--sensor", ""], {"nose"}),
                (["ifog", "denoise", "--config", "kvh1"], {"kvh1750-serial.toml"}), (["ifog", "allan", "net"], {"network.toml"}),
                (["ifogd", "--c"], {"--config", "--check"}), (["ifogd", "--config", "ne"], {"network.toml"})):
            found = self.typed(*words)
            assert found == offered, f"{' '.join(words)}: {found}, expected {offered}"
        assert self.typed("ifog", "") >= set(commands())
        for command in commands():
            assert self.typed("ifog", command, "-") == options_of_help(IFOG, command), command


    def check_other_shells(self):
        """fish completes a line itself; for zsh the syntax and the presence of each command and option."""
        if not shutil.which("fish") or not shutil.which("zsh"):
            print("skipped  other shells: no fish or zsh; tools/install-packages test installs them")
            return
        folder = MANUAL / "completion"
        for line, offered in (("ifog al", {"allan"}), ("ifog denoise --filter ir", {"irwe-akfg"}), ("ifog allan --estimator ", {"overlapping", "modified", "hadamard"}),
                              ("ifog allan --driver kv", {"kvh1750"})):
            told = subprocess.run(["fish", "-c", f"source {folder}/ifog.fish; complete -C '{line}'"], capture_output=True, text=True, timeout=60, check=True,
                                  env={**os.environ, "PATH": f"{folder}/path:{os.environ['PATH']}"}).stdout
            found = {row.split("\t")[0] for row in told.splitlines()}
            assert found == offered, f"{line}: {found}, expected {offered}"
        said("zsh", "-n", str(folder / "_ifog"))
        text = (folder / "_ifog").read_text()
        for command in commands():
            row = next(row for row in text.splitlines() if row.strip().startswith(command + ")"))
            assert all(option in row for option in options_of_help(IFOG, command)), command


def main():
    missing = [name for name in ("mandoc", "man", "lexgrog") if not shutil.which(name)]
    if missing or not os.path.exists(COMPLETION):
        print(f"no {', '.join(missing) or 'bash-completion'} here; tools/install-packages test installs them")
        return 77
    return 1 if each_check.failures_of(Checks()) else 0


if __name__ == "__main__":
    sys.exit(main())

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Generates the completion of `ifog` and `ifogd` for bash, zsh and fish from their own descriptions.

usage: completion.py OUTPUT_DIR COMMAND_LINE.json IFOGD_HELP

Commands, options and choices are fixed here; drivers, their options and the sensors' names are read from the installed programs
and the configuration at run time. Everything else completes to files.
"""
import json
import pathlib
import re
import sys

BASH = r"""# Completion of ifog, made in the build from its own options; see tools/manual. Do not edit.

# The drivers that are installed, one a line.
_ifog_drivers() {
  "$1" drivers 2>/dev/null | sed -n 's/^\([A-Za-z0-9_]\{1,\}\) [^ ]\{1,\}: .*/\1/p'
}
# The options of a driver, with the = that follows.
_ifog_driver_options() {
  "$1" drivers "$2" 2>/dev/null | sed -n 's/^    \([a-z0-9_]\{1,\}\)  .*/\1=/p'
}
# The names in a configuration: of [[sensor]], not of its channels.
_ifog_sensors() {
  awk '/^ *\[/ { sensor = /^\[\[sensor\]\]/ } sensor && /^ *name *=/ { split($0, part, "\""); print part[2] }' "$1" 2>/dev/null
}

_ifog() {
  local cur prev words cword
  _init_completion -n =: || return
  local command=${words[1]} i driver='' configuration=@CONFIGURATION@
  COMPREPLY=()
  if [ "$cword" -eq 1 ]; then
    COMPREPLY=($(compgen -W "@COMMANDS@ @GLOBAL@" -- "$cur"))
    return
  fi
  for ((i = 2; i < cword; ++i)); do
    case ${words[i - 1]} in
      --driver) driver=${words[i]} ;;
      --dbc) driver=${driver:-dbc} ;;
      --config) configuration=${words[i]} ;;
    esac
  done
  case "$command $prev" in
@CHOICES@
    *' --driver') COMPREPLY=($(compgen -W "$(_ifog_drivers "${words[0]}")" -- "$cur")); return ;;
    *' --sensor') COMPREPLY=($(compgen -W "$(_ifog_sensors "$configuration")" -- "$cur")); return ;;
    *' --option')
      [ -n "$driver" ] || return
      compopt -o nospace
      COMPREPLY=($(compgen -W "$(_ifog_driver_options "${words[0]}" "$driver")" -- "$cur"))
      return
      ;;
@VALUES@
  esac
  case "$cur" in
    -*)
      case "$command" in
@OPTIONS@
      esac
      ;;
    *)
      case "$command" in
        drivers) COMPREPLY=($(compgen -W "$(_ifog_drivers "${words[0]}")" -- "$cur")) ;;
        @OF_SENSOR@) COMPREPLY=($(compgen -W "$(_ifog_sensors "$configuration")" -- "$cur")) ;;
        *) _filedir ;;
      esac
      ;;
  esac
}
complete -F _ifog ifog
"""

IFOGD = r"""# Completion of ifogd, made in the build from its own options; see tools/manual. Do not edit.
_ifogd() {
  local cur prev words cword
  _init_completion || return
  case "$prev" in
    --config) _filedir toml ;;
    *) COMPREPLY=($(compgen -W "@OPTIONS@" -- "$cur")) ;;
  esac
}
complete -F _ifogd ifogd
"""

ZSH = r"""#compdef ifog
# Completion of ifog, made in the build from its own options; see tools/manual. Do not edit.

_ifog_drivers() { ifog drivers 2>/dev/null | sed -n 's/^\([A-Za-z0-9_]\{1,\}\) [^ ]\{1,\}: .*/\1/p' }
_ifog_sensors() {
  awk '/^ *\[/ { sensor = /^\[\[sensor\]\]/ } sensor && /^ *name *=/ { split($0, part, "\""); print part[2] }' @CONFIGURATION@ 2>/dev/null
}

_ifog() {
  local -a commands=(
@ROWS@
  )
  if (( CURRENT == 2 )); then
    _describe command commands
    return
  fi
  local command=${words[2]}
  words=("${words[@]:1}")
  (( CURRENT-- ))
  case $command in
@CASES@
  esac
}
_ifog "$@"
"""

CONFIGURATION = "/etc/ifogd/ifogd.toml"


def names(options):
    return " ".join(name for option in options for name in option["names"])


def words_of(option):
    """The choices of an option, from its description or its help ("adaptation rule: ckf, irwe-akfg, … or vb")."""
    if option["choices"] or not {"--filter", "--state", "--weights", "--wideband"} & set(option["names"]):
        return option["choices"]
    listed = option["help"].split(";")[-1 if "expected" in option["help"] else 0].split(":")[-1].split(", or a ")[0]
    return [word for word in re.split(r", | or ", listed.strip()) if re.fullmatch(r"[a-z][a-z0-9-]*(\([pq,]+\))?", word)]


def is_file(option):
    return option["value"] == "FILE" or option["value"].endswith("FOLDER")


ASKED = {"--driver", "--sensor", "--option"}  # from the installed programs and the configuration


def bash(line):
    choices, values, words, sensors = [], [], [], []
    for command in line["commands"]:
        name, options = command["name"], command["options"]
        words.append(f'        {name}) COMPREPLY=($(compgen -W "{names(options)}" -- "$cur")) ;;')
        sensors += [name for option in options if option["positional"] == "sensor"]
        for option in options:
            patterns = " | ".join(f"'{name} {each}'" for each in option["names"] if each not in ASKED)
            if not patterns or option["positional"] or not option["value"]:
                continue
            if words_of(option):
                quoted = " ".join(words_of(option)).replace("(", "\\(").replace(")", "\\)")
                choices.append(f'    {patterns}) COMPREPLY=($(compgen -W "{quoted}" -- "$cur")); return ;;')
            else:
                values.append(f"    {patterns}) {'_filedir; ' if is_file(option) else ''}return ;;")
    text = BASH.replace("@CHOICES@", "\n".join(choices)).replace("@VALUES@", "\n".join(values)).replace("@OPTIONS@", "\n".join(words))
    return text.replace("@COMMANDS@", " ".join(command["name"] for command in line["commands"])).replace(
        "@GLOBAL@", names(line["options"])).replace("@CONFIGURATION@", CONFIGURATION).replace("@OF_SENSOR@", " | ".join(sensors))


def quoted(text):
    return "'" + text.replace("'", "") + "'"


def of_zsh(option):
    """One specification of _arguments."""
    help_text = re.sub(r"[\[\]:']", " ", option["help"])
    if option["positional"]:
        return quoted("*:" + help_text + (":_files" if option["value"] == "FILE" else ":$(_ifog_sensors)" if option["positional"] == "sensor" else ": "))
    value = ""
    if option["value"]:
        name = option["names"][-1]
        asked = {"--driver": "_ifog_drivers", "--sensor": "_ifog_sensors"}.get(name)
        known = "(" + " ".join(words_of(option)).replace("(", r"\(").replace(")", r"\)") + ")" if words_of(option) else ""
        value = ":" + option["value"].lower().replace(":", " ").replace("[", "").replace("]", "") + ":" + (
            known or (f"(${{(f)\"$({asked})\"}})" if asked else "_files" if is_file(option) else " "))
    shown = option["names"][-1] if len(option["names"]) == 1 else "{" + ",".join(option["names"]) + "}"
    if shown.startswith("{"):
        return shown + quoted(f"[{help_text}]{value}")
    return quoted(f"{'*' if option['repeats'] else ''}{shown}[{help_text}]{value}")


def zsh(line):
    rows = "\n".join(f"    {quoted(c['name'] + ':' + c['help'].replace(':', ' '))}" for c in line["commands"])
    cases = "\n".join(f"    {c['name']}) _arguments " + " ".join(of_zsh(o) for o in c["options"]) + " ;;" for c in line["commands"])
    return ZSH.replace("@ROWS@", rows).replace("@CASES@", cases).replace("@CONFIGURATION@", CONFIGURATION)


def fish(line):
    out = ["# Completion of ifog, made in the build from its own options; see tools/manual. Do not edit.",
           f"function __ifog_sensors; awk '/^ *\\[/ {{ sensor = /^\\[\\[sensor\\]\\]/ }} sensor && /^ *name *=/ {{ split($0, part, \"\\\"\"); print part[2] }}' {CONFIGURATION} 2>/dev/null; end",
           "function __ifog_drivers; ifog drivers 2>/dev/null | string replace -rf '^([A-Za-z0-9_]+) \\S+: .*' '$1'; end",
           "complete -c ifog -n __fish_use_subcommand -f"]
    for command in line["commands"]:
        out.append(f"complete -c ifog -n __fish_use_subcommand -f -a {command['name']} -d {quoted(command['help'])}")
        when = f"-n '__fish_seen_subcommand_from {command['name']}'"
        for option in command["options"]:
            if option["positional"] == "sensor":
                out.append(f"complete -c ifog {when} -f -a '(__ifog_sensors)'")
            if option["positional"]:
                continue
            flags = " ".join("-l " + name[2:] if name.startswith("--") else "-s " + name[1:] for name in option["names"])
            asked = {"--driver": "(__ifog_drivers)", "--sensor": "(__ifog_sensors)"}.get(option["names"][-1], " ".join(words_of(option)))
            value = "" if not option["value"] else f" -x -a {quoted(asked)}" if asked else " -r -F" if is_file(option) else " -x"
            out.append(f"complete -c ifog {when} {flags}{value} -d {quoted(option['help'])}")
    return "\n".join(out) + "\n"


def main():
    folder, line, ifogd_help = (pathlib.Path(argument) for argument in sys.argv[1:])
    folder.mkdir(parents=True, exist_ok=True)
    described = json.loads(line.read_text())
    (folder / "ifog").write_text(bash(described))
    (folder / "_ifog").write_text(zsh(described))
    (folder / "ifog.fish").write_text(fish(described))
    options = re.findall(r"(?<![\w-])--?[a-z][a-z-]*", "\n".join(row[:28] for row in ifogd_help.read_text().splitlines() if row.startswith("  -")))
    (folder / "ifogd").write_text(IFOGD.replace("@OPTIONS@", " ".join(options)))


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""What the shell completes of `ifog` and `ifogd`, from what they say of themselves.

usage: completion.py OUTPUT_DIR COMMAND_LINE.json IFOGD_HELP

Commands, options and the words that an option may have are fixed here; drivers, their options and the sensors' names are asked of
the installed programs and of the configuration at the time. Everything else is a file.
"""
import json
import pathlib
import re
import sys

IFOG = r"""# Completion of ifog, made in the build from its own options; see tools/manual. Do not edit.

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
      if [ "$command" = drivers ]; then
        COMPREPLY=($(compgen -W "$(_ifog_drivers "${words[0]}")" -- "$cur"))
      else
        _filedir
      fi
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

CONFIGURATION = "/etc/ifogd/ifogd.toml"


def names(options):
    return " ".join(name for option in options for name in option["names"])


def ifog(line):
    choices, values, words = [], [], []
    asked = {"--driver", "--sensor", "--option"}
    for command in line["commands"]:
        name, options = command["name"], command["options"]
        words.append(f'        {name}) COMPREPLY=($(compgen -W "{names(options)}" -- "$cur")) ;;')
        plain = []
        for option in options:
            if option["choices"]:
                pattern = " | ".join(f"'{name} {each}'" for each in option["names"])
                choices.append(f'    {pattern}) COMPREPLY=($(compgen -W "{" ".join(option["choices"])}" -- "$cur")); return ;;')
            elif option["value"] and not option["positional"]:
                plain += [each for each in option["names"] if each not in asked]
        if plain:
            pattern = " | ".join(f"'{name} {each}'" for each in plain)
            values.append(f"    {pattern}) _filedir; return ;;")
    text = IFOG.replace("@CHOICES@", "\n".join(choices)).replace("@VALUES@", "\n".join(values)).replace("@OPTIONS@", "\n".join(words))
    return text.replace("@COMMANDS@", " ".join(command["name"] for command in line["commands"])).replace(
        "@GLOBAL@", names(line["options"])).replace("@CONFIGURATION@", CONFIGURATION)


def main():
    folder, line, ifogd_help = (pathlib.Path(argument) for argument in sys.argv[1:])
    folder.mkdir(parents=True, exist_ok=True)
    (folder / "ifog").write_text(ifog(json.loads(line.read_text())))
    options = re.findall(r"(?<![\w-])--?[a-z][a-z-]*", "\n".join(row[:28] for row in ifogd_help.read_text().splitlines() if row.startswith("  -")))
    (folder / "ifogd").write_text(IFOGD.replace("@OPTIONS@", " ".join(options)))


if __name__ == "__main__":
    main()

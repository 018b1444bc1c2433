#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Holds every #include to the map of the folders: who may use whom, and no circles between folders.

usage: tests/layout/check_includes.py [TREE]     the tree's root; default: this one
       tests/layout/check_includes.py --self-test

One line a violation, FILE:LINE: what; exit 1 when there is one.
"""

import os
import re

from tree_check import main_of, proved

# The map. A folder may include itself, its subfolders, and these; the longest matching entry counts.
# A file named here may be included even if its folder may not.
ALLOWED = {
    "msgs": [],
    "drivers": [],
    # The installed interface for plugins is below everything; its users get only it.
    "drivers/ifog": [],
    # Shared rules: quoting foreign text and suggestions, also for plugins; counts of accepted device data, equal in captures and
    # the daemon; memory in files.
    # device has taken, which captures and the daemon must find alike; and room beyond memory.
    "filters": ["drivers/ifog/nearest.h", "drivers/ifog/quoted.h", "drivers/row_times", "drivers/system", "drivers/timeline", "drivers/units/turn.h"],
    "daemon": ["drivers", "filters", "msgs"],
    # Pictures and quoting of foreign names.
    "tools/report": ["drivers/capture/files/file_kind.h", "drivers/capture/files/output_file.h", "drivers/ifog/quoted.h", "drivers/row_times/median.h", "drivers/system/shell_word.h", "filters"],
    "tools/simulate": ["drivers", "filters"],
    "tools/ifog": ["daemon/config", "daemon/sensor", "daemon/state", "drivers", "filters", "msgs", "tools/report", "tools/simulate"],
    "tests": ["daemon", "drivers", "filters", "msgs", "tools"],
}

# Folders with an order: each may include those before it in its list. The last entry is the files in the folder itself, under its
# own name.
# the folder itself, under its own name.
ORDERED = {
    "filters/diagnosis": ["record", "channels", "ramp", "cleaning", "regression", "checks", "search", "residual", "report", "."],
}

# Headers that all subfolders may include, e.g. shared data or a list of entries; they do not count for cycles.
# make no circle.
EVERYWHERE = {"filters/diagnosis/record.h", "filters/diagnosis/diagnosis.h", "tools/ifog/commands.h"}

# Libraries of devices and networks are not allowed in code that must run without them.
NOT_FROM_OUTSIDE = {
    "filters": r"lcm/|spdlog/|systemd/|libserialport|linux/|sys/socket|termios",
    "drivers": r"lcm/|spdlog/|systemd/|Eigen/",
    "tools/report": r"lcm/",
    "tools/simulate": r"lcm/",
}

INCLUDE = re.compile(r'^\s*#\s*include\s*([<"])([^>"]+)[>"]')


def within(path, folder):
    return path == folder or path.startswith(folder + "/")


def sources(tree):
    for top in sorted({entry.split("/")[0] for entry in ALLOWED}):
        for folder, _, names in os.walk(os.path.join(tree, top)):
            for name in sorted(names):
                if name.endswith((".h", ".cpp", ".c")):
                    yield os.path.relpath(os.path.join(folder, name), tree)


def target(tree, file, bracket, name):
    """The included file as a path from the root; None if it is not in the project."""
    if re.fullmatch(r"ifog/\w+_t\.hpp", name):
        return "msgs/" + name[len("ifog/"):]
    for path in (name, "drivers/" + name, os.path.join(os.path.dirname(file), name)):
        if os.path.isfile(os.path.join(tree, path)):
            return os.path.normpath(path)
    return None


def room(path, folder, rooms):
    first = os.path.relpath(path, folder).split("/")[0]
    return rooms.index(first) if first in rooms else rooms.index(".")


def wrong(file, used):
    """Reason why `file` may not include `used`; None if it may."""
    if used in EVERYWHERE and any(within(file, folder) and within(used, folder) for folder in ORDERED):
        return None
    home = max((entry for entry in ALLOWED if within(file, entry)), key=len, default=None)
    if home is None:
        return "lies in no folder of the map"
    if not within(used, home) and not any(within(used, entry) for entry in ALLOWED[home]):
        return f"{home} may use {', '.join(ALLOWED[home]) or 'nothing else'}"
    for folder, rooms in ORDERED.items():
        if within(file, folder) and within(used, folder) and room(used, folder, rooms) > room(file, folder, rooms):
            mine, its = rooms[room(file, folder, rooms)], rooms[room(used, folder, rooms)]
            return f"{folder}: {mine} stands before {'the entry' if its == '.' else its}"
    return None


def circles(edges):
    """Cycles between folders, each a list of folders (Tarjan's strongly connected components)."""
    index, low, stack, found = {}, {}, [], []

    def visit(node):
        index[node] = low[node] = len(index)
        stack.append(node)
        for peer in sorted(edges.get(node, ())):
            if peer not in index:
                visit(peer)
                low[node] = min(low[node], low[peer])
            elif peer in stack:
                low[node] = min(low[node], index[peer])
        if low[node] == index[node]:
            component = stack[stack.index(node):]
            del stack[stack.index(node):]
            if len(component) > 1:
                found.append(sorted(component))

    for node in sorted(edges):
        if node not in index:
            visit(node)
    return found


def check(tree):
    complaints, edges = [], {}
    for file in sources(tree):
        with open(os.path.join(tree, file), encoding="utf-8") as text:
            lines = text.read().splitlines()
        for number, line in enumerate(lines, 1):
            said = INCLUDE.match(line)
            if not said:
                continue
            used = target(tree, file, *said.groups())
            where = f"{file}:{number}: {said.group(2)}"
            if used is None:
                for folder, pattern in NOT_FROM_OUTSIDE.items():
                    if within(file, folder) and re.match(pattern, said.group(2)):
                        complaints.append(f"{where}: {folder} knows nothing of devices or the network")
                continue
            reason = wrong(file, used)
            if reason:
                complaints.append(f"{where}: {reason}")
            mine, its = os.path.dirname(file), os.path.dirname(used)
            # A folder's own files are above its subfolders, so that they make no cycle with them.
            if mine != its and used not in EVERYWHERE and not within(file, "tests"):
                edges.setdefault(mine, {}).setdefault(its, where)
    for circle in circles(edges):
        ways = [edges[a][b] for a in circle for b in circle if b in edges.get(a, {})]
        complaints.append("circle between " + ", ".join(circle) + ":\n    " + "\n    ".join(ways))
    return complaints


def self_test():
    """A correct tree, then with one wrong line at a time."""
    good = {
        "filters/rules/rule.h": '#include "filters/settings/axes.h"\n',
        "filters/settings/axes.h": "#include <array>\n",
        "filters/diagnosis/record.h": "",
        "filters/diagnosis/diagnosis.h": "",
        "filters/diagnosis/diagnose.cpp": '#include "filters/diagnosis/report/findings.h"\n',
        "filters/diagnosis/record/blocks.h": '#include "filters/diagnosis/record.h"\n',
        "filters/diagnosis/search/scan.h": '#include "filters/diagnosis/record/blocks.h"\n',
        "filters/diagnosis/report/findings.h": '#include "filters/diagnosis/diagnosis.h"\n',
        "drivers/ifog/driver.h": "",
        "drivers/plugins/p.cpp": "#include <ifog/driver.h>\n",
        "daemon/config/config.h": '#include "filters/rules/rule.h"\n',
        "daemon/pipeline/pipeline.h": '#include <ifog/rate_t.hpp>\n#include "daemon/config/config.h"\n',
        "msgs/state_name.h": "",
        "tools/ifog/main.cpp": '#include "daemon/config/config.h"\n',
        "tests/unit/t.cpp": '#include "tools/ifog/main.cpp"\n',
    }
    bad = [
        ("filters/rules/bad.h", '#include "drivers/ifog/driver.h"', "filters may use drivers/ifog/nearest.h"),
        ("filters/rules/bad.h", '#include "../../daemon/config/config.h"', "filters may use drivers/ifog/nearest.h"),
        ("filters/rules/bad.h", "#include <ifog/rate_t.hpp>", "filters may use drivers/ifog/nearest.h"),
        ("filters/rules/bad.h", "#  include <lcm/lcm.h>", "knows nothing of devices"),
        ("filters/settings/bad.h", '#include "filters/rules/rule.h"', "circle between filters/rules, filters/settings"),
        ("filters/diagnosis/record/bad.h", '#include "filters/diagnosis/search/scan.h"', "record stands before search"),
        ("filters/diagnosis/search/bad.h", '#include "filters/diagnosis/diagnose.cpp"', "search stands before the entry"),
        ("drivers/plugins/bad.cpp", '#include "filters/settings/axes.h"', "drivers may use nothing else"),
        ("daemon/config/bad.h", '#include "tools/ifog/main.cpp"', "daemon may use drivers, filters, msgs"),
        ("daemon/config/bad.h", '#include "daemon/pipeline/pipeline.h"', "circle between daemon/config, daemon/pipeline"),
        ("tools/ifog/bad.cpp", '#include "daemon/pipeline/pipeline.h"', "tools/ifog may use daemon/config, daemon/sensor, daemon/state"),
        ("tools/new/bad.cpp", '#include "filters/rules/rule.h"', "lies in no folder of the map"),
    ]
    return proved(check, good, bad)


if __name__ == "__main__":
    main_of(check, self_test)

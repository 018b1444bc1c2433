#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Files of the state folder and the spool, which others may write, are opened only in daemon/state/, and in
drivers/flight/folder.cpp for the recorder.

usage: tests/layout/check_state_paths.py [TREE] tests/layout/check_state_paths.py --self-test

One line per violation, FILE:LINE: what; exit 1 if there is one.
"""
import pathlib
import re

from tree_check import main_of, proved

# Folders and files that use such files, and no others.
ROOMS = ("tools/ifog/field/", "daemon/sensor/noise_memory.", "daemon/recorder/", "daemon/housekeeping/")
HOMES = ("daemon/state/", "drivers/flight/folder.")
# Names of such files: a program that contains one builds their paths.
NAMES = re.compile(r'"[^"]*(\.proposal|\.history\.json|\.night\.json|\.kept-|\.model\.toml|\.noise\.toml|ifogd\.lock|ifogd\.socket)[^"]*"')
# Builds a name without opening it.
NAMED_ELSEWHERE = {"filters/model_file/kept_noise.h", "filters/model_file/kept_noise.cpp", "tools/ifog/denoise/denoise.cpp"}
OPENS = re.compile(r"(?<![\w.>])(?:::|std::)?(?:open|openat|fopen|creat|rename|renameat|unlink|unlinkat|link|symlink|chmod|chown|truncate|mkfifo|opendir)\s*\(|"
                   r"\b(?:i|o)?fstream\b|\b(?:fs|filesystem)::(?:exists|remove|remove_all|rename|copy|copy_file|directory_iterator|recursive_directory_iterator|"
                   r"file_size|is_regular_file|permissions|resize_file|create_symlink|read_symlink|last_write_time|canonical|weakly_canonical)\b|"
                   r"\b(?:read_model|read_kept_noise|read_toml_text|read_text_file|read_bytes_file|write_text_file|write_file|TextOutput|OutputFile)\s*[({]|"
                   r"\bInputFile\s+\w+\s*\(\s*[^,()]+\s*\)")
# Exceptions, by the text of the line: other files, or a listing without following links.
ALLOWED = {
    "tools/ifog/field/field.cpp": ("std::filesystem::exists(config_path_", "read_toml_text(config_path_)", "::open(folder.c_str(), O_RDONLY | O_DIRECTORY"),
    "tools/ifog/field/recorded.cpp": ("fs::directory_iterator(folder, error)",),
}


def code(line):
    return line.split("//")[0]


def check(tree):
    tree = pathlib.Path(tree)
    complaints, used = [], set()
    for path in sorted(each for top in ("daemon", "drivers", "filters", "tools") for each in (tree / top).rglob("*") if each.suffix in (".h", ".cpp")):
        name = path.relative_to(tree).as_posix()
        if name.startswith(HOMES):
            continue
        lines = path.read_text(encoding="utf-8").splitlines()
        named = name not in NAMED_ELSEWHERE and any(NAMES.search(code(line)) for line in lines)
        if not named and not name.startswith(ROOMS):
            continue
        for number, line in enumerate(lines, 1):
            if not OPENS.search(code(line)) or line.lstrip().startswith("#include"):
                continue
            allowed = [text for text in ALLOWED.get(name, ()) if text in line]
            used.update((name, text) for text in allowed)
            if not allowed:
                complaints.append(f"{name}:{number}: {OPENS.search(code(line)).group(0).strip()}: files of the state folder are opened by daemon/state/ alone")
    stale = [f"{name}: {text!r} is allowed by tests/layout/check_state_paths.py and stands nowhere" for name, texts in ALLOWED.items() for text in texts
             if (name, text) not in used and (tree / name).is_file()]
    return complaints + stale


def self_test():
    good = {
        "daemon/state/state_folder.cpp": 'int a = ::openat(folder, "ifogd.lock");\n',
        "drivers/flight/folder.cpp": "int a = ::open(path);\n",
        "drivers/capture/files/input_file.cpp": "int a = ::open(path);\n",
        "tools/ifog/field/history.cpp": 'write_state_file(path + ".history.json", text);\nbool b = socket.is_open();\nreopen(x);\n',
        "daemon/sensor/facts.cpp": "std::ifstream file(path);\n",
    }
    bad = [
        ("tools/ifog/field/new.cpp", "std::ofstream file(path);", "ofstream"),
        ("tools/ifog/field/new.cpp", "if (fs::exists(path)) return;", "fs::exists"),
        ("tools/ifog/field/new.cpp", "const Model model = read_model(path);", "read_model("),
        ("tools/ifog/field/new.cpp", "InputFile input(file.path);", "InputFile input(file.path)"),
        ("tools/ifog/field/new.cpp", "const int fd = ::open(path.c_str(), O_RDONLY);", "::open("),
        ("daemon/recorder/new.cpp", "std::rename(a, b);", "std::rename("),
        ("tools/ifog/elsewhere.cpp", 'std::ifstream file(state + "/nose.proposal.json");', "ifstream"),
        ("drivers/capture/new.cpp", 'const int fd = open((folder + "/ifogd.lock").c_str(), 0);', "open("),
        ("tools/ifog/field/field.cpp", "int nothing;", "stands nowhere"),
    ]
    return proved(check, good, bad)


if __name__ == "__main__":
    main_of(check, self_test)

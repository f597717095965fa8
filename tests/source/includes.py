#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Reads every #include line and fails on one that goes up or sideways.

usage: includes.py ROOT        check the tree
       includes.py --self-test planted violations must be found
"""
import pathlib
import re
import sys
import tempfile

# Folder -> folders it may include, besides itself; the longest folder that fits a path counts. Only tests and the chip's
# own folder see firmware/target/<chip>.
MAY_INCLUDE = {
    "shaper/base": [],
    "shaper/profile": ["shaper/base"],
    "shaper/shaping": ["shaper/base"],
    "shaper/identify": ["shaper/base"],
    "shaper/servo": ["shaper/base"],
    "shaper/axis": ["shaper/identify", "shaper/servo", "shaper/shaping", "shaper/profile", "shaper/base"],
    "shaper/tune": ["shaper/axis", "shaper/identify", "shaper/shaping", "shaper/profile", "shaper/base"],
    "hal": [],
    "firmware": ["shaper", "hal"],
    "firmware/target": ["firmware", "shaper", "hal"],
    "sim": ["shaper", "hal", "firmware"],
    "tests": ["shaper", "hal", "firmware", "sim"],
}
FREESTANDING = ("shaper/", "hal/", "firmware/")
FREESTANDING_HEADERS = {"stdint.h", "stddef.h", "limits.h", "float.h"}
# Headers of the command line's packages, and who may include them.
PACKAGES = ("CLI/", "coin/", "fmt/", "modbus/", "nlohmann/")
PACKAGE_USERS = ("sim/cli/", "sim/least_ticks", "sim/optimal_train", "tests/")
INCLUDE = re.compile(r"^\s*#\s*include\b\s*(.*)")


def inside(path, folder):
    return path == folder or path.startswith(folder + "/")


def home_of(path):
    homes = [folder for folder in MAY_INCLUDE if inside(path, folder)]
    return max(homes, key=len) if homes else None


def violation(root, path, what):
    """Why the file at `path` may not include `what` (with its quotes), or None."""
    home = home_of(path)
    name = what.strip('"<>')
    if home is None:
        return "the file is in no folder of the house"
    if what.startswith("<"):
        if path.startswith(FREESTANDING) and name not in FREESTANDING_HEADERS:
            return "a freestanding folder has only " + " ".join(sorted(FREESTANDING_HEADERS))
        if name.startswith(PACKAGES) and not path.startswith(PACKAGE_USERS):
            return "only the command line has packages"
        return None if home_of(name) is None else "own headers go in quotes"
    if not what.startswith('"'):
        return "an include names its file"
    if not (root / name).is_file():
        return "no such file from the repository root"
    target = home_of(name)
    if inside(home, "firmware/target") and target == home:
        return None if path.split("/")[2] == name.split("/")[2] else "one chip does not include another"
    if target == home or any(inside(target, allowed) for allowed in MAY_INCLUDE[home]):
        if target == "firmware/target" and not inside(home, "tests"):
            return f"{home} knows no chip"
        return None
    return f"{home} may include: {', '.join([home] + MAY_INCLUDE[home])}"


def check(root):
    """(number of include lines, list of complaints)"""
    count, complaints = 0, []
    for top in sorted({folder.split("/")[0] for folder in MAY_INCLUDE}):
        for file in sorted((root / top).rglob("*.[ch]pp")):
            path = file.relative_to(root).as_posix()
            for number, line in enumerate(file.read_text().splitlines(), 1):
                match = INCLUDE.match(line)
                if not match:
                    continue
                count += 1
                what = re.split(r"\s*/[/*]", match[1])[0].strip()
                why = violation(root, path, what)
                if why:
                    complaints.append(f"{path}:{number}: #include {what}: {why}")
    return count, complaints


def self_test():
    allowed = [
        ("shaper/axis/a.hpp", '"shaper/profile/p.hpp"'),
        ("shaper/profile/p.hpp", '"shaper/base/b.hpp"  // why'),
        ("shaper/base/b.hpp", "<stdint.h>"),
        ("firmware/f.hpp", '"hal/h.hpp"'),
        ("firmware/target/x/m.cpp", '"firmware/f.hpp"'),
        ("sim/s.cpp", "<vector>"),
        ("sim/cli/c.cpp", "<fmt/core.h>"),
        ("tests/t.cpp", '"sim/s.hpp"'),
        ("tests/t.cpp", '"firmware/target/x/r.hpp"'),
    ]
    forbidden = [
        ("shaper/base/b.hpp", '"shaper/profile/p.hpp"'),  # up
        ("shaper/profile/p.hpp", '"shaper/shaping/s.hpp"'),  # sideways
        ("shaper/shaping/s.hpp", '"shaper/axis/a.hpp"'),
        ("shaper/axis/a.hpp", '"hal/h.hpp"'),
        ("hal/h.hpp", '"shaper/base/b.hpp"'),
        ("firmware/f.hpp", '"firmware/target/x/r.hpp"'),
        ("firmware/f.hpp", '"sim/s.hpp"'),
        ("firmware/target/x/m.cpp", '"firmware/target/y/r.hpp"'),
        ("sim/s.cpp", '"tests/t.hpp"'),
        ("sim/s.cpp", "<fmt/core.h>"),
        ("sim/s.cpp", "<coin/Clp_C_Interface.h>"),
        ("shaper/base/b.hpp", "<cstdint>"),
        ("firmware/f.hpp", "<math.h>"),
        ("shaper/base/b.hpp", '"p.hpp"'),  # not from the root
        ("sim/s.cpp", "<shaper/base/b.hpp>"),
        ("shaper/base/b.hpp", "HEADER"),
    ]
    for expected, cases in ((0, allowed), (1, forbidden)):
        for path, what in cases:
            with tempfile.TemporaryDirectory() as folder:
                root = pathlib.Path(folder)
                for file in (what.split('"')[1] if '"' in what else "shaper/base/x.hpp", path):
                    (root / file).parent.mkdir(parents=True, exist_ok=True)
                    (root / file).write_text("")
                (root / path).write_text(f"#include {what}\n")
                if what == '"p.hpp"':
                    (root / "p.hpp").unlink()
                found = len(check(root)[1])
                if found != expected:
                    sys.exit(f"self-test: {path} including {what}: {found} complaints, expected {expected}")
    print(f"self-test passed: {len(allowed)} allowed, {len(forbidden)} forbidden")


def main():
    if sys.argv[1:] == ["--self-test"]:
        return self_test()
    count, complaints = check(pathlib.Path(sys.argv[1]))
    for complaint in complaints:
        print(complaint)
    print(f"{count} include lines read, {len(complaints)} wrong")
    sys.exit(1 if complaints or count == 0 else 0)


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""Flash and RAM, as tables; fails above the stated budgets.

usage: size_report.py library BUILD_TREE        the shaper library by module, everything in it counted, used or not
       size_report.py image BUILD_TREE [NAME]   the firmware by library and module, as linked (stillpoint)
"""
import collections
import pathlib
import re
import sys

import elf

# Bytes of flash and RAM. The library has no statics. An image's RAM has the delay lines in it (32 KB) and not the stack.
# The library grew with the shaper family (designed on the chip), the planner from any state, the kinds of profile, the
# identification and the tuner; an image takes only what it calls. The drive's takes nearly all, unless it is lean: that
# has no tuner.
BUDGET = {"library": (140 * 1024, 0),
          "stillpoint": (136 * 1024, 64 * 1024), "stillpoint-pulse": (136 * 1024, 64 * 1024),
          "stillpoint-lean": (96 * 1024, 64 * 1024), "stillpoint-pulse-lean": (96 * 1024, 64 * 1024)}

# Of one module: what the linker keeps of it if an image calls all of it. Of shaper/profile these are the moves that
# every axis has: S-curve and trapezoid, from rest and from any state, to a target and to a velocity, their tracks, the
# stop. What an image may leave out is counted apart.
MODULE_BUDGET = {"shaper/profile": 16 * 1024}
APART = {"curves": ("built_in_tables", "curve", "curve_plan", "profile_table", "table_peaks"), "matched": ("matched",),
         "streams": ("approach_curve", "stream_limiter", "stream_limits"), "hardware": ("hardware_limits",)}

FLASH, RAM = 0, 1

# Of -fcallgraph-info: a function's mangled name and the file that it is in.
NODE = re.compile(r'title: "(?:[^":]*:)?(\w[^":]*)" label: "[^"]*?\\n([^"]*?):\d+:\d+\\n')


def by_module_of_library(tree):
    sizes = collections.defaultdict(lambda: [0, 0])
    once = {}  # of which the linker keeps one copy: {name: (size, modules that carry it)}
    home = tree / "shaper/CMakeFiles/stillpoint_shaper.dir"
    for path in home.rglob("*.obj"):
        module = "shaper/" + path.relative_to(home).parent.as_posix()
        apart = [name for name, files in APART.items() if path.name.split(".")[0] in files]
        module += f" ({apart[0]})" if module == "shaper/profile" and apart else ""
        used = sizes[module]
        for section in elf.Elf(path).sections:
            if not section.allocated or section.name.startswith(".ARM"):
                continue
            if section.comdat:
                size, modules = once.get(section.name, (0, frozenset()))
                once[section.name] = max(size, section.size), modules | {module}
                continue
            if not section.name.startswith(".bss"):
                used[FLASH] += section.size
            if section.name.startswith((".bss", ".data")):
                used[RAM] += section.size
    for size, modules in once.values():
        sizes[min(modules) if len(modules) == 1 else "(in several)"][FLASH] += size
    return sizes


def module_of(path):
    """Of a source file or an object: its folder, less what the build tree puts before and between."""
    folder = pathlib.PurePath(re.sub(r"CMakeFiles/[^/]*\.dir/", "", path)).parent.as_posix()
    return re.sub(r"^.*(?=\b(shaper|firmware)\b)", "", folder).removesuffix("/stm32f405")


def modules_of_image(tree, name):
    """{function, object or file: module}: of what was compiled as a whole, functions as the compiler says where they
    are, objects as the single objects that were compiled first do."""
    modules = {}
    for path in [*(tree / "shaper").rglob("*.obj"), *(tree / "firmware").rglob("*.obj")]:
        home = path.relative_to(tree).as_posix()
        library = re.sub(r"/CMakeFiles/(.*?)\.dir/.*", r"/lib\1.a", home)
        modules[home] = modules[f"{library}({path.name})"] = module_of(home)
        modules |= {symbol.name: module_of(home) for symbol in elf.Elf(path).symbols if symbol.section and symbol.name}
    for path in tree.glob(f"{name}.elf.*.ci"):
        for function, place in NODE.findall(path.read_text()):
            modules[function] = module_of(place)
    return modules


def by_module_of_image(tree, name):
    modules = modules_of_image(tree, name)
    symbols = sorted({(symbol.address & ~1, symbol.size, symbol.name)
                      for symbol in elf.Elf(tree / f"{name}.elf").symbols if symbol.size}, reverse=True)
    sizes = collections.defaultdict(lambda: [0, 0])

    def count(module, size):
        if output not in (".bss", ".noinit"):
            sizes[module][FLASH] += size
        if output in (".bss", ".noinit", ".data"):
            sizes[module][RAM] += size

    text = (tree / f"{name}.map").read_text().split("Linker script and memory map")[1]
    output = None
    # A name too long for its column goes on in the next line.
    for line in re.sub(r"(?m)^( \S+)\n +(?=0x)", r"\1 ", text).splitlines():
        if line[:1] == ".":
            output = line.split()[0]
        part = re.fullmatch(r" (\S+) +0x([0-9a-f]+) +0x([0-9a-f]+)(?: (.*))?", line)
        if not part or output not in (".vectors", ".text", ".rodata", ".data", ".bss", ".noinit", ".ARM.exidx"):
            continue
        at, end, file = int(part[2], 16), int(part[2], 16) + int(part[3], 16), part[4] or "(linker)"
        if "ltrans" in file:
            inside = end
            for address, size, symbol in symbols:
                if at <= address and address + size <= inside:
                    inside = address
                    end -= size
                    count(modules.get(symbol, modules.get(symbol.split(".")[0], "(unknown)")), size)
            count("(constants, alignment)", end - at)
        elif part[1] == "*fill*":
            count("(constants, alignment)", end - at)
        else:
            count(modules.get(file, pathlib.Path(file.split("(")[0]).name.removesuffix(".a")), end - at)
    return sizes


def linked(tree, name):
    sections = {section.name: section.size for section in elf.Elf(tree / f"{name}.elf").sections if section.allocated}
    blank = sections.get(".bss", 0) + sections.get(".noinit", 0)
    return [sum(sections.values()) - blank, sections.get(".data", 0) + blank]


def main():
    what, tree = sys.argv[1], pathlib.Path(sys.argv[2])
    name = sys.argv[3] if len(sys.argv) > 3 else "stillpoint"
    budget = BUDGET[name if what == "image" else what]
    sizes = by_module_of_library(tree) if what == "library" else by_module_of_image(tree, name)
    print(f"{'module':24}{'flash':>8}{'RAM':>8}   bytes")
    for module, (flash, ram) in sorted(sizes.items()):
        if flash or ram:
            print(f"{module:24}{flash:8}{ram:8}")
    total = [sum(used[kind] for used in sizes.values()) for kind in (FLASH, RAM)]
    print(f"{'total':24}{total[FLASH]:8}{total[RAM]:8}")
    print(f"{'budget':24}{budget[FLASH]:8}{budget[RAM]:8}")
    if what == "image" and total != linked(tree, name):
        sys.exit(f"error: the table misses something: the image has {linked(tree, name)}")
    for module, most in MODULE_BUDGET.items() if what == "library" else ():
        print(f"{'budget of ' + module:24}{most:8}")
        if not 0 < sizes[module][FLASH] <= most:
            sys.exit(f"error: {module} is above its budget")
    if total[FLASH] == 0 or any(total[kind] > budget[kind] for kind in (FLASH, RAM)):
        sys.exit("error: above the budget")


main()

#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The worst-case stack of what interrupts the background, from the compiler's figures and the call graph of the image.

usage: tick_stack.py ELF BUILD_TREE

The figures are those of -fcallgraph-info=su (the .ci files of the tree); of functions that the compiler did not make
(libgcc's), what their pushes and subtractions from the stack pointer add up to. The graph is bounded_tick.py's. A
handler's stack begins with the frame that the processor pushes, with room for the floating-point registers (ARMv7-M
B1.5.6), and the word that aligns it.
"""
import pathlib
import re
import sys

import bounded_tick

MOST = 1024
EXCEPTION_FRAME = 26 * 4 + 4
TICK = "stillpoint::firmware::Application::tick("
NODE = re.compile(r'node: \{ title: "(?:[^":]*:)?(\w[^":]*)" label: "[^"]*\\n(\d+) bytes \((\w+(?:,\w+)?)\)')


def compilers_figures(tree):
    """{mangled name: (bytes, how sure)}, the largest where several objects have one"""
    figures = {}
    for path in pathlib.Path(tree).rglob("*.ci"):
        for name, size, kind in NODE.findall(path.read_text()):
            figures[name] = max(figures.get(name, (0, kind)), (int(size), kind))
    return figures


def counted(code):
    """Bytes that the instructions of a function push at most, every one taken once."""
    total = 0
    for one in code:
        name = bounded_tick.mnemonic(one)[0]
        if name in ("push", "vpush", "stmdb") and ("sp!" in one.operands or name != "stmdb"):
            for first, last in re.findall(r"[rds](\d+)(?:-[rds](\d+))?", one.operands.replace("lr", "r14").replace("sp!", "")):
                words = int(last or first) - int(first) + 1
                total += words * (8 if "d" in one.operands and name == "vpush" else 4)
        elif name == "sub" and one.operands.startswith("sp"):
            total += int(re.search(r"#(\d+)", one.operands)[1])
        elif name.startswith("str") and (step := re.search(r"\[sp, #-(\d+)\]!", one.operands)):
            total += int(step[1])
    return total


def main():
    image = bounded_tick.Image(sys.argv[1])
    calls, _, complaints = bounded_tick.examine(image)
    if complaints:
        sys.exit("error: the tick path is not bounded, see bounded_tick.py")
    figures = compilers_figures(sys.argv[2])
    own, errors, unknown = {}, [], []
    for function in calls:
        known = [figures[name] for name in image.names.get(function, []) if name in figures]
        own[function], kind = max(known) if known else (counted(image.code[function]), "static")
        if not known:
            unknown.append(image.title(function))
        if kind != "static":
            errors.append(f"error: {image.title(function)} takes a stack of unknown size ({kind})")

    deepest = {}

    def depth(function):
        if function not in deepest:
            below = max(((depth(to)[0], to) for to in calls[function]), default=(0, None))
            deepest[function] = (own[function] + below[0], below[1])
        return deepest[function]

    print("bytes, with the processor's frame")
    seen_tick = False
    for handler in sorted(image.vectors(), key=image.title):
        total = depth(handler)[0] + EXCEPTION_FRAME
        print(f"{total:6}  {image.title(handler)}")
        if total > MOST:
            errors.append(f"error: {image.title(handler)} takes {total} bytes of stack, {MOST} are allowed")
    worst = max(image.vectors(), key=lambda handler: depth(handler)[0])
    print("\nthe deepest chain")
    while worst is not None:
        seen_tick |= image.title(worst).startswith(TICK)
        print(f"{own[worst]:6}  {image.title(worst)}")
        worst = depth(worst)[1]
    print(f"\n{len(own)} functions, counted by hand: {', '.join(sorted(unknown)) or 'none'}")
    if len(unknown) > len(own) // 2 or not seen_tick:
        errors.append("error: the compiler's figures are missing, or the tick is not the deepest: this shows nothing")
    sys.exit("\n".join(errors) or 0)


main()

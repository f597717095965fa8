#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""The tick path of a linked firmware image is bounded: shown on the machine code that is flashed.

usage: bounded_tick.py ELF

Walks the call graph from every vector but reset, following calls, tail calls and fall-through; an indirect call may go
to any virtual function in any vtable of the image but those of the background's own. On that path: no floating point
arithmetic, in instructions or in the compiler's helpers, no division, no recursion, no indirect call that no vtable
answers; and the walk must reach the axis's tick, or it has shown nothing. Nowhere in the image: heap, exceptions, RTTI,
libm.
"""
import bisect
import collections
import re
import sys

import elf

MUST_REACH = "stillpoint::AxisCore::tick("

# An indirect call of the tick goes to none of these classes: hal/nonvolatile.hpp is the background's, and no interrupt
# has a pointer to one.
BACKGROUND = ("_ZTVN10stillpoint9stm32f40514ParameterFlashE",)

IN_IMAGE = {
    "heap": r"malloc|calloc|realloc|free|_malloc_r|_free_r|_sbrk|_Zn[wa].*|_Zd[la].*",
    "exceptions or RTTI": r"__cxa_(?!pure_virtual).*|_Unwind_.*|__gxx_.*|_ZTI.*|_ZTS.*|__aeabi_unwind.*|__aeabi_atexit",
    "libm": r"(sqrt|cbrt|exp|exp2|expm1|log|log2|log10|log1p|sin|cos|tan|asin|acos|atan|atan2|pow|hypot|fmod|floor|ceil"
            r"|round|lround|llround|trunc|rint|lrint|fabs|frexp|ldexp|scalbn)[fl]?",
}
ON_PATH = {
    "floating point helper": r"__aeabi_(d|f|h|cd|cf|i2|ui2|l2|ul2).*|__[a-z]+(df|sf|hf|xf)[a-z]*\d?|__(fix|float).*",
    "division helper": r"__aeabi_u?(i|l)?div.*|__u?(div|mod|divmod)[sdt]i\d",
}
DIVISION = re.compile(r"[su]div")
# Moves of bits; anything else that begins with v computes in floating point.
FLOAT_MOVES = re.compile(r"v(mov|ldr|str|push|pop|ldm\w*|stm\w*|mrs|msr)(\.(8|16|32|64))?")
LINE = re.compile(r"^\s*([0-9a-f]+):\t([^\t]+)(?:\t(.*))?$")
TARGET = re.compile(r"\b([0-9a-f]+) <")

CONDITION = re.compile(r"(bl|b|blx|bx|pop|ldmia|ldmdb|ldr|mov|\w+?)(eq|ne|cs|cc|mi|pl|vs|vc|hi|ls|ge|lt|gt|le)?")

Instruction = collections.namedtuple("Instruction", "address name operands")


class Image:
    def __init__(self, path):
        self.file = elf.Elf(path)
        self.names = collections.defaultdict(list)  # function address -> its names
        for symbol in self.file.symbols:
            if symbol.kind == elf.FUNCTION and symbol.section != 0:
                self.names[symbol.address & ~1].append(symbol.name)
        self.starts = sorted(self.names)
        self.readable = elf.demangled({name for names in self.names.values() for name in names})
        self.code = collections.defaultdict(list)  # function address -> instructions
        for line in elf.run("arm-none-eabi-objdump", "-d", "--no-show-raw-insn", path).splitlines():
            match = LINE.match(line)
            if match and not match[2].startswith("."):
                one = Instruction(int(match[1], 16), match[2].strip(), (match[3] or "").split(" @ ")[0].split("\t;")[0])
                self.code[self.function_at(one.address)].append(one)
        self.virtual = set()
        for symbol in self.file.symbols:
            if symbol.name.startswith("_ZTV") and symbol.name not in BACKGROUND:
                self.virtual |= {word & ~1 for word in self.file.words(symbol.address, symbol.size) if word & ~1 in self.names}

    def function_at(self, address):
        at = bisect.bisect_right(self.starts, address)
        return self.starts[at - 1] if at else address

    def title(self, function):
        return " = ".join(self.readable.get(name, name) for name in self.names.get(function, [hex(function)]))

    def vectors(self):
        """Handlers, reset left out."""
        section = self.file.section(".vectors")
        table = self.file.words(section.address, section.size)
        return {word & ~1 for word in table[2:] if word != 0}


def mnemonic(one):
    """Without its width: (name, condition or None)."""
    return CONDITION.fullmatch(one.name.split(".")[0]).groups()


def leaves(one):
    """(never comes back, goes where no instruction says)"""
    name, condition = mnemonic(one)
    never, nowhere = False, False
    if name == "bx":
        never, nowhere = True, one.operands != "lr"
    elif name == "blx":
        nowhere = True
    elif name in ("b", "tbb", "tbh", "udf"):
        never = True
    elif name in ("pop", "ldmia", "ldmdb"):
        never = "pc" in one.operands
    elif name in ("ldr", "mov") and one.operands.startswith("pc,"):
        never, nowhere = True, "[sp" not in one.operands
    return never and not condition, nowhere


def pads(one):
    """Between functions: the assembler's nops, the linker's zeros."""
    return one.name in ("nop", "nop.w") or (one.name, one.operands) == ("movs", "r0, r0")


def examine(image):
    """(reached functions, complaints)"""
    complaints = []
    for names in image.names.values():
        for name in names:
            for what, pattern in IN_IMAGE.items():
                if re.fullmatch(pattern, name):
                    complaints.append(f"{what} in the image: {image.readable[name]}")
    complaints += [f"exceptions or RTTI in the image: {symbol.name}" for symbol in image.file.symbols
                   if symbol.kind != elf.FUNCTION and re.fullmatch(IN_IMAGE["exceptions or RTTI"], symbol.name)]

    calls, indirect = {}, 0
    waiting = sorted(image.vectors())
    while waiting:
        function = waiting.pop()
        if function in calls:
            continue
        calls[function] = set()
        title = image.title(function)
        for name in image.names.get(function, []):
            for what, pattern in ON_PATH.items():
                if re.fullmatch(pattern, name):
                    complaints.append(f"{what} on the tick path: {name}")
        code = image.code[function]
        if not code:
            complaints.append(f"no code found at {title}")
            continue
        for one in code:
            where = f"{title}: {one.address:x}: {one.name} {one.operands}"
            if DIVISION.match(one.name):
                complaints.append(f"division on the tick path: {where}")
            if one.name.startswith("v") and not FLOAT_MOVES.fullmatch(one.name):
                complaints.append(f"floating point on the tick path: {where}")
            if leaves(one)[1]:
                indirect += 1
                calls[function] |= image.virtual
                if not image.virtual:
                    complaints.append(f"an indirect call that no vtable answers: {where}")
            target = TARGET.search(one.operands)
            if target and one.name.startswith(("b", "cb")):
                to = image.function_at(int(target[1], 16))
                if to != function or mnemonic(one)[0] == "bl":
                    calls[function].add(to)
        last = next((one for one in reversed(code) if not pads(one)), code[-1])
        if not leaves(last)[0] and mnemonic(last)[0] != "bl":  # a last call does not return
            calls[function] |= set(image.starts[bisect.bisect(image.starts, function):][:1])
        waiting += calls[function]

    if not any(image.title(function).startswith(MUST_REACH) for function in calls):
        complaints.append(f"the walk does not reach {MUST_REACH}...): it shows nothing")
    complaints += [f"recursion on the tick path: {image.title(function)}" for function in recursive(calls)]
    return calls, indirect, complaints


def recursive(calls):
    """Functions that can reach themselves."""
    answer = []
    for start in calls:
        seen, waiting = set(), list(calls[start])
        while waiting:
            function = waiting.pop()
            if function not in seen:
                seen.add(function)
                waiting += calls.get(function, ())
        if start in seen:
            answer.append(start)
    return answer


def main():
    image = Image(sys.argv[1])
    calls, indirect, complaints = examine(image)
    for function in sorted(calls, key=image.title):
        print(f"{len(image.code[function]):6} instructions  {image.title(function)}")
    print(f"{len(calls)} functions on the tick path, {indirect} indirect calls to any of {len(image.virtual)} virtual functions")
    for complaint in complaints:
        print(f"error: {complaint}")
    sys.exit(1 if complaints else 0)


if __name__ == "__main__":
    main()

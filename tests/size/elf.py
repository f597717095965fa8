# SPDX-License-Identifier: Apache-2.0
"""As much of a 32-bit little-endian ELF as the checks need."""
import collections
import struct
import subprocess

Symbol = collections.namedtuple("Symbol", "name address size kind section")
Section = collections.namedtuple("Section", "name address size data allocated comdat")
FUNCTION = 2  # STT_FUNC


class Elf:
    def __init__(self, path):
        self.path = path
        with open(path, "rb") as file:
            raw = file.read()
        if raw[:6] != b"\x7fELF\x01\x01":
            raise SystemExit(f"{path}: not a 32-bit little-endian ELF")
        start, = struct.unpack_from("<I", raw, 0x20)
        entry_size, count, names_index = struct.unpack_from("<HHH", raw, 0x2E)
        headers = [struct.unpack_from("<10I", raw, start + i * entry_size) for i in range(count)]

        def text(table, offset):
            begin = headers[table][4] + offset
            return raw[begin:raw.index(b"\0", begin)].decode()

        self.sections = []
        self.symbols = []
        for name, kind, flags, address, offset, size, link, *_ in headers:
            data = b"" if kind == 8 else raw[offset:offset + size]  # SHT_NOBITS
            self.sections.append(Section(text(names_index, name), address, size, data, flags & 2 != 0, flags & 0x200 != 0))
            if kind == 2:  # SHT_SYMTAB
                for at in range(offset, offset + size, 16):
                    label, value, length, info, _, section = struct.unpack_from("<IIIBBH", raw, at)
                    self.symbols.append(Symbol(text(link, label), value, length, info & 15, section))

    def section(self, name):
        return next(section for section in self.sections if section.name == name)

    def words(self, address, size):
        for section in self.sections:
            if section.allocated and section.address <= address and address + size <= section.address + len(section.data):
                begin = address - section.address
                return struct.unpack_from(f"<{size // 4}I", section.data, begin)
        return ()


def run(*command):
    return subprocess.run(command, check=True, capture_output=True, text=True).stdout


def demangled(names):
    """{mangled: readable}"""
    names = list(names)
    answer = subprocess.run(["arm-none-eabi-c++filt"], input="\n".join(names), check=True, capture_output=True, text=True)
    return dict(zip(names, answer.stdout.split("\n")))

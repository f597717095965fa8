#!/usr/bin/python3
# SPDX-License-Identifier: Apache-2.0
"""The chip's image in the emulator, driven by the Modbus clients that Debian has: mbpoll, libmodbus (in `stillpoint
drive`) and pymodbus, one after the other, over one serial port.

usage: clients.py STILLPOINT ELF
"""
import contextlib
import json
import pathlib
import signal
import struct
import subprocess
import sys
import tempfile
import time

from pymodbus.client import ModbusSerialClient
from pymodbus.diag_message import ReturnBusMessageCountRequest, ReturnQueryDataRequest
from pymodbus.exceptions import ModbusException, ModbusIOException
from pymodbus.mei_message import ReadDeviceInformationRequest

PROGRAM, ELF = sys.argv[1], sys.argv[2]
UNIT = 1
CONTROLWORD, STATUSWORD, MODE, TARGET, POSITION, DEMAND = 0x40, 0x41, 0x42, 0x44, 0x46, 0x4A
ENABLED, STANDS = 0x27, 1 << 10
# On a loaded host the chip's millisecond runs ahead of the bytes that the emulator hands over, so that it sees silence
# inside a request and drops it, as on a bad line. A client asks again; nothing here is the worse for being said twice.
ATTEMPTS = 8


class Failure(Exception):
    pass


def check(what, expected, actual):
    if expected != actual:
        raise Failure(f"{what}: expected {expected}, got {actual}")


def until(what, condition, seconds=30.0):
    end = time.monotonic() + seconds
    while not condition():
        if time.monotonic() > end:
            raise Failure(f"{what}: not within {seconds} s")


@contextlib.contextmanager
def emulated(port, *options, elf=ELF):
    image = ["--elf", elf] if elf else []
    chip = subprocess.Popen([PROGRAM, "emulate", *image, "--link", port, "--seconds", "300", *options],
                            stdout=subprocess.PIPE, text=True)
    try:
        check("the port", port, chip.stdout.readline().strip())
        yield
    finally:
        chip.send_signal(signal.SIGTERM)
        chip.wait(10)


class Mbpoll:
    """Reads and writes holding registers, address counted from 0, each call a process of its own."""

    def __init__(self, port):
        self.port = port

    def run(self, *arguments):
        command = ["mbpoll", "-m", "rtu", "-a", str(UNIT), "-b", "115200", "-P", "none", "-0", "-B", "-1", "-q", "-o", "2",
                   *arguments]
        for _ in range(ATTEMPTS):
            answer = subprocess.run(command, capture_output=True, text=True, timeout=60, check=False)
            if answer.returncode == 0:
                break
        return answer

    def read(self, address, count=1):
        answer = self.run("-t", "4:hex", "-r", str(address), "-c", str(count), self.port)
        check(f"mbpoll's exit reading {address:04X}h ({answer.stderr.strip()})", 0, answer.returncode)
        return [int(line.split("0x")[1], 16) for line in answer.stdout.splitlines() if line.startswith("[")]

    def write(self, address, *values):
        answer = self.run("-t", "4", "-r", str(address), self.port, *(str(value) for value in values))
        check(f"mbpoll's exit writing {address:04X}h ({answer.stderr.strip()})", 0, answer.returncode)


class Pymodbus:
    def __init__(self, port):
        self.client = ModbusSerialClient(port=port, baudrate=115200, parity="N", timeout=1)
        check("pymodbus's connection", True, self.client.connect())

    def ask(self, what, request):
        answer = ModbusIOException("nothing came")
        for _ in range(ATTEMPTS):
            try:
                answer = request()
            except (ModbusException, struct.error):  # it takes apart what is not whole
                continue
            if not isinstance(answer, ModbusIOException):
                break
        check(f"pymodbus {what} ({answer})", False, answer.isError())
        return answer

    def read(self, address, count=1):
        return self.ask(f"reading {address:04X}h",
                        lambda: self.client.read_holding_registers(address, count, slave=UNIT)).registers

    def write(self, address, *values):
        one = len(values) == 1
        self.ask(f"writing {address:04X}h", lambda: self.client.write_register(address, values[0], slave=UNIT) if one
                 else self.client.write_registers(address, list(values), slave=UNIT))

    def execute(self, what, request):
        return self.ask(what, lambda: self.client.execute(request))

    def close(self):
        self.client.close()


class Libmodbus:
    def __init__(self, port):
        self.port = port

    def drive(self, *arguments):
        answer = subprocess.run([PROGRAM, "drive", self.port, *arguments, "--parity", "none", "--json"],
                                capture_output=True, text=True, timeout=300, check=False)
        check(f"drive {' '.join(arguments)} ({answer.stderr.strip()})", 0, answer.returncode)
        return json.loads(answer.stdout)


def words(value):
    return value >> 16 & 0xFFFF, value & 0xFFFF


def wide(client, address):
    high, low = client.read(address, 2)
    value = high << 16 | low
    return value - (1 << 32) if value >= 1 << 31 else value


def state(client):
    return client.read(STATUSWORD)[0] & 0x6F


def enable(client):
    for word in (0x06, 0x07, 0x0F):
        client.write(CONTROLWORD, word)
    until("operation enabled", lambda: state(client) == ENABLED)


def move(client, target, wait=True):
    client.write(TARGET, *words(target))
    client.write(CONTROLWORD, 0x1F)
    until("the set-point taken", lambda: client.read(STATUSWORD)[0] & 1 << 12)
    client.write(CONTROLWORD, 0x0F)
    if wait:
        until("the target reached", lambda: client.read(STATUSWORD)[0] & STANDS)
        check("the position", target, wide(client, POSITION))


def who_it_is(client):
    check("map version, product", [0x0100, 0x5350], client.read(0x0000, 2))
    check("the word-order probe", [0x1234, 0x5678], client.read(0x0006, 2))


def homes(client):
    client.write(MODE, 6)
    until("the mode", lambda: client.read(MODE + 1) == [6])
    client.write(CONTROLWORD, 0x1F)
    until("home", lambda: client.read(STATUSWORD)[0] & 1 << 12)
    check("the position at home", 0, wide(client, POSITION))
    client.write(CONTROLWORD, 0x0F)
    client.write(MODE, 1)
    until("the mode", lambda: client.read(MODE + 1) == [1])


def halts_and_stops(client):
    move(client, 3000000, wait=False)
    client.write(CONTROLWORD, 0x10F)
    until("the halt", lambda: client.read(STATUSWORD)[0] & STANDS)
    halted = wide(client, DEMAND)
    client.write(CONTROLWORD, 0x0F)
    check("enabled after the halt", ENABLED, state(client))
    check("standing after the halt", halted, wide(client, DEMAND))
    move(client, -3000000, wait=False)
    client.write(CONTROLWORD, 0x02)
    until("switched off by the quick stop", lambda: client.read(STATUSWORD)[0] & 0x4F == 0x40)
    enable(client)


# The drive's watch over its client is provoked by saying nothing.
def faults_and_recovers(client):
    client.write(0x0014, 0x554E)
    client.write(0x0023, 300)
    enable(client)
    time.sleep(8)  # a millisecond of the emulated chip takes four of these, more on a loaded host
    until("the fault", lambda: client.read(0x0010) == [0x8100])
    check("the state", 0x08, client.read(STATUSWORD)[0] & 0x4F)
    check("the history", [0x8100, 1], client.read(0x0500, 2))
    client.write(0x0014, 0x554E)
    client.write(0x0023, 0)
    client.write(CONTROLWORD, 0x00)
    client.write(CONTROLWORD, 0x80)
    until("the reset", lambda: client.read(0x0010) == [0])
    enable(client)


def shapes(client):
    client.write(0x0102, *words(110000), 11000, 0, 1, 0)  # ZV, 11 Hz, 0.11
    client.write(0x0100, 1)
    client.write(0x0130, 1)
    until("the shaper in force", lambda: client.read(0x0131) == [1])
    delay_us = wide(client, 0x0134)
    if not 15000 < delay_us < 25000:
        raise Failure(f"the shaper's delay: {delay_us} us")


# Functions 8 and 43/14, which of the three only pymodbus knows.
def diagnoses(client):
    sent = [0xA537]
    check("the query data returned", sent,
          list(client.execute("asking for its data back", ReturnQueryDataRequest(sent, unit=UNIT)).message))
    counted = client.execute("asking for a counter", ReturnBusMessageCountRequest(unit=UNIT)).message
    if not 0 < (counted if isinstance(counted, int) else counted[0]):
        raise Failure(f"bus messages counted: {counted}")
    told = client.execute("asking for its identification", ReadDeviceInformationRequest(0x01, 0x00, unit=UNIT))
    check("the objects of its identification", [0, 1, 2], sorted(told.information))
    check("the vendor", b"stillpoint", told.information[0])


def scopes(client, target):
    client.write(0x0302, 2, 0)  # a motion
    client.write(0x0306, 0, 10, 1)
    client.write(0x030A, 2, 3, 0, 0)  # setpoint, position
    client.write(0x0300, 1)
    start = wide(client, DEMAND)
    move(client, target)
    until("the record", lambda: client.read(0x0301) == [3])
    samples, before = client.read(0x0310)[0], client.read(0x0309)[0]
    for channel in (0, 1):
        record = []
        for block in range(-(-samples // 62)):
            client.write(0x0311, channel << 8 | block)
            page = client.read(0x0400, 124)
            record += struct.unpack(">62i", struct.pack(">124H", *page))
        record = record[:samples]
        check("the setpoint before the trigger", [start] * before, record[:before])
        check("a record that only rises", sorted(record), record)
        check("the end of the record", target, record[-1])


def tunes(libmodbus):
    tuned = libmodbus.drive("tune", "--excitation", "move", "--amplitude", "1000000", "--travel", "1000000")
    check("the tuning's result", "ok", tuned["result"])
    mode = tuned["identified"]["modes"][0]
    if abs(mode["frequency_hz"] / 11 - 1) > 0.005 or abs(mode["damping_ratio"] / 0.11 - 1) > 0.1:
        raise Failure(f"tuned to {mode['frequency_hz']} Hz, {mode['damping_ratio']}")
    check("the announced travel", 1000000, tuned["first_announced"]["travel"])
    status = libmodbus.drive("status")
    check("the fault, and the shaper in force", (0, 1), (status["error_code"], status["shaper_state"]))


def drives_everything(port):
    mbpoll, libmodbus = Mbpoll(port), Libmodbus(port)
    who_it_is(mbpoll)
    check("libmodbus's state", "operation enabled", libmodbus.drive("enable")["state"])
    move(mbpoll, 70000)
    homes(mbpoll)
    check("libmodbus's move", 500000, libmodbus.drive("move", "--target", "500000")["position_counts"])
    pymodbus = Pymodbus(port)
    who_it_is(pymodbus)
    move(pymodbus, -200000)
    halts_and_stops(pymodbus)
    faults_and_recovers(pymodbus)
    shapes(pymodbus)
    diagnoses(pymodbus)
    move(pymodbus, 0)
    scopes(pymodbus, 200000)
    move(pymodbus, 0)
    pymodbus.close()
    tunes(libmodbus)
    halts_and_stops(mbpoll)
    tuned = libmodbus.drive("export")["shaper_sets"][0]["mode-0-frequency"]
    if not 109450 <= tuned <= 110550:
        raise Failure(f"the tuned mode exported: {tuned}")
    check("switched off", "switch on disabled", libmodbus.drive("disable")["state"])


def starts_on_what_was_saved(folder):
    """Saved on the host, since the emulated flash cannot; then each start of the chip is on it, after a reset too."""
    port, memory = str(pathlib.Path(folder) / "stored"), str(pathlib.Path(folder) / "memory")
    libmodbus, mbpoll = Libmodbus(port), Mbpoll(port)
    with emulated(port, "--memory", memory, elf=None):
        mbpoll.write(0x60, *words(765432))
        libmodbus.drive("save")
    with emulated(port, "--memory", memory):
        check("the profile velocity saved", 765432, wide(mbpoll, 0x60))
        mbpoll.write(0x60, *words(111))
        mbpoll.write(0x14, 0x554E)
        mbpoll.write(0x14, 0x5253)
        until("another start", lambda: wide(mbpoll, 0x60) == 765432)


def host_was_too_slow(port):
    """The drive gives up on a link that is silent for 0.4 s of the host; that says nothing about its clients."""
    try:
        return wide(Mbpoll(port), 0x001C) > 0
    except Failure:
        return False


def main():
    for attempt in range(5):
        with tempfile.TemporaryDirectory() as folder:
            port = str(pathlib.Path(folder) / "port")
            with emulated(port):
                try:
                    drives_everything(port)
                    starts_on_what_was_saved(folder)
                    print("mbpoll, libmodbus and pymodbus have driven the chip's image")
                    return
                except Failure as failure:
                    if not host_was_too_slow(port):
                        sys.exit(f"error: {failure}")
                    print(f"attempt {attempt + 1}: the host was kept from running ({failure})")
    sys.exit("error: the host is too slow for the drive")


main()

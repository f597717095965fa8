#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""usage: same_bits.py STILLPOINT ELF

Moves of every kind on the production image in the emulator: the chip's setpoints must be the host's, bit for bit, on an
idle host and on one that is kept busy.
"""
import json
import os
import subprocess
import sys

MOVES = {
    "the paper's move, zero delay": "--distance 1.7 --velocity 1.2 --acceleration 20 --jerk 600 --duration 1.62 "
                                    "--shaper zv:11:0.11 --zero-delay --arm 11:0.11",
    "back, ZVD": "--distance -0.3 --velocity 1.2 --acceleration 20 --jerk 600 --shaper zvd:23.7:0.03 --arm 23.7:0.03",
    "trapezoid, two modes": "--distance 0.5 --velocity 1 --acceleration 10 --deceleration 7 --kind trapezoid "
                            "--shaper zv:11:0.11+zv:37.3:0.02 --arm 11:0.11:0.9,37.3:0.02:0.1",
    "no cruise, unequal ramps": "--distance 0.0234567 --velocity 2 --acceleration 13.7 --deceleration 31.3 --jerk 777 "
                                "--shaper zv:150:0.2 --arm 150:0.2",
    "one count": "--distance 0.000001 --velocity 1 --acceleration 10 --jerk 500 --shaper zv:11:0 --arm 11:0",
    "EI of two humps": "--distance 0.4 --velocity 1.2 --acceleration 20 --jerk 600 --shaper ei2:11:0.05 --arm 11:0.05",
    "CV of three humps": "--distance -0.2 --velocity 1 --acceleration 15 --jerk 500 --shaper cv3:18.3:0.02 "
                         "--arm 18.3:0.02",
    "no shaper": "--distance 0.1 --velocity 0.5 --acceleration 5 --jerk 100 --shaper none --arm 11:0.11",
}


def run(stillpoint, elf, options):
    done = subprocess.run([stillpoint, "hil", "--elf", elf, "--json", *options.split()], stdout=subprocess.PIPE,
                          timeout=300)
    if done.returncode != 0:
        sys.exit(f"same_bits.py: {options}: exit {done.returncode}")
    return json.loads(done.stdout)


def main():
    stillpoint, elf = sys.argv[1:]
    hashes = set()
    for name, options in MOVES.items():
        idle = run(stillpoint, elf, options)
        hogs = [subprocess.Popen([sys.executable, "-c", "while True: pass"]) for _ in range(os.cpu_count() or 1)]
        try:
            busy = run(stillpoint, elf, options)
        finally:
            for hog in hogs:
                hog.kill()
        seen = {idle["setpoint_hash"], idle["host_setpoint_hash"], busy["setpoint_hash"], busy["host_setpoint_hash"]}
        print(f"{name}: {idle['ticks']} ticks, {' '.join(sorted(seen))}")
        if len(seen) != 1:
            sys.exit(f"same_bits.py: {name}: not the same bits: {seen}")
        hashes |= seen
    if len(hashes) != len(MOVES):
        sys.exit("same_bits.py: two different moves have the same hash, so it tells nothing")
    print(f"{len(MOVES)} moves, chip and host, idle and busy: the same bits")


main()

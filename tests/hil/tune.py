#!/usr/bin/env python3
# SPDX-License-Identifier: Apache-2.0
"""usage: tune.py STILLPOINT ELF...

The firmware in the emulator finds the paper's arm and its shaper by itself: frequency within 0.5 %, damping within 10 %,
the moves after it the host's bit for bit, no tick missing to the drive. The test image, whose millisecond runs on, has
none late and repeats itself. An arm of two modes, shaken by a sharper move, gets a shaper for each.
"""
import json
import subprocess
import sys

TUNE = "--distance 1.7 --velocity 1.2 --acceleration 20 --jerk 600 --duration 1.62 --noise 0.03 --encoder-noise 1 "
THE_PAPERS_ARM = "--arm 11:0.11"
TWO_MODES = "--arm 11:0.05:0.9,29:0.02:0.1 --jerk 6000"
A_STIFF_ARM = "--arm 11:0.11:1e-9"
MOST_BYTES = 32 * 1024


def run(stillpoint, elf, arm, exit_code):
    # The last of an option given twice holds.
    options = dict(zip(*[iter((TUNE + arm).split())] * 2))
    done = subprocess.run([stillpoint, "hil", "--tune", "--elf", elf, "--json", *sum(options.items(), ())],
                          stdout=subprocess.PIPE, timeout=300)
    if done.returncode != exit_code:
        sys.exit(f"tune.py: {elf}: exit {done.returncode}: {done.stdout.decode()}")
    return json.loads(done.stdout)


def check(what, holds):
    if not holds:
        sys.exit(f"tune.py: {what}")


def check_two_modes(tuned):
    modes = tuned["identified"]["modes"]
    found = ", ".join(f"{mode['frequency_hz']:.4f} Hz and {mode['damping_ratio']:.5f}" for mode in modes)
    print(f"two modes: {found}: {tuned['shaper']}, {100 * tuned['residual_ratio']:.4f} % left, "
          f"instructions {tuned['instructions']}")
    check("two modes", len(modes) == 2 and tuned["shaper"].count("+") == 1)
    for mode, (frequency, damping) in zip(modes, ((11.0, 0.05), (29.0, 0.02))):
        check("frequency of two", abs(mode["frequency_hz"] - frequency) <= 0.005 * frequency)
        check("damping of two", abs(mode["damping_ratio"] - damping) <= 0.1 * damping)
    check("hashes of two", tuned["setpoint_hash"] == tuned["host_setpoint_hash"])
    check("residual of two", tuned["residual_ratio"] <= 0.05)
    check("ticks of two", tuned["late_ticks"] == 0 and tuned["missing_ticks"] == 0)


def main():
    stillpoint, elfs = sys.argv[1], sys.argv[2:]
    for elf in elfs:
        tuned = run(stillpoint, elf, THE_PAPERS_ARM, 0)
        mode = tuned["identified"]["modes"][0]
        print(f"{elf}: {mode['frequency_hz']:.4f} Hz, {mode['damping_ratio']:.5f}, {tuned['shaper']}, "
              f"{100 * tuned['residual_ratio']:.3f} % left, late {tuned['late_ticks']}, "
              f"missing {tuned['missing_ticks']}, instructions {tuned['instructions']}, "
              f"memory {tuned['memory_bytes']}")
        check("result", tuned["result"] == "ok" and tuned["identified"]["result"] == "ok")
        check("frequency", abs(mode["frequency_hz"] - 11.0) <= 0.005 * 11.0)
        check("damping", abs(mode["damping_ratio"] - 0.11) <= 0.1 * 0.11)
        check("hashes", tuned["setpoint_hash"] == tuned["host_setpoint_hash"])
        check("residual", tuned["residual_ratio"] <= 0.05)
        check("missing ticks", tuned["missing_ticks"] == 0)
        check("memory", sum(tuned["memory_bytes"].values()) <= MOST_BYTES)
        if tuned["late_ticks"] is None:
            continue
        check("late ticks", tuned["late_ticks"] == 0)
        # A figure of its own: an identification of 2048 samples in software doubles is far more than a tenth of this.
        check("instructions", 1e8 < tuned["instructions"] < 1e10)
        check("the test image repeats itself", run(stillpoint, elf, THE_PAPERS_ARM, 0) == tuned)
        check_two_modes(run(stillpoint, elf, TWO_MODES, 0))
        stiff = run(stillpoint, elf, A_STIFF_ARM, 1)
        check("an arm that does not ring", stiff["result"] == "no_mode" and not stiff["identified"]["modes"])
        check("late ticks without a mode", stiff["late_ticks"] == 0)


main()

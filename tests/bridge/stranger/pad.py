#!/usr/bin/env python3
"""A pad, written from firmware-proto/README.md alone. It only sends sample frames and answers nothing.

Usage: pad.py '[{"x_mm": 15, "y_mm": 0, "fz_n": 1, "ms": 300}, ...]', or the same list on standard input.

Opens a pseudo-terminal, prints its path, and starts when a host opens it: one second of rest, then the
contacts. Missing forces are 0; after each contact come `rest_ms` of rest, 200 if missing, and 0 goes straight
to the next contact. Then the line closes.
"""

import csv
import json
import os
import pathlib
import pty
import select
import struct
import sys
import time
import tty
import zlib

REPOSITORY = pathlib.Path(__file__).parents[3]
INFLUENCE = REPOSITORY / "crates/mechanics/tests/mechanics/reference/nominal.csv"
CHANNELS = ("m0x", "m0y", "m0z", "m1x", "m1y", "m1z", "m2x", "m2y", "m2z")
MICROVOLTS_PER_COUNT = 0.01
PERIOD_US = 1000
OPEN_WITHIN_S = 10
RESTARTED = 1 << 10


def frame(kind, payload):
    body = bytes([1, kind]) + payload
    body += struct.pack("<I", zlib.crc32(body))
    return b"".join(bytes([len(run) + 1]) + run for run in body.split(b"\0")) + b"\0"


def sample(sequence, counts):
    status = RESTARTED if sequence == 0 else 0
    return frame(0x01, struct.pack("<IQ9ihH", sequence, sequence * PERIOD_US, *counts, 2500, status))


def counts_of(contact, nodes):
    """Nine counts of a contact, from the node of the influence table that is nearest to it."""
    x, y = contact["x_mm"], contact["y_mm"]
    node = min(nodes, key=lambda n: (n["x_mm"] - x) ** 2 + (n["y_mm"] - y) ** 2)
    forces = {axis: contact.get(axis + "_n", 0) for axis in ("fx", "fy", "fz")}
    return [
        round(sum(n * node[f"{channel}_per_{axis}"] for axis, n in forces.items()) / MICROVOLTS_PER_COUNT)
        for channel in CHANNELS
    ]


def schedule(contacts):
    """The counts of every sample, in order."""
    with INFLUENCE.open(newline="") as table:
        nodes = [{name: float(value) for name, value in row.items()} for row in csv.DictReader(table)]
    rest = [0] * len(CHANNELS)
    samples = [rest] * 1000
    for contact in contacts:
        samples += [counts_of(contact, nodes)] * contact["ms"]
        samples += [rest] * contact.get("rest_ms", 200)
    return samples


def hung_up(line, wait_ms):
    """Reads away what the host says, and tells whether no host has the line open."""
    poll = select.poll()
    poll.register(line, select.POLLIN)
    seen = dict(poll.poll(wait_ms)).get(line, 0)
    if seen & select.POLLIN and not seen & select.POLLHUP:
        os.read(line, 4096)
    return bool(seen & select.POLLHUP)


def main():
    samples = schedule(json.loads(sys.argv[1] if len(sys.argv) > 1 else sys.stdin.read()))
    line, host_side = pty.openpty()
    tty.setraw(host_side)
    print(os.ttyname(host_side), flush=True)
    os.close(host_side)

    give_up = time.monotonic() + OPEN_WITHIN_S
    while hung_up(line, 0):
        if time.monotonic() > give_up:
            sys.exit("pad.py: no host opened the line")
        time.sleep(0.005)

    start = time.monotonic()
    for sequence, counts in enumerate(samples):
        due = start + sequence * PERIOD_US / 1e6
        if hung_up(line, 0):
            sys.exit("pad.py: the host closed the line")
        time.sleep(max(0, due - time.monotonic()))
        os.write(line, sample(sequence, counts))
    # To close a pseudo-terminal throws away what the host has not read yet.
    time.sleep(0.02)
    os.close(line)


if __name__ == "__main__":
    main()

#!/usr/bin/env python3
"""Measures what `replay` recognises: python3 what-shows.py target/release/host-sim

Each case is 30 surveys like those of no-line.py, along lines and with wrong labels from the seeds 1000 to 1029. It
prints the verdicts. docs/limits.md has them as a table.
"""

import collections
import json
import math
import random
import subprocess
import sys
import tempfile
from pathlib import Path

SURVEYS = 30


def survey(draw):
    for leg in range(12):
        for row in range(20):
            up = row if leg % 2 == 0 else 19 - row
            x = (leg + 0.5 + draw.uniform(-0.3, 0.3)) * 20 / 12
            yield round(x, 3), round(up + 0.5 + draw.uniform(-0.3, 0.3), 3)


def verdict(rows):
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "survey.csv"
        path.write_text("x,z,label\n" + "".join(f"{x},{z},{1 if it else -1}\n" for (x, z), it in rows))
        args = [sys.argv[1], "-q", "replay", path, "--p", "0.95", "--format", "json"]
        return json.loads(subprocess.run(args, capture_output=True, check=True).stdout)["fit"]["verdict"]


def case(name, is_positive, wrong=0.05):
    """`is_positive` says the label by how far right and up of the middle a place is, its row, a lean and the row at
    which a fault begins."""
    found = collections.Counter()
    for seed in range(1000, 1000 + SURVEYS):
        draw = random.Random(seed)
        places = list(survey(draw))
        lean, first = draw.uniform(-0.7, 0.7), draw.randrange(20, 150)
        label = lambda row, x, z: is_positive(x - 10, z - 10, row, lean, first) != (draw.random() < wrong)
        found[verdict([((x, z), label(row, x, z)) for row, (x, z) in enumerate(places)])] += 1
    print(f"{name}: {dict(found)}", flush=True)


def above(x, z, lean):
    return z * math.cos(lean) - x * math.sin(lean)


for n in (5, 8, 10, 15):
    case(f"{n} in a row", lambda x, z, row, lean, at: (above(x, z, lean) > 0) != (at <= row < at + n))
for n in (20, 40, 60):
    case(f"stuck for {n}", lambda x, z, row, lean, at: at <= row < at + n or above(x, z, lean) > 0)
for r in (15, 20, 30, 50):
    case(f"arc of {r} m", lambda x, z, row, lean, at: math.hypot(x + r * math.sin(lean), z + r * math.cos(lean)) > r)
for w in (2, 4, 8):
    case(f"strip of {w} m", lambda x, z, row, lean, at: abs(above(x, z, lean)) < w / 2)
for a in (1, 2, 3):
    case(f"sine of {a} m", lambda x, z, row, lean, at: z > a * math.sin(math.pi * x / 10))
for p in (0.7, 0.8, 0.85, 0.9):
    case(f"straight, p = {p}", lambda x, z, row, lean, at: above(x, z, lean) > 0, 1 - p)

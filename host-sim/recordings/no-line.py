#!/usr/bin/env python3
"""Makes the four recordings that no straight, still line explains: python3 no-line.py

Each is a survey of 12 legs with 20 rows in a field of 20 m by 20 m, one label in twenty wrong:
- two-boundaries.csv: +1 between the lines z = 0.2 x + 4 and z = 0.2 x + 12;
- fouled-sensor.csv: the line z = 0.41 x + 3.5; 60 rows (lines 103 to 162 of the file) have the label of the other side;
- front.csv: an arc of radius 15 m, +1 outside, whose top is in the middle of the field;
- tide.csv: the line z = 0.3 x + 4, which moves 4 m to larger z while the rows are read in no order.
"""

import math
import random
from pathlib import Path

LEGS, ROWS, SIZE = 12, 20, 20.0


def survey(draw):
    """Places on legs up and down the field."""
    for leg in range(LEGS):
        for row in range(ROWS):
            up = row if leg % 2 == 0 else ROWS - 1 - row
            x = (leg + 0.5 + draw.uniform(-0.3, 0.3)) * SIZE / LEGS
            z = (up + 0.5 + draw.uniform(-0.3, 0.3)) * SIZE / ROWS
            yield round(x, 3), round(z, 3)


def write(name, about, seed, is_positive, shuffled=False):
    """`is_positive` says the label by the place and the number of the row."""
    draw = random.Random(seed)
    places = list(survey(draw))
    if shuffled:
        draw.shuffle(places)
    lines = [f"# Made by no-line.py: {about}.", "x,z,label"]
    for number, (x, z) in enumerate(places):
        label = is_positive(x, z, number) != (draw.random() < 0.05)
        lines.append(f"{x},{z},{1 if label else -1}")
    Path(__file__).with_name(name).write_text("\n".join(lines) + "\n")


write("two-boundaries.csv", "+1 lies between two lines", 3, lambda x, z, _: 4 < z - 0.2 * x < 12)
write(
    "fouled-sensor.csv",
    "a fouled sensor gave the label of the other side in 60 rows",
    2,
    lambda x, z, number: (z > 0.41 * x + 3.5) != (100 <= number < 160),
)
write("front.csv", "the boundary is an arc", 5, lambda x, z, _: math.hypot(x - 10, z + 5) > 15)
write(
    "tide.csv",
    "the boundary moves by 4 m",
    7,
    lambda x, z, number: z > 0.3 * x + 4 + 4 * number / (LEGS * ROWS - 1),
    shuffled=True,
)

#!/usr/bin/env python3
"""Draws the figure of large-areas.md: the error of the line against the metres driven, a curve for each price.

    cargo build --release
    python3 docs/error-against-metres.py target/release/host-sim docs/error-against-metres.svg

It flies 1,000 standard fields of 800 m x 500 m with each planner and each price. It measures after every label. A dot is a
label: its metres are the mean over the fields, its error is the median or the 90th percentile.
"""

import csv
import math
import subprocess
import sys
import tempfile
from pathlib import Path

FLAGS = "campaign --area 800,500 --reach 5 --labels 24 --steps 400 --every".split()
# Name, flags, colour, dashes; where the name stands beside the last dot: right, down, anchor.
CURVES = [
    ("lawnmower", "--algorithm lawnmower", "#6e6e6e", "7 4", (5, 18, "middle")),
    ("margin sampling", "--algorithm margin", "#009e73", "2 3", (-8, 26, "end")),
    ("near sight", "--algorithm lookahead --price none", "#d55e00", "9 4 2 4", (-8, 11, "end")),
    ("price 0", "--algorithm lookahead --price 0", "#56b4e9", "", (-7, 5, "end")),
    ("5 m", "--algorithm lookahead --price 5", "#2f8fd0", "", (7, 5, "start")),
    ("50 m", "--algorithm lookahead --price 50", "#0b62a4", "", (7, 5, "start")),
    ("500 m", "--algorithm lookahead --price 500", "#062f52", "", (-4, 17, "middle")),
]
MEASURES = [("centre_deg", 1.0, "slope error, degrees"), ("centre_misclassified", 100.0, "misclassified area, %")]
SPREADS = [(0.5, "median"), (0.9, "90th percentile")]
WIDE, HIGH, LEFT, TOP, GAP = 400, 270, 62, 82, 78
METRES, ERRORS = (5.0, 4000.0), (0.003, 40.0)


def flown(program, flags):
    """For each number of labels the mean metres, and for each measure its values over the fields, sorted."""
    with tempfile.TemporaryDirectory() as folder:
        rows = Path(folder, "rows.csv")
        command = [program, *FLAGS, *flags.split(), "--csv", str(rows)]
        subprocess.run(command, check=True, stdout=subprocess.DEVNULL)
        by_label = {}
        with rows.open() as file:
            for row in csv.DictReader(file):
                by_label.setdefault(int(row["step"]), []).append(row)
    metres = {label: sum(float(row["metres"]) for row in rows) / len(rows) for label, rows in by_label.items()}
    values = {
        (label, name): sorted(factor * float(row[name]) for row in rows)
        for label, rows in by_label.items()
        for name, factor, _ in MEASURES
    }
    return metres, values


def along(value, ends, pixels):
    """Where a value lies on a logarithmic axis."""
    low, high = map(math.log, ends)
    at = (math.log(min(max(value, ends[0]), ends[1])) - low) / (high - low)
    return round(pixels[0] + at * (pixels[1] - pixels[0]), 1)


def text(words, x, y, size=12, anchor="start", more=""):
    return f'<text x="{x}" y="{y}" font-size="{size}" text-anchor="{anchor}"{more}>{words}</text>'


def panel(curves, left, top, share, name, title):
    """One measure of all planners."""
    right, bottom = left + WIDE, top + HIGH
    yield f'<rect x="{left}" y="{top}" width="{WIDE}" height="{HIGH}" fill="none" stroke="#1a1a1a" stroke-width="0.8"/>'
    yield text(title, left, top - 9, 14)
    for metres in (5, 10, 20, 50, 100, 200, 500, 1000, 2000):
        x = along(metres, METRES, (left, right))
        yield f'<path d="M{x},{top}V{bottom}" stroke="#e4e4e4"/>' + text(f"{metres:,}", x, bottom + 16, anchor="middle")
    for error in (0.01, 0.1, 1, 10):
        y = along(error, ERRORS, (bottom, top))
        yield f'<path d="M{left},{y}H{right}" stroke="#e4e4e4"/>' + text(error, left - 6, y + 4, anchor="end")
    yield text("metres driven", (left + right) / 2, bottom + 34, anchor="middle")
    for (words, _, colour, dashes, (dx, dy, anchor)), (metres, values) in curves:
        dots = []
        for label in sorted(metres):
            ordered = values[label, name]
            error = ordered[math.ceil(share * len(ordered)) - 1]
            dots.append((along(metres[label], METRES, (left, right)), along(error, ERRORS, (bottom, top))))
        way = "M" + "L".join(f"{x},{y}" for x, y in dots)
        marks = "".join(f"M{x},{y}h0" for x, y in dots)
        yield f'<path d="{way}" fill="none" stroke="{colour}" stroke-width="1.6" stroke-dasharray="{dashes or "none"}"/>'
        yield f'<path d="{marks}" stroke="{colour}" stroke-width="4.6" stroke-linecap="round"/>'
        x, y = dots[-1]
        halo = f' fill="{colour}" stroke="#ffffff" stroke-width="3" paint-order="stroke" font-weight="bold"'
        yield text(words, x + dx, y + dy, 12, anchor, halo)


def main():
    if len(sys.argv) != 3:
        sys.exit(f"found {len(sys.argv) - 1} arguments, expected two: the program host-sim, and the figure to write")
    program, figure = sys.argv[1:]
    curves = [(curve, flown(program, curve[1])) for curve in CURVES]
    fields = len(next(iter(curves[0][1][1].values())))
    title = f"Error against metres, by the price of a label: {fields:,} fields of 800 m x 500 m, motions of 5 m"
    wide, high = 2 * (LEFT + WIDE) + 34, TOP + 2 * (HIGH + GAP) - 22
    drawn = [
        text(title, 16, 26, 16),
        text("Each dot is a label, 24 at most, and 400 motions at most. Down and to the left is better.", 16, 45, 12),
    ]
    for row, (share, spread) in enumerate(SPREADS):
        for column, (name, _, measure) in enumerate(MEASURES):
            left, top = LEFT + column * (LEFT + WIDE), TOP + row * (HIGH + GAP)
            drawn += panel(curves, left, top, share, name, f"{measure}: {spread}")
    body = "\n".join(drawn)
    Path(figure).write_text(
        f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {wide} {high}" width="{wide}" height="{high}" role="img" '
        f'font-family="Arial, Helvetica, \'DejaVu Sans\', sans-serif" fill="#1a1a1a">\n<title>{title}</title>\n'
        f'<rect width="{wide}" height="{high}" fill="#ffffff"/>\n{body}\n</svg>\n'
    )


main()

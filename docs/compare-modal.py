#!/usr/bin/env python3
"""modAL beside our planners, on the same standard fields in one run.

    python3 -m venv venv && venv/bin/pip install modAL-python==0.4.2.1 scikit-learn==1.5.2
    cargo build --release
    venv/bin/python docs/compare-modal.py target/release/host-sim

modAL 0.4.2.1 calls scikit-learn by an argument that newer ones do not have any more, so it needs an older one.

modAL asks for the label of whichever place of its pool is nearest to the line of a linear SVC (margin sampling): it
jumps, where our planners drive. Its estimate is the line of the SVC that all labels so far are fitted with. The slope
error is the angle between the estimated and the true line, in degrees; of ours that of the centre.
"""

import argparse
import csv
import math
import os
import statistics
import subprocess
import sys
import tempfile
import time
import warnings
from pathlib import Path

import numpy as np
import sklearn
from modAL.models import ActiveLearner
from modAL.uncertainty import margin_sampling
from sklearn.svm import SVC

SIDE = 20.0
POOL = 81  # places along each side of the area
LABELS = (10, 20)
PLANNERS = ("cfc", "lookahead")


class LinearSvc(SVC):
    """A hard-margin linear SVC whose classes are as likely as they are near: what margin sampling reads."""

    def __init__(self):
        super().__init__(kernel="linear", C=1e6)

    def predict_proba(self, places):
        likely = 1.0 / (1.0 + np.exp(-np.clip(self.decision_function(places), -500, 500)))
        return np.column_stack([1.0 - likely, likely])


def angle(normal, truth):
    """Between two lines by their normals, degrees."""
    cross = normal[0] * truth[1] - normal[1] * truth[0]
    dot = normal[0] * truth[0] + normal[1] * truth[1]
    return math.degrees(math.atan2(abs(cross), abs(dot)))


def by_modal(field, pool):
    """Slope errors after so many labels, and the processor's seconds for all queries."""
    number = {name: float(value) for name, value in field.items()}
    places = np.array([[number[f"x{k}"], number[f"z{k}"]] for k in range(1, 5)])
    labels = np.array([int(number[f"label{k}"]) for k in range(1, 5)])
    truth = np.array([number["a"], number["b"]])
    left, errors, seconds = pool.copy(), {}, 0.0
    began = time.process_time()
    learner = ActiveLearner(LinearSvc(), margin_sampling, places, labels)
    seconds += time.process_time() - began
    for asked in range(1, max(LABELS) + 1):
        began = time.process_time()
        index, place = learner.query(left)
        seconds += time.process_time() - began
        label = np.where(place @ truth + number["c"] > 0, 1, -1)
        left = np.delete(left, index, axis=0)
        began = time.process_time()
        learner.teach(place, label)
        seconds += time.process_time() - began
        if asked in LABELS:
            errors[asked] = angle(learner.estimator.coef_[0], truth)
    return errors, seconds


def by_us(program, planner, fields, folder):
    """Slope errors of the centre after so many steps, and the processor's seconds for a step, with all that is
    measured of it."""
    rows, steps = folder / f"{planner}.csv", max(LABELS)
    before = children_seconds()
    subprocess.run(
        [program, "campaign", "--algorithm", planner, "--fields", str(fields), "--steps", str(steps), "--csv", rows],
        check=True,
        stdout=subprocess.DEVNULL,
    )
    seconds = children_seconds() - before
    with open(rows, newline="") as file:
        found = [row for row in csv.DictReader(file) if int(row["step"]) in LABELS]
    errors = {at: [float(row["centre_deg"]) for row in found if int(row["step"]) == at] for at in LABELS}
    return errors, seconds / (fields * steps)


def children_seconds():
    """Seconds that processors have spent on programs that this one called."""
    used = os.times()
    return used.children_user + used.children_system


def main():
    arguments = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    arguments.add_argument("program", type=Path, help="host-sim")
    arguments.add_argument("--fields", type=int, default=100)
    arguments = arguments.parse_args()
    program = arguments.program.resolve()
    # modAL calls scikit-learn in an older way, which that tells at every query.
    warnings.simplefilter("ignore", FutureWarning)
    side = np.linspace(0.0, SIDE, POOL)
    pool = np.array([[x, z] for x in side for z in side])
    results = []
    with tempfile.TemporaryDirectory() as folder:
        folder = Path(folder)
        fields_csv = folder / "fields.csv"
        subprocess.run(
            [program, "campaign", "--fields", str(arguments.fields), "--steps", "1"]
            + ["--fields-csv", fields_csv],
            check=True,
            stdout=subprocess.DEVNULL,
        )
        with open(fields_csv, newline="") as file:
            fields = list(csv.DictReader(file))
        found = [by_modal(field, pool) for field in fields]
        errors = {at: [errors[at] for errors, _ in found] for at in LABELS}
        seconds = sum(seconds for _, seconds in found) / (len(fields) * max(LABELS))
        results.append((f"modAL, jumps in a pool of {len(pool)}", errors, seconds))
        for planner in PLANNERS:
            results.append((planner, *by_us(program, planner, len(fields), folder)))
    first, second = LABELS
    print(f"{len(fields)} standard fields, seed 1; scikit-learn {sklearn.__version__}, numpy {np.__version__}")
    print(f"| planner | slope error, median (90th percentile) at {first} labels | at {second} | processor seconds a query |")
    print("| --- | --- | --- | --- |")
    for name, errors, seconds in results:
        cells = []
        for at in LABELS:
            ninety = sorted(errors[at])[math.ceil(0.9 * len(errors[at])) - 1]
            cells.append(f"{statistics.median(errors[at]):.3g} ({ninety:.3g}) deg")
        print(f"| {name} | {cells[0]} | {cells[1]} | {seconds:.1e} |")


if __name__ == "__main__":
    sys.exit(main())

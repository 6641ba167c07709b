#!/usr/bin/env python3
"""Finds a line by asking `host-sim next` motion by motion. The robot here drives exactly and reads z > 0.41 x + 3.5."""

import json
import subprocess
import sys

mission = {
    "algorithm": "lookahead",
    "stop": {"slope_arc_deg": 1.0},
    "steps": 60,
    "oracle": [
        {"x": 2, "z": 1, "label": -1},
        {"x": 2, "z": 8, "label": 1},
        {"x": 18, "z": 16, "label": 1},
        {"x": 18, "z": 5, "label": -1},
    ],
}


def ask(request):
    program = sys.argv[1] if len(sys.argv) > 1 else "host-sim"
    done = subprocess.run([program, "next"], input=json.dumps(request), capture_output=True, text=True)
    if done.returncode:
        sys.exit(done.stderr)
    return json.loads(done.stdout)


answer = ask({**mission, "pose": {"x": 2, "z": 1, "heading": 0}})
while (motion := answer["next"]) is not None:
    pose = {key: motion[key] for key in ("x", "z", "heading")}  # drive there, and say where you are
    label = None
    if motion["label"]:
        label = 1 if pose["z"] > 0.41 * pose["x"] + 3.5 else -1  # read your sensor
    answer = ask({**mission, "pose": pose, "label": label, "state": answer["state"]})

line = answer["known"]["estimates"]["centre"]
print(f"{answer['stop']}: z = {line['slope']:.3f} x + {line['intercept']:.3f}")

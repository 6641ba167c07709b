#!/usr/bin/env python3
"""An ideal vehicle for a chip that plans, in a world with a straight line; by protocol.md.

It keeps what it has done, so a chip that restarts goes on where it was.
"""

import argparse
import math
import os
import random
import select
import socket
import sys

from wire import ENVELOPES, METRE, PROTOCOL, TO_CHIP, TO_VEHICLE, envelope, frame, unframe, write


def setup(args):
    """The paper's example: a square of 20 m, four given labels, a unicycle."""
    site = lambda x, z: [x * METRE, z * METRE]
    odds = round((math.log(args.p) - math.log1p(-args.p)) * 2**32) if args.p < 1 else 1000 << 32
    noise = {"reliability": odds, "trusted_radius": METRE // 2 if args.p < 1 else 0, "tolerance": 0}
    looks_ahead, taken = args.algorithm == "lookahead", args.steps * args.readings
    if args.p == 1:
        taken = min(taken, 64)
    is_fine = looks_ahead or args.algorithm == "track"
    if args.algorithm == "track":
        taken = 0  # it stores none
    front = {"front": [args.radius * 1000, 0], "noise": noise}
    return {
        "protocol": PROTOCOL,
        "algorithm": {
            "cfc": "Cfc",
            "scc": {"Scc": {"noise": noise, "prior": "Area", "policy": "MixtureOfOwn"}},
            "lookahead": {"Lookahead": {"evaluations": 512, "goal": None,
                                        "noise": [noise, "Area"] if args.p < 1 else None,
                                        "sight": {"far": None, "least": 0, "readings": args.readings}}},
            "track": {"Watch": {**front, "stretch": args.watch * 1000}} if args.watch
                     else {"Track": {**front, "ends": False}},
        }[args.algorithm],
        "config": {
            "area": [site(0, 0), site(20, 20)],
            "weight": 2_000 if looks_ahead else 100_000,
            "crossing": "Unrestricted",
            "following": "Unrestricted" if args.algorithm == "scc" else "AlongBisector",
            "tolerance": 0,
        },
        "keep_outs": None,
        "vehicle": {"Unicycle": {"turn_step_urad": 1 if is_fine else 10_000,
                                 "sharpest": 1 << 30, "speeds": 21, "speed_step_mm": 100}},
        "capacity": {"samples": 4 + taken,
                     "hypotheses": 1 + taken + taken * (taken - 1) // 2 if args.p < 1 else 1},
        "steps": args.steps,
        "most_labels": None,
        "start": {"site": site(2, 1), "heading": 0},
        "labels": "Vehicle",
        "given": [{"site": site(x, z), "label": label} for x, z, label in (
            (2, 1, "Negative"), (2, 8, "Positive"), (18, 16, "Positive"), (18, 5, "Negative"))],
    }


class Vehicle:
    """Reaches every target, reads labels on the way and there, and keeps what it has done."""

    def __init__(self, args):
        self.setup, self.args = setup(args), args
        self.made, self.asked, self.begun, self.labels, self.told = [], 0, 0, 0, 0
        self.site = self.setup["start"]["site"]
        self.end, self.is_dismissed, self.fronts = None, False, {}

    def read(self, site):
        slope, intercept = self.args.line
        above = site[1] / METRE - (slope * site[0] / METRE + intercept)
        self.labels += 1
        is_wrong = self.labels in self.args.wrong
        return {"Side": "Positive" if (above > 0) != is_wrong else "Negative"}

    def act(self, request, said):
        if request == "Ready":
            self.begun, self.asked = self.begun + 1, 0
            if self.begun > 1:
                print(f"the chip has restarted: it is told again what was done in {len(self.made)} steps")
            return "Noted"
        if request == "Declined":
            sys.exit(f"the chip declines: {said}")
        if request == "Front" and self.asked and not self.told:
            self.fronts[self.asked - 1] = said
            return "Noted"
        if request in ("Move", "End") and self.asked:
            if said["last"] != self.made[self.asked - 1][3]:
                sys.exit(f"step {self.asked}: the chip took in {said['last']}, which was not read")
        if request == "Move":
            motion = write("Motion", said["motion"])
            if self.asked == len(self.made):
                self.make(motion, said["motion"])
            self.asked, self.told = self.asked + 1, 0
            if self.made[self.asked - 1][0] != motion:
                sys.exit(f"step {self.asked}: the chip asks for another motion than before it restarted")
            return self.goes_on()
        if request == "Onward" and self.told:
            if said["last"] != self.made[self.asked - 1][1][self.told - 1]["reading"]:
                sys.exit(f"step {self.asked}: the chip took in {said['last']} on the way, which was not read")
            return self.goes_on()
        if request == "End":
            self.end = said
            return "Noted"
        sys.exit(f"{request}: the chip asks for what this mission has not")

    def goes_on(self):
        """The next label on the way, or the motion's end."""
        _, passed, pose, reading = self.made[self.asked - 1]
        if self.told < len(passed):
            self.told += 1
            return {"OnTheWay": passed[self.told - 1]}
        self.told = 0
        return {"Arrived": {"pose": pose, "reading": reading}}

    def make(self, motion, said):
        pose, site, begin = said["target"], said["target"]["site"], self.site
        passed = []
        for k in range(1, self.args.readings if site != begin else 1):
            at = [math.floor(a + (b - a) * (k / self.args.readings) + 0.5) for a, b in zip(begin, site)]
            passed.append({"site": at, "reading": self.read(at)})
        reading = self.read(site) if said["wants_label"] else None
        self.site = site
        self.made.append((motion, passed, pose, reading))
        label = {"Positive": "+1", "Negative": "-1"}[reading["Side"]] if reading else "none"
        x, z = site
        print(f"step {len(self.made)}: action {said['action']} to x {x / METRE:.4f}, "
              f"z {z / METRE:.4f} ({x}, {z}, {pose['heading']}), label {label}")


class Responder:
    """Acts on a request once, and answers it as often as it comes."""

    def __init__(self, vehicle):
        self.vehicle, self.session, self.last, self.reply = vehicle, random.getrandbits(32), None, None

    def hear(self, content):
        said, _ = envelope(content, {TO_VEHICLE: ENVELOPES[TO_VEHICLE]})
        if not said:
            return None
        session, number, [(request, what)] = said["session"], said["number"], said["message"].items()
        answer = lambda session, reply: frame(write(ENVELOPES[TO_CHIP], {
            "way": TO_CHIP, "session": session, "number": number, "message": reply}))
        on_offer = (self.session + 1) % 2**32 or 1
        if request == "Hello":
            if what["protocol"] != PROTOCOL:
                sys.exit(f"the chip speaks protocol {what['protocol']}, this vehicle {PROTOCOL}")
            self.vehicle.is_dismissed = self.vehicle.end is not None
            return None if self.vehicle.end else answer(on_offer, {"Setup": self.vehicle.setup})
        if session == on_offer:
            self.session, self.last = session, None
        elif session != self.session or self.last is None:
            return answer(session, "Stale")
        if self.last is not None and number < self.last:
            return answer(session, "Stale")
        if number != self.last:
            self.last, self.reply = number, answer(session, "Busy")
            self.reply = answer(session, self.vehicle.act(request, what))
        return self.reply


def connect(address):
    """A file descriptor of HOST:PORT or of a serial device."""
    if ":" in address:
        host, port = address.rsplit(":", 1)
        return socket.create_connection((host, int(port))).detach()
    import termios

    port = os.open(address, os.O_RDWR | os.O_NOCTTY)
    speed, raw = termios.B115200, termios.CS8 | termios.CREAD | termios.CLOCAL
    at_least = [1 if at == termios.VMIN else 0 for at in range(32)]
    termios.tcsetattr(port, termios.TCSANOW, [0, 0, raw, 0, speed, speed, at_least])
    return port


def fly(port, vehicle):
    responder, stuffed = Responder(vehicle), bytearray()
    # Once the mission is over the chip may not have heard that, until it asks for another.
    while not vehicle.is_dismissed and select.select([port], [], [], 2 if vehicle.end else 30)[0]:
        data = os.read(port, 512)
        if not data:
            break
        for byte in data:
            if byte:
                stuffed.append(byte)
                continue
            content, stuffed = unframe(bytes(stuffed)), bytearray()
            reply = content and responder.hear(content)
            while reply:
                reply = reply[os.write(port, reply) :]
    if not vehicle.end:
        sys.exit(f"the chip has been silent since step {len(vehicle.made)}")


def tell(end):
    print(f"ended: {end['reason']}")
    for name, line in end["estimates"].items():
        if line:
            about, (x, z), (m, b) = line
            c, s = x / math.hypot(x, z), z / math.hypot(x, z)
            exact = [*about, x, z, m, b]
            x, z = about[0] / METRE - b * s, about[1] / METRE + b * c
            slope = (s + m * c) / (c - m * s)
            print(f"{name}: z = {slope:.4f} x + {z - slope * x:.4f}, exactly", *exact)


def tell_map(fronts):
    """The map of a front: where it was known best after each step."""
    for step, front in fronts.items():
        if waist := front["waist"]:
            x, z = waist["site"][0] / METRE, waist["site"][1] / METRE
            exact = [*waist["site"], *list(waist.values())[1:]]
            print(f"vertex {step + 1}: x {x:.4f}, z {z:.4f}, deviation {waist['deviation']:.3f}, exactly", *exact)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("address", help="HOST:PORT, or a serial device")
    parser.add_argument("--algorithm", choices=["cfc", "scc", "lookahead", "track"], default="lookahead")
    parser.add_argument("--steps", type=int, default=10)
    parser.add_argument("--readings", type=int, default=1, help="labels a motion, the last at its end")
    parser.add_argument("--radius", type=int, default=40, help="of track: the tightest bend, metres")
    parser.add_argument("--watch", type=int, help="of track: metres of front to watch, instead of all of it")
    parser.add_argument("--p", type=float, default=1.0, help="how often labels are said to be right")
    parser.add_argument("--line", type=float, nargs=2, default=[0.41, 3.5], metavar=("SLOPE", "INTERCEPT"))
    parser.add_argument("--wrong", type=int, nargs="*", default=[], help="which labels are read wrong")
    args = parser.parse_args()
    if not 0 < args.p <= 1 or args.p < 1 and args.algorithm == "cfc":
        parser.error(f"--p: found {args.p}, expected a probability, and 1 with --algorithm cfc")
    if args.readings < 1:
        parser.error(f"--readings: found {args.readings}, expected 1 or more")
    if args.watch is not None and not (args.algorithm == "track" and 1 <= args.watch <= 10_000):
        parser.error(f"--watch: found {args.watch}, expected from 1 to 10000 m, with --algorithm track")
    sys.stdout.reconfigure(line_buffering=True)
    vehicle = Vehicle(args)
    try:
        fly(connect(args.address), vehicle)
    except (OSError, ValueError) as error:
        sys.exit(f"{args.address}: {error}")
    tell(vehicle.end)
    tell_map(vehicle.fronts)


if __name__ == "__main__":
    main()

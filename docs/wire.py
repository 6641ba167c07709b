#!/usr/bin/env python3
"""What goes over the wire: values, messages, frames; written from protocol.md beside this file.

    wire.py --vectors protocol.md      reads and writes the examples of that page
    wire.py --split "00 0c 21 ..."     tells a frame part by part
"""

import argparse
import re
import struct
import sys
import zlib

PROTOCOL = 11
METRE = 1 << 16


# Values. A type is the name of a number, a dict of fields, or one of these three.


class Optional:
    def __init__(self, of):
        self.of = of


class List:
    def __init__(self, of, most):
        self.of, self.most = of, most


class Choice:
    def __init__(self, **variants):
        self.variants = list(variants.items())


class Refused(Exception):
    pass


BITS = {"u16": 16, "u32": 32, "i32": 32, "i64": 64}


def write(kind, value):
    if isinstance(kind, dict):
        return b"".join(write(of, value[name]) for name, of in kind.items())
    if isinstance(kind, Optional):
        return b"\0" if value is None else b"\1" + write(kind.of, value)
    if isinstance(kind, List):
        return write("u32", len(value)) + b"".join(write(kind.of, each) for each in value)
    if isinstance(kind, Choice):
        index, of = next((i, of) for i, (name, of) in enumerate(kind.variants) if name == value[0])
        return bytes([index]) + (write(of, value[1]) if of else b"")
    if kind in ("u8", "bool"):
        return bytes([value])
    if kind == "f32":
        return struct.pack("<f", value)
    if kind.startswith("i"):
        value = 2 * value if value >= 0 else -2 * value - 1
    out = bytearray()
    while value > 127:
        out.append(value & 127 | 128)
        value >>= 7
    return bytes(out) + bytes([value])


class Reader:
    """Reads values, and takes down each part: its bytes, what it is called, what it says."""

    def __init__(self, data):
        self.data, self.at, self.parts = data, 0, []

    def take(self, count):
        taken = self.data[self.at : self.at + count]
        if len(taken) < count:
            raise Refused("it ends too early")
        self.at += count
        return taken

    def varint(self, bits):
        value = shift = 0
        while True:
            byte = self.take(1)[0]
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                break
        if value >> bits:
            raise Refused("a number is too large")
        return value

    def read(self, kind, name=""):
        if isinstance(kind, dict):
            return {it: self.read(of, f"{name}.{it}".strip(".")) for it, of in kind.items()}
        begin = self.at
        tell = lambda said: self.parts.append((self.data[begin : self.at], name, str(said)))
        if isinstance(kind, Optional):
            is_there = self.take(1)[0]
            if is_there > 1:
                raise Refused(f"{name}: neither there nor not")
            tell("some" if is_there else "none")
            return self.read(kind.of, name) if is_there else None
        if isinstance(kind, List):
            count = self.varint(32)
            if count > kind.most:
                raise Refused(f"{name}: too many")
            tell(count)
            return [self.read(kind.of, f"{name}[{i}]") for i in range(count)]
        if isinstance(kind, Choice):
            index = self.varint(32)
            if index >= len(kind.variants):
                raise Refused(f"{name}: no variant {index}")
            variant, of = kind.variants[index]
            tell(variant)
            if name == "message":
                name = "" if isinstance(of, dict) else variant.lower()
            return variant, self.read(of, name) if of else None
        if kind in ("u8", "bool"):
            value = self.take(1)[0]
            if kind == "bool" and value > 1:
                raise Refused(f"{name}: neither true nor false")
        elif kind == "f32":
            (value,) = struct.unpack("<f", self.take(4))
        else:
            value = self.varint(BITS[kind])
            if kind.startswith("i"):
                value = -(value + 1 >> 1) if value & 1 else value >> 1
        tell(f"{value:.6g}" if kind == "f32" else ["false", "true"][value] if kind == "bool" else value)
        return value


SITE = {"x": "i32", "z": "i32"}
POSE = {"site": SITE, "heading": "u32"}
LABEL = Choice(Negative=None, Positive=None)
READING = Choice(Side=LABEL, Boundary=None)
SAMPLE = {"site": SITE, "label": LABEL}
CAPACITY = {"samples": "u16", "hypotheses": "u16"}
TOOK = {"observe": "u32", "plan": "u32", "estimate": "u32"}
MOTION = {
    "stage": Optional(Choice(P1=None, P2=None, P3=None, P4=None, Audit=None, Seek=None, Follow=None,
                             Pass=None, Return=None)),
    "recovery": Optional(Choice(Undirected=None, Reorient=None, Transit=None)),
    "action": "u32",
    "control": {"v": "f32", "w": "f32"},
    "target": POSE,
    "wants_label": "bool",
    "examined": "u32",
    "proven": "bool",
}
LINE = {"about": SITE, "along": SITE, "slope": "f32", "intercept": "f32"}
WAIST = {"site": SITE, "heading": "u32", "curvature": "f32", "deviation": "f32",
         "turn_deviation": "f32"}
NO_SPACE = Choice(
    Collinear=None, OneLabel=None, NotSeparable="u32", TooMany=None, TooVague=None, Tolerance=None,
)
BAD_GRID = Choice(Actions=None, Reach=None, Turn=None, Circle=None)
NO_VEHICLE = Choice(Kind=None, Grid=BAD_GRID, Room={"across_mm": "u32"})
STOP = Choice(
    Resolution=None, SamplesFull=None, OutsideArea=None, Cornered=None, Known=None, Undecided=None,
    Tolerance=None, NoLine=None, Worth=None, Closed=None, OneLabel=None,
)
REFUSED = Choice(Contradiction=SAMPLE, Full=SAMPLE, Tolerance="u32", Reliability=None)
REQUEST = Choice(
    Hello={"protocol": "u16"},
    Outline={"number": "u8"},
    Ready={"capacity": CAPACITY, "clock": {"per_second": "u32", "emulated": "bool"}},
    Declined=Choice(
        Protocol="u16", Algorithm=None, Capacity=CAPACITY, Given=NO_SPACE, Labels=None,
        Vehicle=NO_VEHICLE, Area=None, Tolerance=None, Goal=None, Price=None,
    ),
    Move={"motion": MOTION, "last": Optional(READING), "took": TOOK},
    End={
        "reason": Choice(Steps=None, Stopped=STOP, Refused=REFUSED, Sensor=None, Vehicle=None,
                         Labels=None),
        "last": Optional(READING),
        "took": TOOK,
        "estimates": {name: Optional(LINE) for name in ("bisector", "centre", "maximum_margin")},
    },
    Onward={"last": Optional(READING)},
    Front={"waist": Optional(WAIST), "is_closed": "bool"},
)
NOISE = {"reliability": "i64", "trusted_radius": "u32", "tolerance": "u32"}
FRONT = {"radius_mm": "u32", "speed_um": "u32"}
POLICY = Choice(Joint=None, MixtureOfStart=None, MixtureOfOwn=None)
PRIOR = Choice(Area=None, Sequences=None)
FAR = {"price_mm": "u32", "labels": "u16"}
SIGHT = {"far": Optional(FAR), "least": "u16", "readings": "u8"}
GOAL = {"accuracy": Choice(SlopeArc="u32", Misclassified="u32"), "level": "u32"}
STEPS = {"turn_step_urad": "u32", "sharpest": "u32", "speeds": "u16", "speed_step_mm": "u32"}
CIRCLE = {"radius_mm": "u32", "shortest_mm": "u32", "turn_step_urad": "u32", "speeds": "u16",
          "speed_step_mm": "u32"}
SETUP = {
    "protocol": "u16",
    "algorithm": Choice(
        Cfc=None,
        Scc={"noise": NOISE, "policy": POLICY, "prior": PRIOR},
        Lookahead={"evaluations": "u32", "goal": Optional(GOAL),
                   "noise": Optional({"noise": NOISE, "prior": PRIOR}), "sight": SIGHT},
        Track={"front": FRONT, "noise": NOISE, "ends": "bool"},
        Watch={"front": FRONT, "noise": NOISE, "stretch_mm": "u32"},
    ),
    "config": {
        "area": {"min": SITE, "max": SITE},
        "varrho": "u32",
        "crossing": Choice(Unrestricted=None, AlongOracle=None, AcrossBisector=None),
        "following": Choice(Unrestricted=None, AlongBisector=None),
        "tolerance": "u32",
    },
    "keep_outs": Optional("u8"),
    "vehicle": Choice(Unicycle=STEPS, Boat=STEPS, Car=CIRCLE),
    "capacity": CAPACITY,
    "steps": "u16",
    "most_labels": Optional("u16"),
    "start": POSE,
    "labels": Choice(Vehicle=None, Chip=None),
    "given": List(SAMPLE, 16),
}
REPLY = Choice(
    Setup=SETUP,
    Outline={"corners": List(SITE, 8), "radius": "u32"},
    Arrived={"pose": POSE, "reading": Optional(READING)},
    Failed=None, Noted=None, Busy=None, Stale=None,
    OnTheWay={"site": SITE, "reading": Optional(READING)},
)
TO_VEHICLE, TO_CHIP = ord("?"), ord("!")
ENVELOPES = {way: {"way": "u8", "session": "u32", "number": "u32", "message": of}
             for way, of in ((TO_VEHICLE, REQUEST), (TO_CHIP, REPLY))}


# Frames.


def frame(content):
    rest = content + struct.pack("<I", zlib.crc32(content)) + b"\0"
    out = bytearray(b"\0")
    while rest:
        group = rest[: min(rest.index(0), 254)]
        out += bytes([len(group) + 1]) + group
        rest = rest[len(group) :] if len(group) == 254 else rest[len(group) + 1 :]
    return bytes(out + b"\0")


def unframe(stuffed):
    """What stood between two zeros; the content, or None if it is spoiled."""
    out = bytearray()
    while stuffed:
        code, group, stuffed = stuffed[0], stuffed[1 : stuffed[0]], stuffed[stuffed[0] :]
        if len(group) != code - 1:
            return None
        out += group + (b"\0" if code != 255 and stuffed else b"")
    content, check = bytes(out[:-4]), bytes(out[-4:])
    return content if content and check == struct.pack("<I", zlib.crc32(content)) else None


def envelope(content, ways=ENVELOPES):
    """An envelope and its parts; None if it is none, or goes another way."""
    reader = Reader(content)
    try:
        said = reader.read(ways[content[0]])
    except (Refused, KeyError):
        return None, []
    return (said, reader.parts) if reader.at == len(content) else (None, [])


# The page's examples.


def split(stuffed):
    """The lines of a frame's parts."""
    content = unframe(stuffed.strip(b"\0"))
    if content is None:
        sys.exit("this is no frame, or it is spoiled")
    said, parts = envelope(content)
    if said is None:
        sys.exit("this frame holds no message")
    if frame(write(ENVELOPES[said["way"]], said)) != stuffed:
        sys.exit("written again this message is another frame")
    parts.append((struct.pack("<I", zlib.crc32(content)), "", "check sum"))
    return [f"{part.hex(' '):17}  {name:30}  {text}" for part, name, text in parts]


def vectors(path):
    blocks = re.findall(r"\n```frame\n(.*?)\n(.*?)\n\n(.*?)\n```", open(path).read(), re.S)
    for name, stuffed, parts in blocks:
        if split(bytes.fromhex(stuffed)) != parts.split("\n"):
            sys.exit(f"{path}: {name}: read as\n" + "\n".join(split(bytes.fromhex(stuffed))))
    print(f"{len(blocks)} examples agree")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--vectors", help="check the examples of this page")
    what.add_argument("--split", help="a frame in hexadecimal digits")
    args = parser.parse_args()
    if args.vectors:
        vectors(args.vectors)
    else:
        print("\n".join(split(bytes.fromhex(args.split))))


if __name__ == "__main__":
    main()

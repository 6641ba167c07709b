#!/usr/bin/env python3
"""What goes over the wire: values, messages, frames. It reads the types from protocol.schema beside this file.

    wire.py --vectors              decodes the vectors of protocol.vectors, and encodes them again
    wire.py --split "00 0c 21 ..." shows a frame part by part
"""

import argparse
import json
import pathlib
import struct
import sys
import zlib

PROTOCOL = 12
METRE = 1 << 16
TO_VEHICLE, TO_CHIP = ord("?"), ord("!")
HERE = pathlib.Path(__file__).parent
BITS = {"u8": 8, "u16": 16, "u32": 32, "i32": 32, "i64": 64}


class Refused(Exception):
    pass


# A type is a name, a dict of fields, or one of these: ["choice", (variant, type or None), ...], ["tuple", type, ...],
# ["optional", type], ["list", most, type].


def parsed(words):
    word = words.pop(0)
    if word == "[":
        parts = ["tuple"]
        while words[0] != "]":
            parts.append(parsed(words))
        words.pop(0)
        return parts
    if word == "optional":
        return [word, parsed(words)]
    if word == "list":
        return [word, int(words.pop(0)), parsed(words)]
    return word


def schema(text):
    """Types by their names."""
    types = {}
    for line in text.split("\n"):
        words = line.split("#")[0].replace("[", " [ ").replace("]", " ] ").split()
        if not words:
            continue
        if line[0] != " ":
            kind = {"struct": {}, "choice": ["choice"]}.get(words[1])
            inside = types[words[0]] = parsed(words[2:]) if kind is None else kind
        elif isinstance(inside, dict):
            inside[words[0]] = parsed(words[1:])
        else:
            inside.append((words[1], parsed(words[2:]) if words[2:] else None))
    return types


TYPES = schema((HERE / "protocol.schema").read_text())
ENVELOPES = {TO_VEHICLE: TYPES["Envelope"], TO_CHIP: {**TYPES["Envelope"], "message": "Reply"}}


# Values, in the form of JSON. A choice is the name of its variant, or {name: what it has}.


def write(kind, value):
    if isinstance(kind, str) and kind in TYPES:
        return write(TYPES[kind], value)
    if isinstance(kind, dict):
        return b"".join(write(of, value[name]) for name, of in kind.items())
    if kind[0] == "choice":
        variant = value if isinstance(value, str) else [*value][0]
        index, of = next((i, of) for i, (it, of) in enumerate(kind[1:]) if it == variant)
        return bytes([index]) + (write(of, value[variant]) if of else b"")
    if kind[0] == "optional":
        return b"\0" if value is None else b"\1" + write(kind[1], value)
    if kind[0] == "list":
        return write("u32", len(value)) + b"".join(write(kind[2], each) for each in value)
    if kind[0] == "tuple":
        return b"".join(write(of, each) for of, each in zip(kind[1:], value))
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
        while shift < bits:
            byte = self.take(1)[0]
            value |= (byte & 127) << shift
            shift += 7
            if byte < 128:
                if value >> bits:
                    break
                return value
        raise Refused("a number is too large")

    def read(self, kind, name=""):
        begin = self.at
        note = lambda said: self.parts.append((self.data[begin : self.at], name, str(said)))
        if isinstance(kind, str) and kind in TYPES:
            return self.read(TYPES[kind], name)
        if isinstance(kind, dict):
            return {it: self.read(of, f"{name}.{it}".strip(".")) for it, of in kind.items()}
        if kind[0] == "choice":
            index = self.varint(32) + 1
            if index >= len(kind):
                raise Refused(f"{name}: no variant {index - 1}")
            variant, of = kind[index]
            note(variant)
            return {variant: self.read(of, f"{name}.{variant}")} if of else variant
        if kind[0] == "tuple":
            return [self.read(of, f"{name}[{i}]") for i, of in enumerate(kind[1:])]
        if kind[0] == "optional":
            is_there = self.take(1)[0]
            if is_there > 1:
                raise Refused(f"{name}: neither there nor not")
            note("some" if is_there else "none")
            return self.read(kind[1], name) if is_there else None
        if kind[0] == "list":
            count = self.varint(32)
            if count > kind[1]:
                raise Refused(f"{name}: too many")
            note(count)
            return [self.read(kind[2], f"{name}[{i}]") for i in range(count)]
        if kind in ("u8", "bool"):
            value = self.take(1)[0]
            if kind == "bool":
                if value > 1:
                    raise Refused(f"{name}: neither true nor false")
                value = bool(value)
        elif kind == "f32":
            (value,) = struct.unpack("<f", self.take(4))
        else:
            value = self.varint(BITS[kind])
            if kind.startswith("i"):
                value = -(value + 1 >> 1) if value & 1 else value >> 1
        note(f"{value:.6g}" if kind == "f32" else value)
        return value


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


# What this file does as a program.


def split(stuffed):
    """The lines of a frame's parts."""
    content = unframe(stuffed.strip(b"\0"))
    if content is None:
        sys.exit("this is no frame, or it is spoiled")
    said, parts = envelope(content)
    if said is None:
        sys.exit("this frame holds no message")
    parts.append((struct.pack("<I", zlib.crc32(content)), "", "check sum"))
    return [f"{part.hex(' '):17}  {name:30}  {text}" for part, name, text in parts]


def vectors():
    single = lambda text: struct.unpack("<f", struct.pack("<f", float(text)))[0]
    lines = (HERE / "protocol.vectors").read_text().splitlines()
    for line in lines:
        vector = json.loads(line, parse_float=single)
        sent = bytes.fromhex(vector["frame"])
        content = unframe(sent.strip(b"\0"))
        said = envelope(content)[0] if content else None
        expected = vector.get("envelope")
        if said != expected:
            sys.exit(f"{vector['name']}: read as {said}")
        if said and frame(write(ENVELOPES[said["way"]], expected)) != sent:
            sys.exit(f"{vector['name']}: encoded again it is another frame")
    print(f"{len(lines)} vectors agree")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    what = parser.add_mutually_exclusive_group(required=True)
    what.add_argument("--vectors", action="store_true", help="check protocol.vectors")
    what.add_argument("--split", help="a frame in hexadecimal digits")
    args = parser.parse_args()
    if args.vectors:
        vectors()
    else:
        print("\n".join(split(bytes.fromhex(args.split))))


if __name__ == "__main__":
    main()

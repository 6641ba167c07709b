#!/usr/bin/env python3
"""A simulated ArduPilot vehicle, by pymavlink alone: a rover, boat or submarine in guided mode, on a bad link, to which
things happen.

    python3 -m pip install pymavlink==2.4.50
    python3 tests/mavlink_vehicle.py

Reads a mission a line (JSON, see `Vehicle`). It answers each mission with a line when it is there, flies until it is told
`over`, and then prints what it was sent and whether it moved when it should not have. What it takes in guided mode, and how,
is what `Rover/GCS_MAVLink_Rover.cpp` and `ArduSub/GCS_MAVLink_Sub.cpp` of ArduPilot take.

The clock of the link is virtual, unless the mission names a `host`. Then messages come and go by standard input and output:

    send HEX        bytes for the vehicle; no answer
    until SECONDS   time passes until then, or until the vehicle's next bytes; the answer has the time and the bytes

So a mission is the same each time, however busy the machine is. With a `host` messages come and go by UDP in real time. The
vehicle's own clock counts its ticks. Each is a fifth of a second to the vehicle, and a fiftieth to the link.
"""

import collections
import heapq
import json
import math
import os
import random
import select
import socket
import struct
import sys
import time

os.environ["MAVLINK20"] = "1"
from pymavlink.dialects.v20 import common as mavlink  # noqa: E402

HASTE = 10.0  # seconds of its clock in a second of the link
CRAWL_HASTE = 3.0  # while it crawls
TICK = 0.02  # seconds of the link from one position to the next
SPEED = 3.0  # metres in a second of its clock
BRAKES = {"rover": 2.0, "boat": 2.0, "sub": 0.05}  # what it slows down by when it is to stop, as it coasts
CRAWL, CRAWL_GAIN = 0.3, 0.15  # of a leg with an S-curve, which each setpoint begins anew
SWAY = 0.3  # of a boat that holds its place in waves
LATE = 0.3  # seconds of the link that it delays at most
GUID_TIMEOUT = 3.0  # seconds of its clock after which a velocity is let go of

CRAFTS = {
    "rover": (mavlink.MAV_TYPE_GROUND_ROVER, 15, 4),
    "boat": (mavlink.MAV_TYPE_SURFACE_BOAT, 15, 4),
    "sub": (mavlink.MAV_TYPE_SUBMARINE, 4, 16),
}
POSITION, VELOCITY, ACCELERATION, YAW, YAW_RATE = 0x007, 0x038, 0x1C0, 0x400, 0x800
# Failures that a message of ours tells.
TOLD = {"mode", "disarm", "fence", "failsafe", "ekf", "restart"}
SLIDE = (3.3, 2.0)  # metres, within so many seconds of its clock


# Of these nothing more is sent, not even stops.
LEFT_ALONE = {"mode", "ekf", "restart"}


def f32(number):
    """A number in single precision, as messages have it."""
    return struct.unpack("<f", struct.pack("<f", number))[0]


class Vehicle:
    """Keys of a mission: `seed`, `craft`, `line` ([a, b, c], positive on the +1 side of a east + b north + c), `start`
    ([north, east, yaw]), `label` (a name, or "channel:N"); `drop`, `late`, `double`, probabilities of a message each way;
    `fault` and, for which setpoint of a new place it comes, `at`. For UDP `host`, an address of its own, and the `port`
    there to speak to, or null to be spoken to."""

    def __init__(self, mission):
        self.mission = mission
        self.random = random.Random(mission["seed"])
        self.socket, self.peer = None, None
        if mission["host"]:
            self.socket = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
            self.socket.bind((mission["host"], 0))
            self.peer = (mission["host"], mission["port"]) if mission["port"] else None
        self.mav = mavlink.MAVLink(None, srcSystem=1, srcComponent=mavlink.MAV_COMP_ID_AUTOPILOT1)
        self.type, self.guided, self.hold = CRAFTS[mission["craft"]]
        self.began = time.monotonic() if self.socket else 0.0
        self.now = self.next_tick = self.began  # of the link, seconds
        self.clock = 0.0  # its own, seconds
        self.under_way = []  # (when, number, is it for us, bytes)
        self.arrived = b""  # what came out of the link at its other end
        self.number = 0
        self.north, self.east, self.yaw = mission["start"]
        self.mode, self.armed, self.status = self.hold, False, mavlink.MAV_STATE_STANDBY
        self.goal = None  # ("go", north, east, yaw), ("turn", yaw) or ("speed", vn, ve, when)
        self.places, self.fault_at, self.fault_clock, self.told_at = [], None, None, None
        self.intervals, self.speed, self.breached = set(), (0.0, 0.0), False
        self.due = {}
        self.haste, self.crawl = HASTE, None  # (place, time in its first setpoint, when it was last begun anew)
        # What is told in the end.
        self.last = collections.deque(maxlen=6)  # what it took
        self.illicit = []  # what may never be sent
        self.early = 0  # setpoints before it was armed in guided mode
        self.reported = collections.deque(maxlen=400)  # places that it has said it is at
        self.first_stop = None  # after the failure
        self.stops = []  # when, since the last setpoint that is none
        self.ears = mavlink.MAVLink(None)  # hears what we are sent before the link loses any
        self.sent_stops = 0  # of those that are sent, since the last setpoint that is none
        self.track = []  # (when, metres)
        self.text_at = None  # when it says why
        self.overtaken, self.newest = 0, 0  # setpoints that a newer one has overtaken, and when that was sent
        self.restarted = 0  # setpoints that began a leg anew without need
        self.habits = dict.fromkeys(["coasted", "crawled", "swayed", "pivots"], 0)
        self.orders_after = 0  # setpoints that came when the link knew of the failure

    # The link.

    def launch(self, incoming, data):
        """A message begins its way, which may lose, delay and double it; when it arrives, if it does."""
        mission, arrival = self.mission, None
        if self.random.random() < mission["drop"]:
            return None
        for _ in range(2 if self.random.random() < mission["double"] else 1):
            late = self.random.uniform(0, LATE) if self.random.random() < mission["late"] else 0.0
            self.number += 1
            when = self.now + late
            heapq.heappush(self.under_way, (when, self.number, incoming, data))
            arrival = when if arrival is None else min(arrival, when)
        return arrival

    def say(self, message, tells=False):
        if self.fault() == "silent":
            return
        arrival = self.launch(False, message.pack(self.mav))
        if tells and arrival is not None and self.told_at is None:
            self.told_at = arrival

    def deliver(self):
        while self.under_way and self.under_way[0][0] <= self.now:
            _, _, incoming, data = heapq.heappop(self.under_way)
            if incoming:
                for message in self.mav.parse_buffer(data) or []:
                    self.take(message)
            else:
                self.arrived += data

    # What it is sent.

    def take(self, message):
        kind = message.get_type()
        self.last.append(f"{self.now - self.began:.3f}: {message}")
        if kind == "HEARTBEAT":
            if (message.get_srcSystem(), message.type) != (255, mavlink.MAV_TYPE_GCS):
                self.illicit.append("a heartbeat of another")
        elif kind == "COMMAND_LONG":
            if message.command != mavlink.MAV_CMD_SET_MESSAGE_INTERVAL:
                self.illicit.append(f"command {message.command}")
                return
            if (message.target_system, message.target_component) == (1, 1):
                self.intervals.add(int(message.param1))
                self.say(self.mav.command_ack_encode(message.command, 0, 0, 0, 255, 190))
        elif kind == "SET_POSITION_TARGET_LOCAL_NED":
            self.steer(message)
        else:
            self.illicit.append(kind)

    def is_stop(self, it):
        """Whether a setpoint is one that stops."""
        if self.mission["craft"] == "sub" and not it.type_mask & POSITION:
            # Velocities of zero do not stop Sub: the place where it is does.
            return (it.x, it.y) in self.reported
        return not it.type_mask & (VELOCITY | YAW_RATE) and (it.vx, it.vy, it.vz, it.yaw_rate) == (0, 0, 0, 0)

    def count_stops(self, data):
        """Counts the stops that are sent, also those that the link loses: one alone is too few."""
        for message in self.ears.parse_buffer(data) or []:
            if message.get_type() == "SET_POSITION_TARGET_LOCAL_NED":
                self.sent_stops = self.sent_stops + 1 if self.is_stop(message) else 0

    def steer(self, it):
        """As ArduPilot takes a setpoint."""
        if (it.target_system, it.target_component) != (1, 1):
            self.illicit.append("a setpoint for another")
            return
        has = {name: not it.type_mask & mask for name, mask in [
            ("position", POSITION), ("velocity", VELOCITY), ("acceleration", ACCELERATION),
            ("yaw", YAW), ("rate", YAW_RATE)]}
        is_stop = self.is_stop(it)
        if self.told_at is not None and self.now > self.told_at + LATE + 0.05:
            if not is_stop or self.mission["fault"] in LEFT_ALONE:
                self.orders_after += 1
        if self.mode != self.guided or not self.armed:
            self.early += self.fault() is None
            return
        if it.coordinate_frame != mavlink.MAV_FRAME_LOCAL_NED or has["acceleration"]:
            self.illicit.append("a setpoint that is not taken")
            return
        self.stops = self.stops + [self.clock] if is_stop else []
        self.overtaken += it.time_boot_ms < self.newest
        self.newest = max(self.newest, it.time_boot_ms)
        if is_stop and self.fault() is not None:
            self.first_stop = self.first_stop or self.now
        if has["position"]:
            self.goal = ("go", it.x, it.y, it.yaw if has["yaw"] and self.mission["craft"] == "sub" else None)
            if not is_stop:
                self.visit((it.x, it.y, it.yaw))
                self.begin_leg((it.x, it.y), it.time_boot_ms)
        elif has["velocity"]:
            # Rover makes a heading of the velocity unless yaw or its rate is told.
            if not (has["yaw"] or has["rate"]) and self.mission["craft"] != "sub":
                self.yaw = math.atan2(it.vy, it.vx)
            self.goal = ("speed", it.vx, it.vy, self.clock)
        elif has["yaw"] and self.mission["craft"] != "sub":
            self.goal = ("turn", it.yaw)
            self.visit((self.north, self.east, it.yaw))

    def begin_leg(self, place, told_at):
        """Sub begins its S-curve anew with each setpoint. Here it does so on one leg of a mission, which lasts."""
        left = math.hypot(place[0] - self.north, place[1] - self.east)
        if self.crawl is None:
            is_it = self.mission["craft"] == "sub" and len(self.places) == self.mission["at"]
            if is_it and self.mission["fault"] is None and left > 1:
                self.haste, self.crawl = CRAWL_HASTE, [place, told_at, self.clock]
        elif self.crawl[0] == place:
            # A setpoint that was lost is sent again after a second at rest.
            since = self.clock - 0.7 * CRAWL_HASTE
            moved = sum(way for when, way in self.track if when > since)
            is_under_way = self.haste == CRAWL_HASTE
            self.restarted += is_under_way and moved > 0.1 and 0 < told_at - self.crawl[1] < 9000
            self.crawl[2] = self.clock

    def visit(self, place):
        if not self.places or self.places[-1] != place:
            if place not in self.places[-3:]:  # a late one is no new place
                self.places.append(place)

    # What happens to it.

    def fault(self):
        return self.mission["fault"] if self.fault_at is not None else None

    def happen(self):
        if self.mode == self.hold and not self.armed and self.fault_at is None:
            # Its operator makes it ready, a step at a time.
            if self.now > self.began + 0.3:
                self.mode = self.guided
        elif not self.armed and self.fault_at is None:
            if self.now > self.began + 0.5:
                self.armed, self.status = True, mavlink.MAV_STATE_ACTIVE
        fault = self.mission["fault"]
        if fault not in (None, "car") and self.fault_at is None and len(self.places) >= self.mission["at"]:
            self.fault_at, self.fault_clock = self.now, self.clock
            if fault == "mode":
                self.mode, self.goal = self.hold, None
            elif fault == "disarm":
                self.armed, self.goal = False, None
            elif fault == "ekf":
                # Both in one heartbeat, and why a moment later.
                self.mode, self.goal, self.status = self.hold, None, mavlink.MAV_STATE_CRITICAL
                self.text_at = self.now + 0.3
            elif fault == "restart":
                self.status, self.armed, self.goal = mavlink.MAV_STATE_BOOT, False, None
            elif fault == "failsafe":
                self.status = mavlink.MAV_STATE_CRITICAL
            elif fault == "fence":
                self.breached = True
            elif fault == "interrupt":
                self.tell({"interrupt": True})

    def drive(self, seconds):
        """So long by its clock."""
        before, craft = (self.north, self.east), self.mission["craft"]
        kind, *goal = self.goal if self.goal and self.armed and self.mode == self.guided else (None,)
        is_braking = kind is None or kind == "speed" and (
            goal[:2] == [0, 0] or self.clock - goal[2] >= GUID_TIMEOUT)
        if self.fault() == "stuck":
            pass
        elif is_braking:
            speed = math.hypot(*self.speed)
            part = max(0.0, speed - BRAKES[craft] * seconds) / speed if speed else 0.0
            self.north += part * self.speed[0] * seconds
            self.east += part * self.speed[1] * seconds
            self.habits["coasted"] += part * speed * seconds
        elif kind == "go":
            north, east, yaw = goal
            left = math.hypot(north - self.north, east - self.east)
            if left > 0:
                self.yaw = math.atan2(east - self.east, north - self.north)
            speed = SPEED
            if self.crawl and self.crawl[0] == (north, east):
                speed = min(CRAWL, CRAWL_GAIN * (self.clock - self.crawl[2]))
                self.habits["crawled"] += min(left, speed * seconds)
            if left <= speed * seconds:
                self.north, self.east = north, east
            else:
                part = speed * seconds / left
                self.north += part * (north - self.north)
                self.east += part * (east - self.east)
            if yaw is not None:
                self.yaw = yaw
        elif kind == "turn":
            # What steers like a car does not turn on the spot.
            if self.mission["fault"] == "car":
                if abs(math.remainder(goal[0] - self.yaw, math.tau)) > 0.1:
                    self.fault_at = self.fault_at or self.now
                    self.habits["pivots"] += 1
            else:
                self.yaw = goal[0]
        else:
            self.north += goal[0] * seconds
            self.east += goal[1] * seconds
        way = math.hypot(self.north - before[0], self.east - before[1])
        self.speed = ((self.north - before[0]) / seconds, (self.east - before[1]) / seconds)
        self.track.append((self.clock, way))

    def slid(self):
        """How far its positions have slid to the north, with its estimator."""
        if self.fault() != "slide":
            return 0.0
        metres, seconds = SLIDE
        return metres * min((self.clock - self.fault_clock) / seconds, 1.0)

    # What it says.

    def speak(self):
        ms = round(self.clock * 1000) + 1000
        fault = self.fault()
        every = lambda what, seconds: self.now >= self.due.get(what, 0) and not self.due.update({what: self.now + seconds})
        if fault != "heartless" and every("heartbeat", 0.2):
            base = mavlink.MAV_MODE_FLAG_CUSTOM_MODE_ENABLED
            base |= mavlink.MAV_MODE_FLAG_SAFETY_ARMED if self.armed else 0
            self.say(self.mav.heartbeat_encode(self.type, mavlink.MAV_AUTOPILOT_ARDUPILOTMEGA, base, self.mode, self.status),
                     fault in TOLD - {"fence"})
            # Others on the same link, of which nothing counts.
            other = mavlink.MAVLink(None, srcSystem=1, srcComponent=mavlink.MAV_COMP_ID_GIMBAL)
            self.launch(False, other.heartbeat_encode(mavlink.MAV_TYPE_GIMBAL, mavlink.MAV_AUTOPILOT_INVALID, 0, 0, 4).pack(other))
            other = mavlink.MAVLink(None, srcSystem=7, srcComponent=1)
            self.launch(False, other.local_position_ned_encode(ms + 10**6, 9, 9, 9, 9, 9, 9).pack(other))
        if 162 in self.intervals and every("fence", 0.2):
            self.say(self.mav.fence_status_encode(int(self.breached), int(self.breached), 0, 0,
                     2 if fault == "held" else 1), fault == "fence")
        if 32 in self.intervals and fault != "lost":
            north, east = f32(self.north + self.slid()), f32(self.east)
            self.reported.append((north, east))
            sway = 0.0
            if self.mission["craft"] == "boat" and self.mission["fault"] is None:
                self.habits["swayed"] += 1
                sway = SWAY if self.habits["swayed"] % 4 < 2 else -SWAY
            self.say(self.mav.local_position_ned_encode(ms, north, east, 0, self.speed[0] + sway, self.speed[1], 0))
        if self.text_at is not None and self.text_at <= self.now < self.text_at + 0.3:
            self.say(self.mav.statustext_encode(mavlink.MAV_SEVERITY_CRITICAL, b"EKF failsafe"))
        if 30 in self.intervals:
            yaw = math.remainder(self.yaw, math.tau)
            self.say(self.mav.attitude_encode(ms, 0, 0, yaw, 0, 0, 0))
        if fault != "mute" and every("label", 0.04):
            a, b, c = self.mission["line"]
            is_above = (a * self.east + b * self.north + c > 0) != (fault == "lie")
            name = self.mission["label"]
            if not name.startswith("channel:"):
                self.say(self.mav.named_value_float_encode(ms, name.encode(), 1.0 if is_above else -1.0))
            elif 65 in self.intervals:
                channels = [1500] * 18
                channels[int(name[8:]) - 1] = 1900 if is_above else 1100
                self.say(self.mav.rc_channels_encode(ms, 18, *channels, 0))

    def tell(self, what):
        print(json.dumps(what), flush=True)

    def next_event(self):
        return min([self.next_tick] + [it[0] for it in self.under_way[:1]])

    def go_on(self, now):
        """What happens at a time of the link."""
        self.now = now
        self.deliver()
        if now >= self.next_tick:
            self.next_tick = max(self.next_tick + TICK, now)
            if self.crawl and (self.north, self.east) == self.crawl[0]:
                self.haste = HASTE
            self.clock += TICK * self.haste
            self.happen()
            self.drive(TICK * self.haste)
            self.speak()
            self.deliver()

    def hear(self, data):
        self.count_stops(data)
        self.launch(True, data)

    def advance(self, until):
        """Time passes until then, or until something arrives at the other end of the link."""
        while not self.arrived and self.next_event() <= until:
            self.go_on(max(self.now, self.next_event()))
        self.now = self.now if self.arrived else until

    def fly_in_virtual_time(self):
        self.tell({"there": True})
        for line in iter(sys.stdin.readline, ""):
            order, _, argument = line.strip().partition(" ")
            if order == "over":
                break
            if order == "send":
                self.hear(bytes.fromhex(argument))
                continue
            self.advance(float(argument))
            self.tell([self.now, self.arrived.hex()])
            self.arrived = b""

    def fly_in_real_time(self):
        self.tell({"port": self.socket.getsockname()[1]})
        is_over = False
        while not is_over:
            wait = max(0.0, self.next_event() - time.monotonic())
            ready, _, _ = select.select([self.socket, sys.stdin], [], [], wait)
            self.now = time.monotonic()
            if self.socket in ready:
                data, peer = self.socket.recvfrom(2048)
                self.peer = self.peer or peer
                self.hear(data)
            is_over = sys.stdin in ready and sys.stdin.readline() != ""
            self.go_on(self.now)
            if self.peer and self.arrived:
                try:
                    self.socket.sendto(self.arrived, self.peer)
                except ConnectionRefusedError:
                    pass
            self.arrived = b""
        self.socket.close()

    def fly(self):
        if self.socket:
            self.fly_in_real_time()
        else:
            self.fly_in_virtual_time()
        # What is under way arrives yet.
        ends_at = self.now + 2 * LATE
        while self.next_event() <= ends_at:
            self.go_on(max(self.now, self.next_event()))
        # From the last of its setpoints on there were stops alone: what may be late has come by then.
        stopped = self.stops[0] + (LATE + 0.1) * HASTE if self.stops and self.sent_stops > 1 else None
        moved_after = sum(way for when, way in self.track if stopped is not None and when > stopped)
        reacted = None
        if self.told_at is not None and self.first_stop is not None:
            reacted = self.first_stop - self.told_at
        self.tell({
            "illicit": self.illicit, "early": self.early, "happened": self.fault_at is not None,
            "was_stopped": stopped is not None, "moved_after": moved_after,
            "orders_after": self.orders_after, "reacted": reacted,
            "restarted": self.restarted, "overtaken": self.overtaken, "habits": self.habits,
            "last": list(self.last),
        })


for line in iter(sys.stdin.readline, ""):
    Vehicle(json.loads(line)).fly()

#!/usr/bin/env python3
"""A flight of host-sim against ArduPilot's own simulation: starts it, arms it in guided mode, has something happen, and
watches what the vehicle does after.

    python3 -m pip install pymavlink==2.4.50
    python3 tests/ardupilot_flight.py SIMULATORS HOST_SIM FOLDER '{"craft": "skid", "link": "udp", ...}'

SIMULATORS has `ardurover`, `ardusub` and `params/` with ArduPilot's parameters of its frames. FOLDER has the scenario,
`m.toml`; logs and the trace `t.jsonl` go there. Keys: `craft` (skid, car, boat, sub), `link` (udp, tcp, serial), `number`
(below 256, apart from others that run beside it), `speedup`, `wind` (metres a second), `line` (slope and intercept: a Lua script on the
vehicle tells its side as `WET`, by the position that it estimates), `is_true` (channel 7 of the remote control tells it instead, by
the true position), `params`, `by_hand` (drives of the operator before the flight, in MANUAL: steering and throttle in microseconds, and seconds,
with a rest after each), `event` (see `happen`), `at` (metres from where it began) and `after` (seconds of the
vehicle's clock). What came of it is a line of JSON.
"""

import json
import math
import os
import select
import signal
import socket
import struct
import subprocess
import sys
import threading
import time
import tty

from pymavlink import mavutil

# It says so without end when a vehicle is started anew.
mavutil.print = lambda *_, **__: None

CRAFTS = {
    # program, frame, parameters, number of GUIDED, of HOLD or what stops Sub
    "skid": ("ardurover", "rover-skid", ["rover", "rover-skid"], 15, 4),
    "car": ("ardurover", "rover", ["rover"], 15, 4),
    "boat": ("ardurover", "motorboat", ["rover", "motorboat"], 15, 4),
    "sub": ("ardusub", "vectored", ["sub"], 4, 16),
}

LABEL = """
local function update()
  local p = ahrs:get_relative_position_NED_origin()
  if p then gcs:send_named_float('WET', p:x() - (SLOPE * p:y() + INTERCEPT)) end
  return update, 200
end
return update()
"""


def bridge(port, name):
    """A serial line: a pseudo-terminal, with the simulation's port at its other end."""
    ours, theirs = os.openpty()
    tty.setraw(ours)
    tty.setraw(theirs)
    os.symlink(os.ttyname(theirs), name)

    def carry():
        while True:
            try:
                link = socket.create_connection(("127.0.0.1", port))
                break
            except OSError:
                time.sleep(0.3)
        while True:
            ready, _, _ = select.select([ours, link], [], [])
            try:
                if ours in ready:
                    link.sendall(os.read(ours, 4096))
                if link in ready:
                    data = link.recv(4096)
                    if not data:
                        return
                    os.write(ours, data)
            except OSError:
                return

    threading.Thread(target=carry, daemon=True).start()


class Operator:
    """Whoever stands beside the vehicle: a second ground station, of another number than ours."""

    def __init__(self, port, line, remote, is_true):
        self.state = {"n": 0.0, "e": 0.0, "v": 0.0, "ms": 0, "mode": None, "armed": False, "ekf": 0, "texts": []}
        self.link = None
        until = time.time() + 30
        while self.link is None and time.time() < until:
            try:
                self.link = mavutil.mavlink_connection(f"tcp:127.0.0.1:{port}", source_system=254, source_component=191, retries=0)
            except OSError:
                time.sleep(0.25)
        if self.link is None:
            raise SystemExit("the simulation does not open its second port")
        self.is_over, self.heard = False, set()
        # Where it truly began is the origin of its numbers, give or take what its receiver errs by.
        self.line, self.remote, self.is_true, self.home = line, remote, is_true, (-35.363261, 149.165230)
        self.thread = threading.Thread(target=self.hear, daemon=True)
        self.thread.start()

    def hear(self):
        beat = 0.0
        while not self.is_over:
            if time.time() > beat:
                beat = time.time() + 1
                self.link.mav.heartbeat_send(6, 8, 0, 0, 4)
            it = self.link.recv_match(blocking=True, timeout=0.2)
            if it is None or it.get_srcSystem() != 1:
                continue
            kind, state = it.get_type(), self.state
            self.heard.add(kind)
            if kind == "HEARTBEAT" and it.get_srcComponent() == 1:
                state.update(mode=mavutil.mode_string_v10(it), armed=bool(it.base_mode & 128))
            elif kind == "LOCAL_POSITION_NED":
                state.update(n=it.x, e=it.y, v=math.hypot(it.vx, it.vy), ms=it.time_boot_ms)
            elif kind == "SIMSTATE" and self.is_true:
                north = (it.lat / 1e7 - self.home[0]) * 111319.5
                east = (it.lng / 1e7 - self.home[1]) * 111319.5 * math.cos(math.radians(self.home[0]))
                is_above = north > self.line[0] * east + self.line[1]
                self.move(1500, 1500, 1900 if is_above else 1100)
            elif kind == "EKF_STATUS_REPORT":
                state["ekf"] = it.flags
            elif kind == "STATUSTEXT":
                state["texts"].append(it.text)

    def wait(self, condition, seconds):
        """Waits for something, so long at most. Returns whether it is so."""
        until = time.time() + seconds
        while not condition() and time.time() < until:
            time.sleep(0.01)
        return condition()

    def command(self, number, *values):
        self.link.mav.command_long_send(1, 1, number, 0, *(list(values) + [0] * 7)[:7])

    def set(self, name, value):
        self.link.mav.param_set_send(1, 1, name.encode(), float(value), 9)

    def move(self, steering, throttle, seventh=1100):
        """The sticks of the remote control, microseconds."""
        channels = [steering, 1500, throttle, 1500, 1500, 1500, seventh, 1800]
        socket.socket(socket.AF_INET, socket.SOCK_DGRAM).sendto(struct.pack("<8H", *channels), self.remote)

    def drive(self, drives, guided):
        """Drives by hand, and rests after each drive: seconds of the vehicle's clock."""
        self.ready(0, "MANUAL")
        for steering, throttle, seconds in [(1500, 1500, 0)] + drives:
            for sticks, lasts in [((steering, throttle), seconds), ((1500, 1500), 5)]:
                until = self.state["ms"] + 1e3 * lasts
                while self.state["ms"] < until:
                    self.move(*sticks)
                    time.sleep(0.02)
        self.ready(guided)

    def ready(self, guided, mode="GUIDED"):
        until = time.time() + 60
        self.wait(lambda: self.state["ekf"] & 0x10, 60)
        is_armed = lambda: self.state["armed"] and self.state["mode"] == mode
        while not is_armed() and time.time() < until:
            self.link.set_mode(guided)
            self.wait(lambda: self.state["mode"] == mode, 0.3)
            self.command(400, 1)
            self.wait(is_armed, 0.7)

    def happen(self, event, vehicle, program, hold):
        kind, _, argument = event.partition(":")
        if kind == "hold":
            self.link.set_mode(hold)
        elif kind == "disarm":
            self.command(400, 0, 21196)
        elif kind == "interrupt":
            program.send_signal(signal.SIGINT)
        elif kind == "kill":
            program.kill()
        elif kind == "freeze":
            vehicle.send_signal(signal.SIGSTOP)
        elif kind == "reboot":
            self.command(246, 1, 0, 0, 0, 0, 20190226)
        elif kind == "param":
            self.set(*argument.split("="))
        else:
            raise SystemExit(f"event: found {event!r}, expected hold, disarm, interrupt, kill, freeze, reboot or param:NAME=VALUE")


def main():
    simulators, program, folder = (os.path.abspath(it) for it in sys.argv[1:4])
    flight = json.loads(sys.argv[4])
    binary, frame, defaults, guided, hold = CRAFTS[flight["craft"]]
    number, link, (slope, intercept) = flight["number"], flight["link"], flight["line"]
    os.makedirs(folder + "/scripts")
    with open(folder + "/scripts/wet.lua", "w") as script:
        script.write(LABEL.replace("SLOPE", str(slope)).replace("INTERCEPT", str(intercept)))
    params = {"SCR_ENABLE": 1, "SIM_WIND_SPD": flight.get("wind", 0), "SIM_WIND_DIR": 90, **flight.get("params", {})}
    with open(folder + "/own.parm", "w") as own:
        own.writelines(f"{name} {value}\n" for name, value in params.items())
    files = [f"{simulators}/params/{it}.parm" for it in defaults] + [folder + "/own.parm"]
    base, port = 5760 + 10 * number, 14551 + 10 * number
    address = {"udp": f"udp:127.0.0.1:{port}", "tcp": f"tcp:127.0.0.1:{base}", "serial": f"serial:{folder}/tty:57600"}[link]
    if link == "serial":
        bridge(base, folder + "/tty")
    vehicle = subprocess.Popen(
        [f"{simulators}/{binary}", "--model", frame, "--speedup", str(flight["speedup"]), "--slave", "0",
         "--defaults", ",".join(files), "--sim-address=127.0.0.1", f"-I{number}", "-w",
         "--home", "-35.363261,149.165230,584,353", "--serial0", f"udpclient:127.0.0.1:{port}" if link == "udp" else "tcp:0",
         "--serial1", "tcp:2"],
        cwd=folder, stdout=open(folder + "/vehicle.log", "w"), stderr=subprocess.STDOUT)
    try:
        is_true, drives = flight.get("is_true"), flight.get("by_hand")
        operator = Operator(base + 2, flight["line"], ("127.0.0.1", 5501 + 10 * number), is_true)
        # Until it has heard of each: a position, the estimator's state, and where the vehicle truly is.
        needs = {"LOCAL_POSITION_NED": 32, "EKF_STATUS_REPORT": 193, **({"SIMSTATE": 164} if is_true else {})}
        until = time.time() + 60
        while not needs.keys() <= operator.heard and time.time() < until:
            for kind in needs.keys() - operator.heard:
                operator.command(511, needs[kind], 1e5)
            operator.wait(lambda: needs.keys() <= operator.heard, 0.5)
        fly = subprocess.Popen(
            [program, "fly", "m.toml", "--mavlink", address, "--label", "channel:7" if is_true else "WET", "--trace", "t.jsonl", "--wait", "90"]
            + ["--by-hand"] * bool(drives),
            cwd=folder, stdout=open(folder + "/out.txt", "w"), stderr=open(folder + "/said.txt", "w"))
        if drives:
            operator.drive(drives, guided)
        operator.ready(guided)
        state, began, event = operator.state, time.time(), flight.get("event")
        from_there = (state["n"], state["e"])
        while fly.poll() is None and time.time() < began + flight.get("limit", 200):
            way = math.hypot(state["n"] - from_there[0], state["e"] - from_there[1])
            if event and way > flight.get("at", 0) and state["v"] > 0.3:
                operator.happen(event, vehicle, fly, hold)
                event = None
            time.sleep(0.01)
        if fly.poll() is None:
            fly.send_signal(signal.SIGINT)
            fly.wait(20)
        ended, then = (state["n"], state["e"]), state["ms"]
        # A vehicle that is frozen, or was started anew, has no such time.
        operator.wait(lambda: state["ms"] > then + 1e3 * flight.get("after", 4), 3)
        operator.is_over = True
        with open(folder + "/said.txt") as said:
            text = said.read()
        print(json.dumps({
            "status": fly.returncode, "said": text,
            "moved_after": round(math.hypot(state["n"] - ended[0], state["e"] - ended[1]), 2),
            "mode": state["mode"], "armed": state["armed"], "happened": event is None, "texts": state["texts"][-6:]}))
    finally:
        vehicle.send_signal(signal.SIGCONT)
        vehicle.kill()
        vehicle.wait()


main()

#!/usr/bin/env python3
"""Makes harbour-oil.csv: python3 harbour-oil.py > harbour-oil.csv

A boat goes up and down across the edge of an oil sheen and notes time, position and fluorescence once in a while.
The edge is straight, through (900, 420) m east and north of 53.5300 N, 9.9300 E, at 28 degrees from east to north,
with oil to its north. Positions err by 1.5 m (standard deviation, an axis), and one label in twenty is wrong.
"""

import math
import random

random.seed(13)
LAT, LON = 53.53, 9.93
ANGLE, EAST, NORTH = math.radians(28.0), 900.0, 420.0

# Radii of curvature of the WGS84 ellipsoid there, along the meridian and across it.
A, E2 = 6378137.0, 0.00669437999014
W = 1.0 - E2 * math.sin(math.radians(LAT)) ** 2
ALONG, ACROSS = A * (1.0 - E2) / W**1.5, A / W**0.5

print("# Made by harbour-oil.py: the edge of an oil sheen, crossed by a boat. One label in twenty is wrong.")
print("time;lat;lon;speed_kn;fluorescence_ppb;oil")
clock = 9 * 3600
for leg in range(12):
    for step in range(20):
        north = 40.0 * (step if leg % 2 == 0 else 19 - step) + random.uniform(-12.0, 12.0)
        east = 150.0 * leg + random.uniform(-20.0, 20.0)
        off = (north - NORTH) * math.cos(ANGLE) - (east - EAST) * math.sin(ANGLE)
        oil = (off > 0.0) != (random.random() < 0.05)
        ppb = random.gauss(42.0, 6.0) if oil else random.gauss(8.0, 3.0)
        seen_east, seen_north = (v + random.gauss(0.0, 1.5) for v in (east, north))
        lat = LAT + math.degrees(seen_north / ALONG)
        lon = LON + math.degrees(seen_east / (ACROSS * math.cos(math.radians(LAT))))
        hour, minute, second = clock // 3600, clock // 60 % 60, clock % 60
        print(
            f"{hour:02}:{minute:02}:{second:02};{lat:.6f};{lon:.6f};"
            f"{random.gauss(4.0, 0.3):.1f};{max(ppb, 0.1):.1f};{'yes' if oil else 'no'}"
        )
        clock += random.randint(18, 24)

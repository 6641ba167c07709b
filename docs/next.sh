#!/bin/sh
# Finds a line by asking `host-sim next` motion by motion; needs jq. The robot here drives exactly and reads z > 0.41 x + 3.5.
set -eu
next() { "${1:-host-sim}" next; }

mission='{
  "algorithm": "lookahead", "stop": { "slope_arc_deg": 1.0 }, "steps": 60,
  "oracle": [
    { "x": 2, "z": 1, "label": -1 }, { "x": 2, "z": 8, "label": 1 },
    { "x": 18, "z": 16, "label": 1 }, { "x": 18, "z": 5, "label": -1 }
  ]
}'
answer=$(echo "$mission" | jq '.pose = { x: 2, z: 1, heading: 0 }' | next "$@")
while [ "$(echo "$answer" | jq '.next != null')" = true ]; do
  # Drive to .next, and say where you are and what your sensor reads there.
  answer=$(echo "$answer" | jq --argjson mission "$mission" '$mission + {
    state,
    pose: .next | { x, z, heading },
    label: (.next | if .label then (if .z > 0.41 * .x + 3.5 then 1 else -1 end) else null end)
  }' | next "$@")
done
echo "$answer" | jq -r '"\(.stop): z = \(.known.estimates.centre | "\(.slope) x + \(.intercept)")"'

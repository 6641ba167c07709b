//! Help texts beyond the flags: examples first, then the meaning of exit statuses.

pub(crate) const MAIN: &str = "\
Examples:
  host-sim                                     the paper's examples, figures in out/
  host-sim init                                writes mission.toml, a commented scenario to begin with
  host-sim run mission.toml --figure m.svg     runs and draws it
  host-sim campaign --compare cfc,lookahead    two planners on the same 1,000 fields
  host-sim replay samples.csv                  what samples of your own determine

Exit status:
  0    done
  1    a flight that failed: the vehicle was stopped, what was flown is written
  2    bad input, or an output that cannot be written; one message says which. Also a label that contradicts
       what is known: what was flown until then is printed and written
  129, 130, 143    ended by SIGHUP, SIGINT (Ctrl-C) or SIGTERM; no file is left half written

Files: what a command computes (--figure, --report, --trace, --mcap, --map, --geojson, --timing) replaces a file that is
there. What took someone's time does not: a scenario (init) unless --force says so, and the rows of a campaign (--csv).

Colours and progress bars are for terminals alone; NO_COLOR=1 turns colours off there too.";

pub(crate) const RUN: &str = "\
Examples:
  host-sim run mission.toml
  host-sim run mission.toml --algorithm lookahead --steps 30 --figure m.svg
  host-sim run mission.toml --report m.html    a page to step through, for a browser
  host-sim run mission.toml --live             the same page while the mission is flown, a step each second
  host-sim run mission.toml --compare cfc,lookahead --report m.html
  host-sim run mission.toml --trace m.jsonl --mcap m.mcap
  host-sim run mission.toml --format flat > steps.jsonl
      then, in Python: pandas.read_json('steps.jsonl', lines=True)

With --live the program prints a link, and does not wait for anyone to open it. Who comes late sees all of the mission. When
it has ended and those who watch have got its end, the program ends; their pages stay as they are.

The scenario file is described in docs/reference/scenario.md; `host-sim init` writes one to begin with.";

pub(crate) const NEXT: &str = "\
Examples:
  echo '{\"oracle\": [], \"pose\": {\"x\": 2, \"z\": 1}}' | host-sim next
  host-sim next lake.toml < request.json
      the same, with what the request does not say from a scenario file

A request has the keys of a scenario, and `pose`. The answer says the next motion and has a `state`. The next request is
the same with that state, the `pose` where the motion ended and the `label` that was read there. See docs/reference/next.md.";

pub(crate) const HIL: &str = "\
Examples:
  host-sim hil mission.toml --emulator         the firmware under QEMU; it is built where needed
  host-sim hil mission.toml --port /dev/ttyUSB0
  host-sim hil mission.toml --emulator --fault drop=0.1,delay=20ms --timing t.csv
  host-sim hil mission.toml --port /dev/ttyUSB0 --trace t.jsonl --resume    goes on where it was stopped
  host-sim hil mission.toml --port /dev/ttyUSB0 --live    a page that shows the mission while it is flown";

#[cfg(feature = "mavlink")]
pub(crate) const FLY: &str = "\
Examples:
  host-sim fly mission.toml --dry-run --label WET       what an ideal vehicle would be sent
  host-sim fly mission.toml --mavlink udp:127.0.0.1:14550 --label WET
  host-sim fly mission.toml --mavlink serial:/dev/ttyUSB0:57600 --label channel:7 --trace t.jsonl
  host-sim fly mission.toml --mavlink udp:127.0.0.1:14550 --label WET --live    a page that shows it

The scenario's x points east and its z north of the origin of the vehicle's local position. It needs a tolerance, how far
that position may be off, and no truth. A dry run takes its labels from the truth, or else from a line that the oracle's
points leave: without points of both labels it may need a truth. The mission begins where the vehicle is, once its operator
has armed it in guided mode: this program does neither. Addresses: udp:HOST:PORT listens, as udpin does; udpout:HOST:PORT
speaks first; tcp:HOST:PORT; serial:DEVICE:BAUD. Autopilots: ArduPilot Rover, of boats too, and Sub.

On every failure, and on Ctrl-C, the vehicle is told to stop until it says that it is at rest, unless someone has taken it
over; what was flown is written all the same, and the exit status is 1. See docs/mavlink.md.";

pub(crate) const REPLAY: &str = "\
Examples:
  host-sim replay samples.csv
  host-sim replay samples.csv --figure samples.svg --format json
  host-sim replay survey.csv --columns x=easting,z=northing,label=wet
  host-sim replay boat.csv --columns label=oil --p 0.95 --tolerance 4.5 --geojson oil.geojson
  host-sim replay salinity.csv --columns label=psu --threshold 34    above 34 is +1
  host-sim replay utm.csv --crs EPSG:25832 --geojson line.geojson    metres of UTM zone 32
  host-sim replay track.gpx --columns label=name                     <name>yes</name> at each point
  host-sim replay boat.csv --p 0.95 --strict                         exit status 1 if no straight line fits
  host-sim replay boat.csv --front 60 --p 0.95 --map front.csv       a front that bends, along the track of a boat

The last lines say whether a straight line fits: a run of labels, a bend, a drift, a second boundary, or a --p that is too
high for the file. Then a warning goes to standard error. On straight files a verdict is wrong at most once in a hundred.";

pub(crate) const JOIN: &str = "\
Examples:
  host-sim join one.csv other.csv
  host-sim join one.csv other.csv --map both.csv --figure both.svg
  host-sim join boat-1.csv boat-2.csv boat-3.csv --geojson front.geojson

Of places that several maps have, the one with the smallest half-width is kept. The front does not move.";

pub(crate) const CAMPAIGN: &str = "\
Examples:
  host-sim campaign
  host-sim campaign --algorithm lookahead --p 0.7 --steps 36
  host-sim campaign --algorithm scc --steps 36 --p-prior 8,2    nobody knows how often labels are true
  host-sim campaign --compare cfc,lookahead,random --figure curves.svg
  host-sim campaign --fronts --compare track,zigzag,bang-bang   fronts that bend and move
  host-sim campaign --patches                        patches and coasts from nothing, beside a lawnmower
  host-sim campaign --fields 100000 --csv rows.csv              a row for each field and stage
  host-sim campaign --from 1000 --csv more.csv                  the next 1,000 fields, see docs/campaigns.md";

pub(crate) const FIGURE: &str = "\
Examples:
  host-sim figure all
  host-sim figure 7 --out pictures";

pub(crate) const SIZE: &str = "\
Examples:
  host-sim size --samples 16
  host-sim size --samples 36 --hypotheses 529 --mhz 64
  host-sim size --algorithm track

A configuration is told the figures of the smallest program that was measured with room for it, so each is a bound.
Instructions are exact, milliseconds an estimate by the manual's table, flash is that of a whole program with the link.";

pub(crate) const REFERENCE: &str = "\
Examples:
  host-sim reference mission.toml --horizon 2
  host-sim reference mission.toml --horizon 5 --set vehicle.step=0.5 --set vehicle.turn_step=0.25";

pub(crate) const INIT: &str = "\
Examples:
  host-sim init                                a straight boundary, in mission.toml
  host-sim init spill harbour.toml
  host-sim init recording";

pub(crate) const COMPLETIONS: &str = "\
Examples:
  host-sim completions bash > ~/.local/share/bash-completion/completions/host-sim
  host-sim completions zsh > ~/.zfunc/_host-sim
  host-sim completions fish > ~/.config/fish/completions/host-sim.fish";

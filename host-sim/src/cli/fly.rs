//! `fly`: a mission flown by a vehicle that speaks `MAVLink`.

use std::time::Duration;

use anyhow::{Context as _, Result, anyhow, bail};
use clap::Args;
use planner_core::dynamics::Dynamics as _;
use planner_core::{AnyVehicle, Belief as _, Line};

use crate::cli::done::Done;
use crate::cli::help;
use crate::cli::run::Run;
use crate::fly::control::Control;
use crate::fly::failure::Failure;
use crate::fly::flight;
use crate::fly::ideal::Ideal;
use crate::fly::label::{LabelSource, Source};
use crate::fly::limits::Limits;
use crate::fly::pilot::Pilot;
use crate::fly::sent;
use crate::fly::socket::Socket;
use crate::mission::definition::Mission;
use crate::mission::scenario;
use crate::mission::strict::wrong;
use crate::output::file::prepare_all;
use crate::output::interruption;
use crate::output::notes::warn;
use crate::world::World;

/// What a flight that failed ends with.
const FAILED: u8 = 1;

#[derive(Debug, Args)]
#[command(after_help = help::FLY)]
#[group(id = "vehicle", required = true, multiple = false, args = ["mavlink", "dry_run"])]
pub(crate) struct FlyArgs {
    #[command(flatten)]
    run: Run,
    /// Where the vehicle is: udp:HOST:PORT, udpout:HOST:PORT, tcp:HOST:PORT or serial:DEVICE:BAUD
    #[arg(long, value_name = "ADDRESS")]
    mavlink: Option<String>,
    /// Print what an ideal vehicle would be sent, and send nothing
    #[arg(long, conflicts_with_all = ["trace", "figure", "candidates", "report", "mcap", "map", "format", "live"])]
    dry_run: bool,
    /// Who tells labels: the name of a named value, or channel:N of the remote control
    #[arg(long, value_name = "NAME|channel:N")]
    label: Source,
    /// Take labels before the flight too: the operator drives, and each place where the vehicle rests gives one
    #[arg(long, conflicts_with = "dry_run")]
    by_hand: bool,
    /// A value above it is +1, any other -1 [default: 0, of channels 1500 us]
    #[arg(long, value_name = "VALUE")]
    threshold: Option<f64>,
    /// The vehicle's system id
    #[arg(long, value_name = "ID", default_value_t = 1, value_parser = clap::value_parser!(u8).range(1..))]
    system: u8,
    /// How far from where it was sent the vehicle may come to rest, metres [default: the tolerance, half the
    /// shortest motion at most]
    #[arg(long, value_name = "METRES")]
    acceptance: Option<f64>,
    /// How long to wait until it is armed in guided mode, seconds
    #[arg(long, value_name = "SECONDS", default_value = "300", value_parser = seconds)]
    wait: Duration,
    /// How long a motion may take, seconds
    #[arg(long, value_name = "SECONDS", default_value = "60", value_parser = seconds)]
    motion_time: Duration,
    /// How long a label may take once it is there, seconds
    #[arg(long, value_name = "SECONDS", default_value = "10", value_parser = seconds)]
    label_time: Duration,
}

fn seconds(text: &str) -> Result<Duration> {
    let found = text.parse().ok().filter(|it| (0.1..=86_400.0).contains(it));
    found.map(Duration::from_secs_f64).ok_or_else(|| anyhow!("expected seconds, 0.1 to 86400"))
}

/// Flies it, and what to print.
pub(crate) fn fly(args: &FlyArgs) -> Result<Done> {
    let run = &args.run;
    let mission = run.mission_by(run.algorithm, scenario::read_real)?;
    let acceptance = acceptance(&mission, args.acceptance, &run.name())?;
    let labels = LabelSource::new(args.label.clone(), threshold(args.threshold)?);
    let &FlyArgs { system, wait: ready, motion_time: motion, label_time: label, .. } = args;
    let tolerance = mission.position_tolerance();
    let limits = Limits { acceptance, tolerance, ready, motion, label };
    let mut pilot = Pilot::new(system, labels.clone(), limits);
    if args.by_hand {
        pilot = pilot.by_hand(shortest(&mission));
    }
    let Some(address) = &args.mavlink else {
        let mission = sensed(mission, &run.name())?;
        let ideal = Ideal::new(&mission, system, labels);
        let mut control = Control::new(ideal, pilot, || None);
        let flight = flight::fly(mission, &mut control);
        let failure = flight.map_or_else(Some, |it| it.failure.map(|it| it.0));
        let failure = failure.map(|it| (anyhow!("{}: {it}", run.name()), FAILED));
        return Ok(Done { text: sent::table(control.link().sent()), failure });
    };
    let mut live = run.live(&mission)?;
    let outputs = prepare_all(&[run.input()], &run.outputs())?;
    let socket = Socket::open(address, system).context("--mavlink")?;
    interruption::defer();
    let mut control = Control::new(socket, pilot, interruption::deferred);
    let name = run.name();
    match flight::fly_shown(mission, &mut control, live.as_mut()) {
        Ok(flight) => {
            let text = run.tell(outputs, &flight.recording)?;
            let failure = flight.failure.map(|(why, farewell)| {
                let step = flight.recording.steps.len() + 1;
                let error = match &why {
                    Failure::Refused(why) => anyhow!("{name}: {why}; {farewell}"),
                    why => anyhow!("{name}: step {step}: {why}; {farewell}"),
                };
                (error, status(&why))
            });
            Ok(Done { text, failure })
        }
        Err(why) => {
            if let Some(live) = &mut live {
                live.break_off(&why);
            }
            let failure = anyhow!("{name}: {why}; nothing that moves was sent");
            Ok(Done { text: String::new(), failure: Some((failure, status(&why))) })
        }
    }
}

/// A mission whose truth an ideal vehicle can sense: where the file tells none, a line that the oracle leaves.
fn sensed(mut mission: Mission, name: &str) -> Result<Mission> {
    if mission.world.moves() {
        let expected = "no drift: the ideal vehicle does not count motions";
        return wrong("truth.drift", "one", expected).with_context(|| name.to_owned());
    }
    if !mission.world.is_known() {
        // A planner of fronts has no line, though the points may leave one.
        let left = || mission.given.lines().and_then(|lines| lines.estimates().centre);
        let Some(line) = mission.belief().estimates().centre.or_else(left).map(Line::from) else {
            let expected =
                "a line, or an oracle that a line separates, for the ideal vehicle to sense";
            return wrong("truth", "none", expected).with_context(|| name.to_owned());
        };
        mission.world = World::divided_by(line);
    }
    Ok(mission)
}

/// A signal has a status of its own, as elsewhere.
fn status(why: &Failure) -> u8 {
    match why {
        Failure::Interrupted(signal) => (128 + signal) as u8,
        _ => FAILED,
    }
}

fn threshold(value: Option<f64>) -> Result<Option<f64>> {
    match value {
        Some(value) if !value.is_finite() => wrong("--threshold", value, "a number"),
        value => Ok(value),
    }
}

/// The shortest motion, metres.
fn shortest(mission: &Mission) -> f64 {
    f64::from(mission.vehicle.grid().reach_mm(1)) / 1e3
}

/// How far off a vehicle may come to rest: what the scenario leaves room for.
fn acceptance(mission: &Mission, asked: Option<f64>, name: &str) -> Result<f64> {
    if matches!(mission.vehicle, AnyVehicle::Car(_)) {
        let expected = "unicycle or boat: a setpoint says where a motion ends, not along which arc";
        return wrong("vehicle", "car", expected).with_context(|| name.to_owned());
    }
    let tolerance = mission.position_tolerance();
    if tolerance <= 0.0 {
        let expected = "one above 0: a vehicle's local position is always off by something";
        return wrong("tolerance", "0 m", expected).with_context(|| name.to_owned());
    }
    let shortest = shortest(mission);
    let Some(asked) = asked else { return Ok(tolerance.min(shortest / 2.0)) };
    if !(asked > 0.0 && asked < shortest) {
        let expected = format!(
            "above 0 and below {shortest} m, the scenario's shortest motion, or that would end where it began"
        );
        return wrong("--acceptance", format!("{asked} m"), expected);
    }
    if asked > tolerance && (mission.lake.is_some() || mission.config.area.hulls().next().is_some())
    {
        bail!(
            "--acceptance: found {asked} m, expected at most the tolerance, {tolerance:.3} m, which is what motions \
             keep from keep-outs and the shore"
        );
    }
    if asked > tolerance {
        let beyond = asked - tolerance;
        warn(
            name,
            format_args!(
                "acceptance: {asked} m: it may come to rest {beyond:.2} m outside of the area"
            ),
        );
    }
    Ok(asked)
}

//! The setup of a mission as it is sent to a chip, and the reasons why a chip may decline it.

use anyhow::{Result, anyhow, bail};
use heapless::Vec as BoundedVec;
use planner_core::link::message::{
    self, CHARTED, Capacity, ChartFault, DeclinedError, LabelSource, MissionArea, Outline,
    PROTOCOL, Settings, Setup,
};
use planner_core::parts::EVALUATIONS;
use planner_core::{AnySight, FrontStretch, Seeking, Workspace as _};

use crate::mission::algorithm::Algorithm;
use crate::mission::definition::Mission;
use crate::mission::given::CAPACITY;
use crate::mission::strict::wrong;
use crate::world::faults::Fault;

/// Whether a board can fly with the faults of the sensor. By the protocol a missing reading is no label of a mission.
fn check_sensor(mission: &Mission, labels: LabelSource) -> Result<()> {
    if labels == LabelSource::Chip && !mission.sensor.is_empty() {
        return wrong(
            "sensor",
            "faults",
            "none with --labels chip: the board reads its own sensor",
        );
    }
    if mission.sensor.iter().any(Fault::reads_nothing) {
        let expected = "none of them with hil: a missing reading ends the mission of a board";
        return wrong("sensor", "off, delayed or dropouts", expected);
    }
    Ok(())
}

/// The setup of a mission, as it is sent to a chip.
///
/// # Errors
/// When no chip can fly such a mission.
pub fn setup(mission: &Mission, labels: LabelSource) -> Result<Setup> {
    if mission.goal.is_some() && !mission.audits {
        bail!("stop.audit: found false, expected true: a board always audits");
    }
    if mission.begins_from_nothing() {
        return wrong(
            "oracle",
            "no points of both labels",
            "some with hil: a board does not seek them",
        );
    }
    if mission.seeking != Seeking::USUAL {
        return wrong("seek", "some with hil", "none: a board seeks in the usual way");
    }
    check_sensor(mission, labels)?;
    let Some(noise) = mission.noise_known() else {
        let expected = "a number with hil: a board is told how often labels are true";
        return wrong("noise.p", "a prior", expected);
    };
    let algorithm = match mission.algorithm {
        Algorithm::Cfc => message::Algorithm::Cfc,
        Algorithm::Scc => {
            message::Algorithm::Scc { noise, policy: mission.policy, prior: mission.prior }
        }
        Algorithm::Lookahead => message::Algorithm::Lookahead {
            evaluations: EVALUATIONS,
            goal: mission.goal,
            noise: mission.noise.map(|_| (noise, mission.prior)),
            sight: mission.sight(),
        },
        Algorithm::Track => {
            let front = mission.front;
            match mission.watch.map(FrontStretch::metres).transpose()? {
                Some(stretch) => message::Algorithm::Watch { front, noise, stretch },
                None => message::Algorithm::Track { front, noise, ends: mission.until_closed },
            }
        }
        other => bail!("algorithm: found {}, expected cfc, scc, lookahead or track", other.name()),
    };
    let samples = mission.given.samples();
    let given = BoundedVec::from_slice(samples).map_err(|_| {
        let most = message::MOST_GIVEN;
        anyhow!("oracle: found {} points, expected at most {most} on a board", samples.len())
    })?;
    // A follower of fronts stores no samples. True labels leave one hypothesis. `t` labels that may be wrong leave at most `1 + t + t (t - 1) / 2`.
    // Labels of an audit take no room, and true labels no more than the planner here has. A reading on the way may take
    // as much as the label at the end.
    let room = (CAPACITY - samples.len()) as u32;
    let is_apart = mission.goal.is_some() || mission.asking.is_apart() || !mission.is_noisy();
    let most = if is_apart { room } else { u32::MAX };
    let at_ends = mission.asking.labels.unwrap_or(most).min(most).min(mission.steps);
    let on_the_way = mission.steps * (mission.readings - 1);
    let is_stored = mission.algorithm.seeks_line();
    let taken = if is_stored { (at_ends + on_the_way).min(at_ends.max(room)) } else { 0 };
    let hypotheses = match mission.algorithm {
        _ if mission.is_noisy() => 1 + taken + taken * taken.saturating_sub(1) / 2,
        _ => 1,
    };
    let capacity =
        Capacity { samples: (samples.len() as u32 + taken) as u16, hypotheses: hypotheses as u16 };
    let &Mission {
        config: Settings { area, weight, crossing, following, tolerance }, start, ..
    } = mission;
    let config = Settings { area: area.bounds(), weight, crossing, following, tolerance };
    let is_plain = area.sides().next().is_none() && area.hulls().next().is_none();
    let keep_outs = (!is_plain || mission.lake.is_some())
        .then(|| area.hulls().count() as u8 + if mission.lake.is_some() { CHARTED } else { 0 });
    let (protocol, vehicle, steps) = (PROTOCOL, mission.vehicle.into(), mission.steps as u16);
    Ok(Setup {
        protocol,
        algorithm,
        config,
        keep_outs,
        vehicle,
        capacity,
        steps,
        most_labels: mission.asking.labels.map(|labels| labels as u16),
        start,
        labels,
        given,
    })
}

/// The border of an area, then its keep-outs.
pub fn outlines(area: &MissionArea) -> impl Iterator<Item = Outline> {
    let border = Outline { corners: area.corners().iter().copied().collect(), radius: 0 };
    [border].into_iter().chain(area.hulls().map(Outline::from))
}

/// What flags and files call an algorithm.
fn name(algorithm: &message::Algorithm) -> String {
    let algorithm = match algorithm {
        message::Algorithm::Cfc => Algorithm::Cfc,
        message::Algorithm::Scc { .. } => Algorithm::Scc,
        message::Algorithm::Lookahead { .. } => Algorithm::Lookahead,
        message::Algorithm::Track { .. } | message::Algorithm::Watch { .. } => Algorithm::Track,
    };
    algorithm.name()
}

/// The error for a setup that a chip declined, with so many readings a motion. It names the key of the scenario that asks
/// too much.
pub(crate) fn declined(declined: DeclinedError, setup: &Setup, readings: u32) -> anyhow::Error {
    match declined {
        DeclinedError::Protocol(theirs) => {
            anyhow!("the board speaks protocol {theirs}, expected {PROTOCOL}")
        }
        DeclinedError::Capacity(Capacity { samples, hypotheses }) => {
            let most = usize::from(samples).saturating_sub(setup.given.len());
            if readings > 1 {
                return anyhow!(
                    "readings: found {readings} in each of {} steps, expected at most {most} in all: the board has \
                     room for {samples} samples and {hypotheses} hypotheses, {} of the samples given",
                    setup.steps,
                    setup.given.len(),
                );
            }
            let (key, found) = match setup.most_labels {
                Some(labels) => ("labels", labels),
                None => ("steps", setup.steps),
            };
            anyhow!(
                "{key}: found {found}, expected at most {most}: the board has room for {samples} samples \
                 and {hypotheses} hypotheses, {} of the samples given",
                setup.given.len(),
            )
        }
        DeclinedError::Algorithm => match setup.algorithm {
            message::Algorithm::Watch { stretch, .. } => anyhow!(
                "front.watch: found {} m, declined by the board, whose program does not watch a stretch",
                f64::from(u32::from(stretch)) / 1e3
            ),
            other => anyhow!(
                "algorithm: found {}, declined by the board, whose program does not have it",
                name(&other)
            ),
        },
        DeclinedError::Given(error) => anyhow!("oracle: declined by the board: {error}"),
        DeclinedError::Vehicle(why) => anyhow!("vehicle: declined by the board: expected {why}"),
        DeclinedError::Chart(ChartFault::Room(words)) => {
            anyhow!(
                "area.cells: found more cells than the board has room for, expected {words} words of 32 at most"
            )
        }
        DeclinedError::Chart(_) => anyhow!("area.geojson: declined by the board: {declined}"),
        DeclinedError::Area => anyhow!("area: declined by the board: {declined}"),
        DeclinedError::Tolerance => anyhow!("tolerance: declined by the board: {declined}"),
        DeclinedError::Goal => anyhow!("stop: declined by the board: {declined}"),
        DeclinedError::Price => {
            let near =
                AnySight::from(None).with_readings(u8::try_from(readings).unwrap_or(u8::MAX));
            let is_near = matches!(setup.algorithm, message::Algorithm::Lookahead { sight, .. } if sight == near);
            let (key, expected) = if is_near {
                ("readings", "1 with lookahead")
            } else {
                ("price", "price = \"none\" and no ask.worth")
            };
            anyhow!("{key}: declined by the board: {declined}; expected {expected}")
        }
        DeclinedError::Labels => {
            anyhow!("--labels: found chip, but this board has no label sensor")
        }
        other => anyhow!("declined by the board: {other}"),
    }
}

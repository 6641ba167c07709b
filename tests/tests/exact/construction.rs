//! What a planner is made of agrees, or construction refuses it with an error that says which two contradict each other.

use planner_core::dynamics::Dynamics;
use planner_core::error::{GivenError, SetupError};
use planner_core::{
    Area, Boat, CellPosterior, Cfc, Label, Lookahead, Noise, NoisyBelief, Prior, Restart as _,
    Sample, Scc, Tolerance, Unicycle, VersionSpace, Workspace as _, aimed_for,
};

fn given() -> [Sample; 4] {
    let corners = [[0.0, 0.0], [0.0, 10.0], [10.0, 10.0], [10.0, 0.0]];
    let label = |z| if z > 5.0 { Label::Positive } else { Label::Negative };
    corners.map(|[x, z]| Sample::at([x, z], label(z)).unwrap())
}

fn square(side: f64) -> Area {
    Area::metres([0.0, 0.0], [side, side]).unwrap()
}

/// What each planner says of an area, a vehicle and beliefs of a tolerance, with room for `N` samples.
fn refusals<D: Dynamics + Copy, const N: usize>(
    area: Area,
    dynamics: D,
    tolerance: f64,
) -> [Option<SetupError>; 4] {
    let lines = VersionSpace::<N>::new(&given()).unwrap().with_tolerance(tolerance).unwrap();
    let noise = Noise::new(0.8).unwrap().with_tolerance(tolerance).unwrap();
    let table = CellPosterior::<N, 16>::new(&given(), Prior::Area, noise).unwrap();
    let noisy = NoisyBelief::<N, 16>::new(&given(), noise).unwrap();
    [
        Cfc::new(area, dynamics, lines.clone()).err(),
        Lookahead::new(area, dynamics, lines).err(),
        Scc::new(area, dynamics, table).err(),
        Lookahead::new(area, dynamics, noisy).err(),
    ]
}

#[test]
fn each_planner_refuses_what_contradicts_itself() {
    let unicycle = Unicycle::paper();
    let boat = Boat::new(Unicycle::new(10_000, 0.3, 21, 100).unwrap()).unwrap();
    // Its circle is a third of a metre in radius.
    assert_eq!(refusals::<_, 5>(square(10.0), unicycle, 0.0), [None; 4]);
    assert_eq!(refusals::<_, 5>(square(10.0), boat, 0.5), [None; 4]);
    // Area and tolerance.
    let half = Some(SetupError::Tolerance(Tolerance::new(0.5).unwrap()));
    assert_eq!(refusals::<_, 5>(square(1.0), unicycle, 0.5), [half; 4]);
    assert_eq!(refusals::<_, 5>(square(1.0), unicycle, 0.49), [None; 4]);
    // Area and vehicle, and both with the tolerance.
    let is_room = |it: &Option<SetupError>| matches!(it, Some(SetupError::Room(_)));
    assert!(refusals::<_, 5>(square(0.6), boat, 0.0).iter().all(is_room));
    assert_eq!(refusals::<_, 5>(square(1.0), boat, 0.0), [None; 4]);
    assert!(refusals::<_, 5>(square(1.0), boat, 0.2).iter().all(is_room));
    // A belief without room for a label.
    assert_eq!(refusals::<_, 4>(square(10.0), unicycle, 0.0), [Some(SetupError::Full); 4]);
    // A belief and its tolerance.
    let vague = VersionSpace::<8>::new(&given()).unwrap().with_tolerance(-0.1);
    assert_eq!(vague.err(), Some(GivenError::Tolerance));
    let mut crossed = given();
    (crossed[2].label, crossed[3].label) = (crossed[3].label, crossed[2].label);
    let crossed_at = VersionSpace::<8>::new(&crossed).err();
    assert_eq!(crossed_at, Some(GivenError::NotSeparable(3)));
    assert!(NoisyBelief::<8, 16>::new(&crossed, Noise::new(0.8).unwrap()).is_err());
}

#[test]
fn the_larger_of_tolerance_and_clearance_is_the_margin() {
    let unicycle = Unicycle::paper();
    let margin = |clearance: f64, tolerance: f64| {
        let area = square(10.0).with_clearance(clearance).unwrap();
        let tolerance = Tolerance::new(tolerance).unwrap();
        aimed_for(area, &unicycle, tolerance).unwrap().margin()
    };
    let units = |metres| Tolerance::new(metres).unwrap().units();
    assert_eq!(margin(0.25, 0.1), units(0.25));
    assert_eq!(margin(0.1, 0.25), units(0.25));
    assert_eq!(margin(0.0, 0.0), 0);
    for none in [-0.1, 5.0, f64::NAN, f64::INFINITY] {
        assert!(square(10.0).with_clearance(none).is_err(), "{none}");
    }
    // A planner that begins again keeps the clearance, and takes the new tolerance.
    let area = square(10.0).with_clearance(0.25).unwrap();
    let table = CellPosterior::<8, 16>::new(&given(), Prior::Area, Noise::NONE).unwrap();
    let mut scc = Scc::new(area, unicycle, table).unwrap();
    let noise = Noise::new(0.8).unwrap();
    let too_much = noise.with_tolerance(5.0).unwrap();
    assert_eq!(
        scc.restart(&given(), Prior::Area, too_much),
        Err(SetupError::Tolerance(too_much.tolerance))
    );
    assert_eq!(scc.restart(&given(), Prior::Area, noise.with_tolerance(0.1).unwrap()), Ok(()));
}

//! Charts: missions in lakes over the link, and charts that do not arrive.

#![expect(
    clippy::redundant_closure_for_method_calls,
    reason = "a method takes an area of one lifetime alone"
)]

use host_sim::hil::faults::Faults;
use host_sim::hil::setup;
use planner_core::link::message::{
    CELL_BYTES, CHARTED, ChartFault, ChartPiece, ChartShape, DeclinedError, LabelSource,
    MissionArea, Outline, Reply, Request, Settings, Setup,
};
use planner_core::link::station::{Charts, FromOutlines, NoTerms};
use planner_core::{AnyVehicle, Area, Chart, Site, Workspace as _};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;
use rayon::prelude::*;
use tests::cases;
use tests::chip::offered;
use tests::lakes;
use tests::wire;

use crate::link::flies_as_here;
use crate::sensors::Vehicle;

/// Every lake, vehicle and planner that a chip has, some with keep-outs in the water. A bad wire changes nothing.
#[test]
fn in_lakes_a_chip_flies_as_here() {
    (0..cases(36, 720)).into_par_iter().for_each(|number| {
        let cells = if number % 2 == 0 { 128 } else { 256 };
        let mission = lakes::for_a_chip(number, cells, 40);
        let faults = if number % 3 == 0 { wire::bad() } else { Faults::default() };
        flies_as_here(&mission, faults);
    });
}

/// So it does on charts that no lake has: wide open, combs, mazes of a cell's width, ponds, and a start on land.
#[test]
fn on_made_up_charts_a_chip_flies_as_here() {
    (0..cases(45, 720)).into_par_iter().for_each(|number| {
        flies_as_here(&lakes::made_up(number, 128, 12), Faults::default());
    });
}

const SIDE: u32 = 1_000;

/// Cells of random sizes: all open, all closed, one cell, necks of a cell, or anything.
fn cells(rng: &mut ChaCha8Rng) -> ([u16; 2], Vec<u32>) {
    let mut most = |of: [u16; 4]| of[rng.random_range(0..4)];
    let size = [most([1, 31, 128, 256]), most([1, 33, 100, 256])];
    let words = Chart::words_in(size[0]) * usize::from(size[1]);
    let kind = rng.random_range(0..4);
    let word = |k: usize| match kind {
        0 => 0,
        1 => u32::MAX,
        2 => u32::MAX >> (k % 3) << (k % 5),
        _ => rng.random(),
    };
    (size, (0..words).map(word).collect())
}

/// What a chip with an area of some kind makes of a mission on a chart, which the vehicle may send wrongly.
fn received<G: FromOutlines, T>(
    (chart, shape): (&Chart<'_>, ChartShape),
    config_area: Area,
    send: impl Fn(ChartPiece) -> Option<Reply>,
    see: impl FnOnce(Result<G::Ground<'_>, NoTerms>) -> T,
) -> (T, usize) {
    let mission = lakes::for_a_chip(0, 64, 8);
    let mut asked = 0;
    let border = MissionArea::from(config_area);
    let vehicle = Vehicle::new(&mission, |request: &Request| {
        Some(match request {
            Request::Outline(0) => Reply::Outline(setup::outlines(&border).next().expect("it")),
            Request::Outline(_) => Reply::Outline(Outline {
                corners: [border.bounds().middle()].into_iter().collect(),
                radius: 1,
            }),
            Request::Chart => Reply::Chart(shape),
            Request::Cells(number) => {
                asked += 1;
                let piece = ChartPiece::of(chart, *number).expect("one more");
                return send(piece);
            }
            _ => Reply::Noted,
        })
    });
    let seen = offered(&vehicle, |chip, setup| {
        let config = Settings { area: config_area, ..setup.config };
        let setup = Setup { config, keep_outs: Some(CHARTED + 1), ..setup.clone() };
        let mut room = G::EMPTY;
        see(chip.terms::<AnyVehicle, G>(&setup, &mut room).map(|terms| terms.area))
    });
    drop(vehicle);
    (seen, asked)
}

type Small = Charts<512>;
type Large = Charts<2_048>;

#[test]
fn a_chart_arrives_piece_by_piece() {
    let mut rng = ChaCha8Rng::seed_from_u64(9);
    for case in 0..40 {
        let (size, cells) = cells(&mut rng);
        let corner = Site::new(-7_000 * case, 500).expect("near");
        let chart = Chart::new(corner, SIDE, size, &cells).expect("a chart");
        let sent = (&chart, ChartShape::of(&chart));
        let as_it_is = |piece| Some(Reply::Cells(piece));
        let ((), asked) = received::<Large, _>(sent, chart.bounds(), as_it_is, |area| {
            let area = area.expect("it is accepted");
            assert_eq!(area.chart(), Some(chart));
            assert_eq!(area.keep_outs().count(), 1);
        });
        assert_eq!(asked, cells.len().div_ceil(CELL_BYTES / 4));
        // A chip with less room asks for none of the pieces, one without charts for no chart.
        let is_small = cells.len() <= 512;
        let (refused, asked_by_small) =
            received::<Small, _>(sent, chart.bounds(), as_it_is, |it| it.err());
        let room = NoTerms::Declined(DeclinedError::Chart(ChartFault::Room(512)));
        assert_eq!((refused == Some(room), asked_by_small == 0), (!is_small, !is_small));
        let (refused, asked) =
            received::<MissionArea, _>(sent, chart.bounds(), as_it_is, |it| it.err());
        assert_eq!((refused, asked), (Some(NoTerms::Declined(DeclinedError::Area)), 0));
        let (refused, asked) = received::<Area, _>(sent, chart.bounds(), as_it_is, |it| it.err());
        assert_eq!((refused, asked), (Some(NoTerms::Declined(DeclinedError::Area)), 0));
    }
}

/// Whatever is wrong is declined by its name. The last words of a chart are the shortest piece.
#[test]
fn a_chart_that_is_spoilt_is_declined() {
    let cells: Vec<u32> = (0..2 * 70).map(|k: u32| k.wrapping_mul(0x9E37_79B9)).collect();
    let chart = Chart::new(Site::ORIGIN, 100_000, [64, 70], &cells).expect("a chart");
    let shape = ChartShape::of(&chart);
    let of = |shape: ChartShape, area: Area, send: &dyn Fn(ChartPiece) -> Option<Reply>| {
        received::<Small, _>((&chart, shape), area, send, |it| it.err()).0
    };
    let piece = |number: u8| ChartPiece::of(&chart, number).expect("a piece");
    let instead = |number: u8, other: Reply| {
        of(shape, chart.bounds(), &|it: ChartPiece| {
            Some(if it.number == number { other.clone() } else { Reply::Cells(it) })
        })
    };
    let fault = |it| Some(NoTerms::Declined(DeclinedError::Chart(it)));
    assert_eq!(instead(0, Reply::Cells(piece(0))), None);
    for number in 0..3 {
        assert_eq!(instead(number, Reply::Noted), fault(ChartFault::Missing(number)));
        assert_eq!(instead(number, Reply::Failed), fault(ChartFault::Missing(number)));
    }
    for (number, other) in [(1, 0), (2, 1), (2, 0)] {
        assert_eq!(instead(number, Reply::Cells(piece(other))), fault(ChartFault::Repeated(other)));
    }
    for (number, other) in [(0, 1), (1, 2), (0, 2)] {
        assert_eq!(instead(number, Reply::Cells(piece(other))), fault(ChartFault::Wrong(number)));
    }
    // Of another length.
    for (number, count) in [(0, 255), (0, 252), (0, 0), (2, 44), (2, 52), (2, 256)] {
        let mut bytes = piece(number).bytes;
        bytes.resize(count, 0).expect("room");
        let other = Reply::Cells(ChartPiece { number, bytes });
        assert_eq!(instead(number, other), fault(ChartFault::Wrong(number)), "{number} {count}");
    }
    // One bit, or the place of two pieces.
    for bit in [0, 7, 255 * 8] {
        let mut other = piece(1);
        other.bytes[bit / 8] ^= 1 << (bit % 8);
        assert_eq!(instead(1, Reply::Cells(other)), fault(ChartFault::Sum));
    }
    let swapped = of(shape, chart.bounds(), &|it: ChartPiece| {
        let bytes = if it.number < 2 { piece(1 - it.number).bytes } else { it.bytes };
        Some(Reply::Cells(ChartPiece { number: it.number, bytes }))
    });
    assert_eq!(swapped, fault(ChartFault::Sum));
    // A shape that none has, or that is not as large as the area.
    let as_it_is = |it| Some(Reply::Cells(it));
    for size in [[0, 70], [64, 0]] {
        let none = ChartShape { size, sum: 0, ..shape };
        assert_eq!(of(none, chart.bounds(), &as_it_is), fault(ChartFault::Shape));
    }
    for other in [
        ChartShape { side: 0, ..shape },
        ChartShape { side: 99_999, ..shape },
        ChartShape { side: u32::MAX, ..shape },
        ChartShape { size: [63, 70], ..shape },
    ] {
        assert_eq!(of(other, chart.bounds(), &as_it_is), fault(ChartFault::Shape), "{other:?}");
    }
    let elsewhere = Site::new(1, 1).expect("near");
    let elsewhere = Area::new(elsewhere, chart.bounds().max()).expect("nearly all of it");
    assert_eq!(of(shape, elsewhere, &as_it_is), fault(ChartFault::Shape));
    for size in [[u16::MAX; 2], [64, 257], [513, 32]] {
        let large = ChartShape { size, ..shape };
        assert_eq!(of(large, chart.bounds(), &as_it_is), fault(ChartFault::Room(512)), "{size:?}");
    }
}

/// A chip without charts sees from the count that it has to decline.
#[test]
fn a_setup_says_that_it_has_a_chart() {
    let mission = lakes::for_a_chip(18, 128, 8);
    let setup = setup::setup(&mission, LabelSource::Vehicle).expect("a mission for a chip");
    assert_eq!(setup.keep_outs, Some(CHARTED));
}

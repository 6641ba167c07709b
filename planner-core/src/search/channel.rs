//! The way along open cells of a chart, to uncertain ground or to a place.
//!
//! Four by four cells at most make a block, so that there are 64 blocks each way. A block is represented by the open cell
//! next to its middle. A wave spreads from the blocks in sight of the robot to neighbours that see each other (Lee, 1961).
//! It ends at the first block from which a straight way leads to the goal. From there the way is followed back to the last
//! block in sight of the robot, which is where the first leg goes.

use crate::geometry::approximate::distance;
use crate::geometry::chart::Chart;
use crate::geometry::lattice::{Site, Vector};
use crate::geometry::workspace::Workspace;
use crate::search::objective::Effort;

/// Blocks each way, at most.
const BLOCKS: u16 = 64;

/// A wave begins at blocks in sight that are so near.
const NEAR: i16 = 2;

/// A block, by its column and its row.
type Block = [u16; 2];

/// Some of the blocks, by their rows.
type Wave = [u64; BLOCKS as usize];

/// The first leg of a way from a position to wherever a straight way leads on. `None` if there is none, or if the looks are
/// used up before.
pub(crate) fn begin<G: Workspace>(
    (area, chart, step): (&G, Chart<'_>, f32),
    from: Site,
    effort: &mut Effort,
    way_out: impl Fn(Site) -> Option<(Vector, f32)>,
) -> Option<Vector> {
    let channel = Channel::of(area, chart);
    let mut reached = Reached::NONE;
    let [column, row] = chart.cell_of(from)?.map(|it| channel.block_of(it));
    for (x, z) in (-NEAR..=NEAR).flat_map(|x| (-NEAR..=NEAR).map(move |z| (x, z))) {
        let block = [column.wrapping_add_signed(x), row.wrapping_add_signed(z)];
        let sees = |site: Site| area.lets_pass(&[from, site]);
        if effort.take(1) && channel.site(block).is_some_and(sees) {
            reached.add(block, block);
        }
    }
    let end = channel.spread(&mut reached, effort, way_out)?;
    reached.back_from(end).find_map(|block| {
        let site = channel.site(block)?;
        let way = site - from;
        (distance(way) > step && area.lets_pass(&[from, site])).then_some(way)
    })
}

/// A chart in blocks.
struct Channel<'a, G> {
    area: &'a G,
    chart: Chart<'a>,
    /// Cells along the side of a block.
    cells: u16,
}

impl<'a, G: Workspace> Channel<'a, G> {
    fn of(area: &'a G, chart: Chart<'a>) -> Self {
        const { assert!(Chart::MOST_CELLS <= 4 * BLOCKS, "a block has four by four cells at most") };
        let [columns, rows] = chart.size();
        Self { area, chart, cells: columns.max(rows).div_ceil(BLOCKS) }
    }

    fn block_of(&self, cell: u16) -> u16 {
        cell.checked_div(self.cells).unwrap_or(0)
    }

    /// The middle of the open cell next to a block's middle; `None` if none is open.
    fn site(&self, [column, row]: Block) -> Option<Site> {
        if column >= BLOCKS || row >= BLOCKS {
            return None;
        }
        let middle = (self.cells - 1) / 2;
        let all = (0..self.cells).flat_map(|x| (0..self.cells).map(move |z| [x, z]));
        let cell = |[x, z]: [u16; 2]| [column * self.cells + x, row * self.cells + z];
        let open = all.filter(|at| self.chart.is_open(cell(*at)));
        let nearest = open.min_by_key(|[x, z]| x.abs_diff(middle) + z.abs_diff(middle))?;
        self.chart.middle_of(cell(nearest)).filter(|it| self.area.contains(*it))
    }

    /// Spreads until a block is reached from which a straight way leads on.
    fn spread(
        &self,
        reached: &mut Reached,
        effort: &mut Effort,
        way_out: impl Fn(Site) -> Option<(Vector, f32)>,
    ) -> Option<Block> {
        let mut is_first = true;
        loop {
            let wave = core::mem::replace(&mut reached.wave, [0; BLOCKS as usize]);
            if wave == [0; BLOCKS as usize] {
                return None;
            }
            for block in blocks(&wave) {
                // Each second block each way is enough to see what is near.
                let is_asked = is_first || block.iter().all(|it| it % 2 == 0);
                if !effort.take(if is_asked { 3 } else { 1 }) {
                    return None;
                }
                let Some(site) = self.site(block) else { continue };
                if is_asked && way_out(site).is_some() {
                    return Some(block);
                }
                for next in neighbours(block) {
                    let sees = |to: Site| self.area.lets_pass(&[site, to]);
                    if !reached.has(next) && self.site(next).is_some_and(sees) {
                        reached.add(next, block);
                    }
                }
            }
            is_first = false;
        }
    }
}

/// The blocks of a wave.
fn blocks(wave: &Wave) -> impl Iterator<Item = Block> {
    (0..).zip(wave).flat_map(|(row, &bits)| {
        (0..BLOCKS).filter(move |column| bits >> column & 1 == 1).map(move |column| [column, row])
    })
}

/// The blocks beside a block.
fn neighbours([column, row]: Block) -> impl Iterator<Item = Block> {
    let (left, below) = (column.wrapping_sub(1), row.wrapping_sub(1));
    [[left, row], [column + 1, row], [column, below], [column, row + 1]].into_iter()
}

/// The blocks that a wave has reached.
struct Reached {
    /// From which neighbour, by its number plus one; the number of neighbours plus one where the wave began.
    from: [[u8; BLOCKS as usize]; BLOCKS as usize],
    /// Those that it reached last.
    wave: Wave,
}

impl Reached {
    const NONE: Self = Self { from: [[0; BLOCKS as usize]; BLOCKS as usize], wave: [0; 64] };

    fn from(&self, [column, row]: Block) -> Option<u8> {
        self.from.get(usize::from(row))?.get(usize::from(column)).copied()
    }

    fn has(&self, block: Block) -> bool {
        self.from(block).is_some_and(|from| from > 0)
    }

    /// Reaches a block from another.
    fn add(&mut self, block: Block, before: Block) {
        let [column, row] = block.map(usize::from);
        let number = neighbours(block).take_while(|it| *it != before).count() as u8;
        if let (Some(from), Some(wave)) =
            (self.from.get_mut(row).and_then(|it| it.get_mut(column)), self.wave.get_mut(row))
        {
            *from = number + 1;
            *wave |= 1 << column;
        }
    }

    /// A block, the one before it, and so on to where the wave began.
    fn back_from(&self, block: Block) -> impl Iterator<Item = Block> {
        core::iter::successors(Some(block), |block| {
            let number = self.from(*block)?.checked_sub(1)?;
            neighbours(*block).nth(number.into())
        })
    }
}

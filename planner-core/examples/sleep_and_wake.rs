//! Sleep and wake: the chip is off after each motion. To continue it needs some hundred bytes in memory that outlives
//! the sleep (a backup domain, FRAM, a sector of flash).
//!
//! `cargo run -p planner-core --features serde --example sleep_and_wake`

mod field;

use crc::{CRC_32_ISO_HDLC, Crc};
use field::{Result, World};
use planner_core::{Area, Lookahead, Persist, Plan, Planner as _, Pose, Unicycle, VersionSpace};

type Finder = Lookahead<Unicycle, VersionSpace<32>, Area>;

static CHECK: Crc<u32> = Crc::<u32>::new(&CRC_32_ISO_HDLC);

/// What outlives the sleep: zeros until it is written.
type Backup = [u8; 512];

/// As it is made at every start, from what the program has.
fn planner() -> Result<Finder> {
    let space = VersionSpace::new(&field::given()?)?;
    Ok(Lookahead::new(field::area()?, Unicycle::paper(), space)?)
}

/// From power on to power off: one motion, or none if the mission is over.
fn wake(backup: &mut Backup, world: &World) -> Result<Option<Finder>> {
    let mut planner = planner()?;
    let mut pose = field::start()?;
    // What was kept, with a check sum; without one this is the first start, or the battery was empty.
    if let Ok((kept, snapshot)) =
        postcard::from_bytes_crc32::<(Pose, <Finder as Persist>::Snapshot)>(backup, CHECK.digest())
    {
        planner.restore(&snapshot)?;
        pose = kept;
    }
    let Plan::Move(motion) = planner.plan(pose) else { return Ok(Some(planner)) };
    world.go(motion.target);
    pose = world.pose();
    planner.observe(pose, motion.wants_label.then(|| world.label().into()))?;
    let bytes = postcard::to_slice_crc32(&(pose, planner.snapshot()), backup, CHECK.digest())?;
    println!("{} bytes to keep", bytes.len());
    Ok(None)
}

fn main() -> Result {
    let world = World::new()?;
    let mut backup = [0; 512];
    loop {
        if let Some(planner) = wake(&mut backup, &world)? {
            return field::report(planner.estimate(), 0.05);
        }
    }
}

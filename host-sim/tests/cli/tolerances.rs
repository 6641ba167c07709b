//! Missions whose position errors are so large that no label tells more: they end, and say what to change.

use std::fs;

use crate::{folder, prints};

const MISSION: &str = r#"
algorithm = "lookahead"
steps = 64
truth = { slope = 0.41, intercept = 3.5 }
oracle = [
  { x = 2.0, z = 1.0, label = -1 },
  { x = 2.0, z = 8.0, label = 1 },
  { x = 18.0, z = 16.0, label = 1 },
  { x = 18.0, z = 5.0, label = -1 },
]
"#;

/// README's first scenario.
#[test]
fn a_mission_that_can_learn_no_more_ends_before_its_steps() {
    let folder = folder();
    let better = "bring better positions: a smaller tolerance";
    let unreachable = "This goal cannot be reached with this tolerance";
    for (settings, remedy) in [
        ("tolerance = 0.3", better),
        ("tolerance = 0.05", better),
        ("tolerance = 0.6\nstop = { slope_arc_deg = 6.0 }", unreachable),
    ] {
        fs::write(folder.path().join("m.toml"), format!("{MISSION}{settings}\n")).expect("a file");
        let told = prints(folder.path(), &["run", "m.toml"]);
        assert!(told.contains(remedy), "{settings}: {told}");
        let (_, after) = told.split_once(" samples in ").expect("what was made");
        let steps = after.split(' ').next().and_then(|it| it.parse::<u32>().ok());
        assert!(steps.expect("a number") < 64, "{settings}: {told}");
    }
}

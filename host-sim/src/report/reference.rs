//! A full-horizon problem that is solved, in plain words and figures.

use std::fmt::Write as _;

use crate::mission::results::StepResult;
use crate::reference::account::Account;
use crate::reference::solution::Solution;
use crate::report::table::{Column, Table};
use crate::report::text;

/// The optimum step by step, then what each pays.
pub fn text(title: &str, solution: &Solution) -> String {
    let Solution { instance, optimum, accounts } = solution;
    let problem = instance.problem;
    let mut text = format!(
        "{title}, the full-horizon problem of Section {}: {} motions of {} actions each\n\
         Objective: {} + control. The line is known to the optimum, and to no planner.\n\n",
        problem.section(),
        instance.horizon(),
        instance.choices.len(),
        problem.line_cost(),
    );
    text += &match optimum {
        Some(recording) => steps(&recording.results.steps).to_string(),
        None if instance.begin().is_none() => {
            "No line has the oracle's points on the sides of their labels, a metre off.\n"
                .to_owned()
        }
        None => "No sequence of so many motions keeps the constraints.\n".to_owned(),
    };
    text.push('\n');
    text += &table(accounts).to_string();
    text += &broken(accounts);
    text
}

/// The motions.
fn steps(steps: &[StepResult]) -> Table {
    Table::of(
        steps,
        &[
            (Column::right("step", 4), &|it| it.step.to_string()),
            (Column::right("v", 5).apart(), &|it| format!("{:.2}", it.action.v)),
            (Column::right("w", 6).apart(), &|it| format!("{:.2}", it.action.w)),
            (Column::right("x", 7).apart(), &|it| format!("{:.3}", it.pose.x)),
            (Column::right("z", 7).apart(), &|it| format!("{:.3}", it.pose.z)),
            (Column::right("label", 5).apart(), &|it| text::signed(it.fact)),
            (Column::left("slope arc deg", 16).apart(), &|it| text::arcs(&it.slope_arcs)),
            (Column::right("bits", 5), &|it| format!("{:.2}", it.bits)),
        ],
    )
}

/// The cost of each.
fn table(accounts: &[Account]) -> Table {
    let figure = |value: Option<f64>| value.map_or("-".to_owned(), |it| format!("{it:.3}"));
    Table::of(
        accounts,
        &[
            (Column::left("", 18), &|it| it.planner.to_owned()),
            (Column::right("objective", 9), &|it| figure(it.objective)),
            (Column::right("above", 7).apart(), &|it| figure(it.above)),
            (Column::right("line", 7).apart(), &|it| figure(it.line_cost)),
            (Column::right("control", 7).apart(), &|it| format!("{:.3}", it.control_cost)),
            (Column::right("samples", 7).apart(), &|it| it.samples.to_string()),
            (Column::right("bits", 5).apart(), &|it| format!("{:.2}", it.bits)),
            (Column::left("slope arc deg", 24).apart(), &|it| text::arcs(&it.slope_arcs)),
            (Column::left("broken", 0), &|it| it.broken.join(", ")),
        ],
    )
}

/// The constraints that were broken.
fn broken(accounts: &[Account]) -> String {
    let mut text = String::new();
    for account in accounts {
        for constraint in &account.broken {
            let planner = account.planner;
            let sum = account.label_sum;
            let told = match *constraint {
                "labels" => {
                    format!("labels sum up to {sum:+}, the start's included; -1 to 1 is asked")
                }
                "line" => {
                    "no line has all samples on the sides of their labels as far off as is asked"
                        .into()
                }
                _ => format!("ended after {} motions", account.steps),
            };
            let _ = writeln!(text, "{planner}: {told}.");
        }
    }
    if text.is_empty() {
        text
    } else {
        format!("\n{text}What breaks a constraint has no objective to compare.\n")
    }
}

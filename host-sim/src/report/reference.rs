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
        Some(recording) => steps(&recording.results.steps),
        None if instance.begin().is_none() => {
            "No line has the oracle's points on the sides of their labels, a metre off.\n"
                .to_owned()
        }
        None => "No sequence of so many motions keeps the constraints.\n".to_owned(),
    };
    text.push('\n');
    text += &table(accounts);
    text += &broken(accounts);
    text
}

/// The motions.
fn steps(steps: &[StepResult]) -> String {
    let mut table = Table::new([
        Column::right("step", 4),
        Column::right("v", 5).apart(),
        Column::right("w", 6).apart(),
        Column::right("x", 7).apart(),
        Column::right("z", 7).apart(),
        Column::right("label", 5).apart(),
        Column::left("slope arc deg", 16).apart(),
        Column::right("bits", 5),
    ]);
    for step in steps {
        table.row([
            step.step.to_string(),
            format!("{:.2}", step.action.v),
            format!("{:.2}", step.action.w),
            format!("{:.3}", step.pose.x),
            format!("{:.3}", step.pose.z),
            text::signed(step.fact),
            text::arcs(&step.slope_arcs),
            format!("{:.2}", step.bits),
        ]);
    }
    table.to_string()
}

/// The cost of each.
fn table(accounts: &[Account]) -> String {
    let mut table = Table::new([
        Column::left("", 18),
        Column::right("objective", 9),
        Column::right("above", 7).apart(),
        Column::right("line", 7).apart(),
        Column::right("control", 7).apart(),
        Column::right("samples", 7).apart(),
        Column::right("bits", 5).apart(),
        Column::left("slope arc deg", 24).apart(),
        Column::left("broken", 0),
    ]);
    let figure = |value: Option<f64>| value.map_or("-".to_owned(), |it| format!("{it:.3}"));
    for account in accounts {
        table.row([
            account.planner.to_owned(),
            figure(account.objective),
            figure(account.above),
            figure(account.line_cost),
            format!("{:.3}", account.control_cost),
            account.samples.to_string(),
            format!("{:.2}", account.bits),
            text::arcs(&account.slope_arcs),
            account.broken.join(", "),
        ]);
    }
    table.to_string()
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

//! Campaigns that seek: a line for the planner and one for a lawnmower, for each kind of boundary.

use crate::campaign::patches::flight::Row;
use crate::report::table::{Column, Table};

/// Who seeks, in the order of the rows.
const WHO: [&str; 2] = ["route", "lawnmower"];

/// The table of the rows of each.
pub fn text(rows: &[Vec<Row>], (missions, seed): (u64, u64)) -> String {
    let mut table = Table::new([
        Column::left("boundary", 25),
        Column::right("p", 4),
        Column::left("sought by", 10).apart(),
        Column::right("found %", 8),
        Column::right("metres", 7),
        Column::right("90 %", 6),
        Column::right("most", 6),
        Column::right("closing", 8),
        Column::right("false %", 8),
        Column::right("empty %", 8),
        Column::right("stuck %", 8),
    ]);
    let number = |it: Option<f64>| it.map_or("-".to_owned(), |it| format!("{it:.0}"));
    let percent = |it: f64| format!("{:.1}", 100.0 * it);
    for n in 0..rows.first().map_or(0, Vec::len) {
        for (k, (who, rows)) in WHO.iter().zip(rows).enumerate() {
            let Some(row) = rows.get(n) else { continue };
            let named =
                if k == 0 { [row.kind.to_owned(), row.p.to_string()] } else { Default::default() };
            let figures = [
                percent(row.found),
                number(row.metres[0]),
                number(row.metres[1]),
                number(row.metres[2]),
                row.closing.map_or("-".to_owned(), |it| it.to_string()),
                percent(row.false_finds),
                percent(row.empty),
                percent(row.stuck),
            ];
            table.row(named.into_iter().chain([(*who).to_owned()]).chain(figures));
        }
    }
    format!(
        "{missions} missions of each kind, seed {seed}; motions of up to 3 m\n\n{table}\n\
         metres: driven until the boundary was found, the median, 90 % and all of the missions\n\
         closing: steps from the first true crossing until it was found, the median\n\
         false: found where there is none; empty: said that all has one label; stuck: stopped for another reason\n"
    )
}

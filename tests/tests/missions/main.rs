//! Whole missions in simulated worlds: how they end, what they find, and what they never do.

mod alarms;
mod anything;
mod campaign;
mod deviations;
mod doubtful_audits;
mod far;
mod fields;
mod fronts;
mod goals;
mod honesty;
mod lakes;
mod lawnmower;
mod lookahead;
mod margin;
mod next;
mod pairs;
mod porter;
mod readings;
mod scale;
mod seeking;
mod sleep;
mod symmetry;
mod terrain;
mod unknown_p;
mod watching;
mod worth;

//! Many missions over standard fields, on all cores, and their results: a row for each mission and stage, and a summary
//! of the rows.

pub mod accuracy;
pub mod calibration;
pub mod course;
pub mod drawn;
pub mod ensemble;
pub mod field_record;
pub mod fronts;
mod kinds;
pub mod patches;
pub mod rows;
pub mod spread;
pub mod standard_field;

//! Recorded samples: how files are read, and what [`fitting`](crate::fitting) says of them.

pub mod answer;
pub mod columns;
pub mod crs;
mod degrees;
pub mod delimiter;
mod encoding;
#[cfg(test)]
mod false_alarms;
mod figure;
mod fills;
mod fit_record;
mod fit_words;
pub mod frame;
mod front_drawing;
pub mod front_map;
mod front_record;
mod front_words;
pub mod geojson;
pub mod geojson_file;
pub mod gpx_file;
mod joined_drawing;
pub mod joined_map;
mod joined_words;
pub mod label_name;
pub mod label_words;
mod map_file;
pub mod missing;
pub mod numbers;
mod reading;
pub mod record;
pub mod rows;
pub mod sample_file;
pub mod swapped;
pub mod table_file;
pub mod trace_file;
mod track;
mod words;

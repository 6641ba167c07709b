#![no_main]
//! Recorded samples: what they determine has every sample on its side, or one line says what is wrong and
//! where.

use host_sim::replay::Report as _;
use host_sim::replay::answer::Trust;
use host_sim::replay::line::Replay;
use host_sim::replay::rows::Layout;
use libfuzzer_sys::fuzz_target;

fuzz_target!(|text: &[u8]| {
    match Replay::parse("it.csv", text, &Layout::default(), Trust::default()) {
        Ok(replay) => {
            let record: serde_json::Value = serde_json::from_str(&replay.json()).expect("a record");
            let (samples, matter) = (record["samples"].as_u64(), record["matter"].as_u64());
            assert!(matter >= Some(3) && matter <= samples, "{record}");
            let arcs = record["slope_arcs"].as_array().expect("arcs");
            assert!((1..=2).contains(&arcs.len()));
            assert!(!replay.words().contains("NaN"), "{}", replay.words());
        }
        Err(error) => {
            let message = format!("{error:#}");
            assert!(message.starts_with("it.csv:") && !message.contains('\n'), "{message}");
        }
    }
});

//! What is kept beside rows that are part of something: which campaign they belong to, and which fields.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context as _, Result, bail};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::campaign::shard::Shard;
use crate::cli::campaign_flags::CampaignFlags;
use crate::mission::vehicle::Source;

/// Which rows a file has.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub(crate) struct CampaignRecord {
    /// Of the program.
    pub(crate) version: String,
    /// As they were given.
    pub(crate) flags: CampaignFlags,
    /// Which fields.
    pub(crate) shard: Shard,
    /// Length of the complete file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) bytes: Option<u64>,
}

impl CampaignRecord {
    /// Of what this program writes.
    pub(crate) fn new(flags: CampaignFlags, shard: Shard) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Self { version, flags, shard, bytes: None }
    }

    /// Whether rows with this record are those that this one would have.
    ///
    /// # Errors
    /// Names what differs.
    pub(crate) fn check(&self, found: &str) -> Result<()> {
        let found: Self = serde_json::from_str(found).context("its record")?;
        self.check_same(&found)?;
        if found.shard != self.shard {
            bail!("found a campaign with --shard {}, expected {}", found.shard, self.shard);
        }
        Ok(())
    }

    /// Whether another is of the same version and the same flags.
    ///
    /// # Errors
    /// Names the one that differs.
    pub(crate) fn check_same(&self, found: &Self) -> Result<()> {
        if found.version != self.version {
            bail!("found a campaign of version {}, expected {}", found.version, self.version);
        }
        let (mut expected, mut found) = (flags_told(&self.flags)?, flags_told(&found.flags)?);
        let flags: BTreeSet<_> = expected.keys().chain(found.keys()).cloned().collect();
        for flag in flags {
            let [expected, found] = [&mut expected, &mut found]
                .map(|told| told.remove(&flag).unwrap_or(format!("no {flag}")));
            if found != expected {
                bail!("found a campaign with {found}, expected {expected}");
            }
        }
        Ok(())
    }
}

/// Each flag, and how it is given, or that it is not.
fn flags_told(flags: &CampaignFlags) -> Result<BTreeMap<String, String>> {
    let mut told = BTreeMap::new();
    let mut add = |flag: String, value: &Value| {
        let given = tell(&flag, value);
        told.insert(flag, given);
    };
    if let Value::Object(flags) = serde_json::to_value(flags)? {
        for (flag, value) in flags {
            match value {
                Value::Object(vehicle) => {
                    vehicle.iter().for_each(|(key, it)| add(Source::Flags.name(key), it));
                }
                value => add(format!("--{flag}"), &value),
            }
        }
    }
    Ok(told)
}

fn tell(flag: &str, value: &Value) -> String {
    match value {
        Value::Null | Value::Bool(false) => format!("no {flag}"),
        Value::Array(list) if list.is_empty() => format!("no {flag}"),
        Value::Bool(true) => flag.to_owned(),
        Value::String(name) => format!("{flag} {name}"),
        Value::Array(list) => {
            let names: Vec<_> = list.iter().filter_map(Value::as_str).collect();
            format!("{flag} {}", names.join(","))
        }
        value => format!("{flag} {value}"),
    }
}

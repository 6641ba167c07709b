//! What is kept beside rows that are part of something: which campaign they belong to, and which fields.

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
        let flags = |record: &Self| flags_told(&record.flags);
        for (expected, found) in flags(self)?.into_iter().zip(flags(found)?) {
            if found != expected {
                bail!("found a campaign with {found}, expected {expected}");
            }
        }
        Ok(())
    }
}

/// Each flag as it is given, or that it is not.
fn flags_told(flags: &CampaignFlags) -> Result<Vec<String>> {
    let mut told = Vec::new();
    if let Value::Object(flags) = serde_json::to_value(flags)? {
        for (flag, value) in flags {
            match value {
                Value::Object(vehicle) => {
                    told.extend(vehicle.iter().map(|(key, it)| tell(&Source::Flags.name(key), it)));
                }
                value => told.push(tell(&format!("--{flag}"), &value)),
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

//! The record stored beside partial rows: which campaign they belong to, and which fields.

use std::collections::{BTreeMap, BTreeSet};

use anyhow::{Context as _, Result, bail};
use serde::{Deserialize, Serialize};
use serde_json::Value;

use crate::campaign::shard::Shard;
use crate::cli::campaign_flags::CampaignFlags;
use crate::mission::vehicle::Source;
use crate::output::checksum::Checksum;

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
    /// What this build flies with these flags, see [`behaviour`](crate::campaign::behaviour). Builds of before there
    /// was one wrote none.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) behaviour: Option<Checksum>,
    /// Length of the complete file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) bytes: Option<u64>,
    /// Of the complete file.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) checksum: Option<Checksum>,
}

impl CampaignRecord {
    /// Of what this program writes.
    pub(crate) fn new(flags: CampaignFlags, shard: Shard) -> Self {
        let version = env!("CARGO_PKG_VERSION").to_owned();
        Self { version, flags, shard, behaviour: None, bytes: None, checksum: None }
    }

    /// Reads the record of a complete shard.
    ///
    /// # Errors
    /// Says what is wrong with it.
    pub(crate) fn of_shard(text: &str) -> Result<Self> {
        if !text.ends_with('\n') {
            bail!("found a record that was cut off, expected a whole one: fly the shard again");
        }
        let record: Self =
            serde_json::from_str(text).context("expected the record of a campaign's shard")?;
        let (fields, shard) = (record.flags.fields, record.shard);
        if shard.of > fields {
            bail!("found shard {shard} of {fields} fields, expected at most as many shards");
        }
        for (key, is_there) in
            [("behaviour", record.behaviour.is_some()), ("checksum", record.checksum.is_some())]
        {
            if !is_there {
                bail!(
                    "found no {key}, expected one, which this version writes: fly the shard again"
                );
            }
        }
        Ok(record)
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

    /// Whether another is of the same version, flags and build.
    ///
    /// # Errors
    /// Names the one that differs.
    pub(crate) fn check_same(&self, found: &Self) -> Result<()> {
        if found.version != self.version {
            bail!("found a campaign of version {}, expected {}", found.version, self.version);
        }
        let found_behaviour = found.behaviour;
        let (mut expected, mut found) = (flags_told(&self.flags)?, flags_told(&found.flags)?);
        let flags: BTreeSet<_> = expected.keys().chain(found.keys()).cloned().collect();
        for flag in flags {
            let [expected, found] = [&mut expected, &mut found]
                .map(|told| told.remove(&flag).unwrap_or(format!("no {flag}")));
            if found != expected {
                bail!("found a campaign with {found}, expected {expected}");
            }
        }
        if self.behaviour != found_behaviour {
            bail!(
                "found a campaign of another build, which flies other missions, expected one of this build"
            );
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

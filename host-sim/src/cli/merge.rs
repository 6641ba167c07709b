//! `campaign merge`: the shards of a campaign, put together.

use std::fs::{self, File};
use std::io::{self, Read, Write as _};
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, anyhow, bail};
use clap::Args;

use crate::campaign::ensemble::{Campaign, Measure};
use crate::campaign::order::Order;
use crate::campaign::rows::{Planners, RowReader, RowWriter};
use crate::cli::campaign_record::CampaignRecord;
use crate::cli::format::Format;
use crate::cli::help;
use crate::cli::passage::{Destination, Passage};
use crate::cli::told::{Opening, tell};
use crate::output::checksum::Checksum;
use crate::output::file::{Output, place_for, prepare};
use crate::output::kind;
use crate::output::partial::{check_free, with_suffix};

#[derive(Debug, Args)]
#[command(after_help = help::MERGE)]
pub(crate) struct MergeArgs {
    /// The rows of all shards, in any order; beside each is its record, SHARD.csv.json
    #[arg(value_name = "SHARD.csv", required = true)]
    pub(crate) shards: Vec<PathBuf>,
    /// Write the rows of the whole here
    #[arg(long, value_name = "WHOLE.csv")]
    pub(crate) csv: Option<PathBuf>,
    /// Draw how errors shrink and bits grow here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

/// Puts them together, and what to print.
pub(crate) fn merge(args: &MergeArgs) -> Result<String> {
    let records: Vec<_> = args.shards.iter().map(|path| with_suffix(path, ".json")).collect();
    let inputs: Vec<(&str, &Path)> = args
        .shards
        .iter()
        .map(|path| ("a shard", &**path))
        .chain(records.iter().map(|path| ("the record of a shard", &**path)))
        .collect();
    let asked = [("--csv", args.csv.as_deref()), ("--figure", args.figure.as_deref())];
    let [output, drawn] = prepare(&inputs, asked)?;
    args.csv.as_deref().map_or(Ok(()), |path| check_free(path, &place_for(path)?, "rows"))?;
    let records = args.shards.iter().zip(&records).map(|(path, record)| read(path, record));
    let shards = in_order(records.collect::<Result<_>>()?)?;
    let campaigns = shards[0].record.flags.campaigns()?;
    let planners = campaigns.planners();
    let shards = Shards { recorded: &shards, campaigns: &campaigns.of_each, planners, output };
    let told = tell(&campaigns, shards, args.format)?;
    if let Some(output) = drawn {
        output.write(told.curves.svg())?;
    }
    Ok(told.text)
}

/// A shard as it was read.
struct Recorded<'a> {
    path: &'a Path,
    record: CampaignRecord,
}

/// Reads the record of a shard, and whether it is the file's.
fn read<'a>(path: &'a Path, record: &Path) -> Result<Recorded<'a>> {
    let name = record.display();
    let text = fs::read_to_string(record).map_err(|error| {
        let (found, rows) = (kind::unread(&error), path.display());
        anyhow!("{name}: found {found}, expected the record of {rows}")
    })?;
    let record = CampaignRecord::of_shard(&text).with_context(|| name.to_string())?;
    let shard = path.display();
    let mut checksum = Checksum::default();
    let found = File::open(path).and_then(|mut file| io::copy(&mut file, &mut checksum));
    let found = found.with_context(|| shard.to_string())?;
    if record.bytes != Some(found) {
        let expected = record.bytes.map_or("none".to_owned(), |bytes| bytes.to_string());
        bail!("{shard}: found {found} bytes, expected {expected}, as {name} has it");
    }
    if let Some(expected) = record.checksum.filter(|it| *it != checksum) {
        bail!(
            "{shard}: found rows of checksum {checksum}, expected {expected}, as {name} has it: they were changed, fly \
             the shard again"
        );
    }
    Ok(Recorded { path, record })
}

/// Whether they are the shards of one campaign, each there once; in the order of their fields.
fn in_order(mut shards: Vec<Recorded>) -> Result<Vec<Recorded>> {
    shards.sort_by_key(|it| it.record.shard.number);
    let (first, others) = shards.split_first().context("at least one shard")?;
    let (as_in, of) = (first.path.display(), first.record.shard.of);
    for other in others {
        let name = other.path.display();
        let same = first.record.check_same(&other.record);
        same.with_context(|| format!("{name}: not of the campaign of {as_in}"))?;
        if other.record.shard.of != of {
            let shard = other.record.shard;
            bail!("{name}: found shard {shard}, expected one of {of}, as {as_in} is");
        }
    }
    for (number, shard) in (1..).zip(&shards) {
        let found = shard.record.shard;
        if found.number < number {
            bail!("{}: found shard {found} twice, expected it once", shard.path.display());
        }
        if found.number > number {
            bail!("found no shard {number}/{of}, expected each of {of} once");
        }
    }
    if (shards.len() as u64) < of {
        bail!("found no shard {}/{of}, expected each of {of} once", shards.len() + 1);
    }
    Ok(shards)
}

/// Shards that are to be put together.
struct Shards<'a> {
    recorded: &'a [Recorded<'a>],
    campaigns: &'a [Campaign],
    planners: Planners,
    output: Option<Output>,
}

impl Opening for Shards<'_> {
    fn open<M: Measure>(self, measure: &M) -> Result<Passage<'_, M>> {
        let Self { recorded, campaigns, planners, output } = self;
        let recorded = recorded.iter().map(|it| {
            let name = it.path.display().to_string();
            let from: Box<dyn Read> = Box::new(File::open(it.path).with_context(|| name.clone())?);
            let CampaignRecord { flags, shard, .. } = &it.record;
            let order = Order::new(measure, campaigns, shard.fields(flags.fields));
            RowReader::new(&name, from, &planners, order)
        });
        let recorded = recorded.collect::<Result<_>>()?;
        let writer = match output {
            Some(mut output) => {
                output.write_all(planners.header::<M::Checkpoint>()?.as_bytes())?;
                Some(RowWriter::new(Destination::Output(output), &planners))
            }
            None => None,
        };
        Ok(Passage { measure, recorded, to_fly: None, writer, wants_recorded: true })
    }
}

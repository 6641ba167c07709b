//! `campaign`: the standard fields, all of them or a shard.

use std::io::{Read, Write as _};
use std::ops::Range;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result, bail};
use clap::{Args, Subcommand};

use crate::campaign::behaviour::behaviour;
use crate::campaign::ensemble::{Campaign, Checkpoint as _, Measure};
use crate::campaign::field_record;
use crate::campaign::order::Order;
use crate::campaign::rows::{Planners, RowReader, RowWriter};
use crate::campaign::shard::Shard;
use crate::cli::campaign_flags::CampaignFlags;
use crate::cli::campaign_record::CampaignRecord;
use crate::cli::format::Format;
use crate::cli::fronts::FrontsFlags;
use crate::cli::help;
use crate::cli::merge::{MergeArgs, merge};
use crate::cli::passage::{Destination, Passage, ToFly};
use crate::cli::patches::PatchesFlags;
use crate::cli::told::{Opening, tell};
use crate::output::ending;
use crate::output::file::{Output, json, place_for, prepare};
use crate::output::partial::{Begin, Partial, Record};

#[derive(Debug, Args)]
#[command(args_conflicts_with_subcommands = true, after_help = help::CAMPAIGN)]
pub(crate) struct CampaignArgs {
    #[command(subcommand)]
    pub(crate) command: Option<CampaignCommand>,
    #[command(flatten)]
    pub(crate) flags: CampaignFlags,
    #[command(flatten)]
    pub(crate) fronts: FrontsFlags,
    #[command(flatten)]
    pub(crate) patches: PatchesFlags,
    /// Write a row for each field and stage here, as they are finished
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// Continue after the finished rows of the same command, if it was stopped
    #[arg(long, requires = "csv")]
    pub(crate) resume: bool,
    /// Fly one of N blocks of the fields only, the first is 1/N; `campaign merge` puts them together
    #[arg(long, value_name = "K/N", requires = "csv")]
    pub(crate) shard: Option<Shard>,
    /// Write the fields themselves here: oracle, start and true line of each
    #[arg(long, value_name = "FILE")]
    pub(crate) fields_csv: Option<PathBuf>,
    /// Draw how errors shrink and bits grow here
    #[arg(long, value_name = "FILE.svg")]
    pub(crate) figure: Option<PathBuf>,
    /// What to print
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: Format,
}

#[derive(Debug, Subcommand)]
pub(crate) enum CampaignCommand {
    /// Put the shards of a campaign together: its rows and tables
    Merge(MergeArgs),
}

/// Flies them, and what to print.
pub(crate) fn campaign(args: CampaignArgs) -> Result<String> {
    let CampaignArgs {
        command,
        flags,
        fronts,
        patches,
        csv,
        resume,
        shard: part,
        fields_csv,
        figure,
        format,
    } = args;
    if let Some(CampaignCommand::Merge(args)) = command {
        return merge(&args);
    }
    if fronts.fronts {
        return fronts.tell(&flags, format);
    }
    if patches.patches {
        return patches.tell(&flags, format);
    }
    let mut campaigns = flags.campaigns()?;
    let shard = part.unwrap_or(Shard::WHOLE);
    let of_all = flags.fields;
    if shard.of > of_all {
        bail!("--shard: found {shard} of {of_all} fields, expected at most as many shards");
    }
    let fields = shard.fields(of_all);
    for campaign in &mut campaigns.of_each {
        campaign.fields = fields.end - fields.start;
        campaign.check()?;
    }
    let title = match (part, format) {
        (Some(_), Format::Text) => {
            format!("Shard {shard}: fields {} to {} of {of_all}\n\n", fields.start, fields.end - 1)
        }
        _ => String::new(),
    };
    let rows: Vec<_> = csv.iter().map(|path| ("the place of --csv", &**path)).collect();
    let asked = [("--fields-csv", fields_csv.as_deref()), ("--figure", figure.as_deref())];
    let [output, drawn] = prepare(&rows, asked)?;
    csv.as_deref().map_or(Ok(()), |path| ending::check("--csv", path))?;
    if let (Some(output), Some(campaign)) = (output, campaigns.of_each.first()) {
        write_fields(campaign, fields.clone(), output)?;
    }
    let to_fly = ToFly { from: (0, fields.start), fields };
    let record = CampaignRecord::new(flags, shard);
    let opening = Begun {
        csv: csv.as_deref(),
        resume,
        is_shard: part.is_some(),
        record,
        campaigns: &campaigns.of_each,
        planners: campaigns.planners(),
        to_fly,
    };
    let told = tell(&campaigns, opening, format)?;
    if let Some(output) = drawn {
        output.write(told.curves.svg())?;
    }
    Ok(title + &told.text)
}

/// Writes the fields, which are the same for every planner.
fn write_fields(campaign: &Campaign, fields: Range<u64>, mut output: Output) -> Result<()> {
    output.write_all(field_record::COLUMNS.as_bytes())?;
    let mut writer = csv::WriterBuilder::new().has_headers(false).from_writer(output);
    for field in fields {
        let row = field_record::row(field, &campaign.mission(field));
        writer.serialize(row.context("a standard field")?)?;
    }
    writer.into_inner().map_err(csv::IntoInnerError::into_error)?.complete()
}

/// A campaign that is to be flown.
struct Begun<'a> {
    csv: Option<&'a Path>,
    resume: bool,
    is_shard: bool,
    record: CampaignRecord,
    campaigns: &'a [Campaign],
    planners: Planners,
    to_fly: ToFly,
}

impl Opening for Begun<'_> {
    fn open<M: Measure>(self, measure: &M) -> Result<Passage<'_, M>> {
        let Self { csv, resume, is_shard, mut record, campaigns, planners, mut to_fly } = self;
        let (mut recorded, mut writer) = (Vec::new(), None);
        if let Some(path) = csv {
            let header = planners.header::<M::Checkpoint>()?;
            let place = place_for(path)?;
            let destination = if place.is_stream() {
                for (flag, is_given) in [("--resume", resume), ("--shard", is_shard)] {
                    if is_given {
                        bail!("{}: found a stream, expected a file with {flag}", path.display());
                    }
                }
                let [output] = prepare(&[], [("--csv", Some(path))])?;
                let mut output = output.context("a place that was asked for")?;
                output.write_all(header.as_bytes())?;
                Destination::Output(output)
            } else {
                let fields = record.flags.fields;
                record.behaviour = Some(behaviour(campaigns, fields, &planners, measure)?);
                let (text, check) = (json(&record), |found: &str| record.check(found));
                let beside = Some(Record { text: &text, check: &check });
                let begin = Begin { holds: "rows", header: &header, record: beside, resume };
                let mut partial = Partial::open(path, &place, begin)?;
                if resume {
                    let order = Order::new(measure, campaigns, to_fly.fields.clone()).beginning();
                    recorded.push(go_on::<M>(&mut partial, &planners, &order, &mut to_fly)?);
                }
                partial.announce();
                Destination::Partial(partial, is_shard.then(|| record.into()))
            };
            writer = Some(RowWriter::new(destination, &planners));
        }
        Ok(Passage { measure, recorded, to_fly: Some(to_fly), writer, wants_recorded: false })
    }
}

/// Reads the finished rows, up to the first incomplete one. Rows of the last field may be missing: it is flown again,
/// with the same result.
fn go_on<M: Measure>(
    partial: &mut Partial,
    planners: &Planners,
    order: &Order,
    to_fly: &mut ToFly,
) -> Result<RowReader<Box<dyn Read>, M::Checkpoint>> {
    let name = partial.name().to_owned();
    let read = |bytes| {
        let from: Box<dyn Read> = Box::new(partial.reader(bytes)?);
        RowReader::<_, M::Checkpoint>::new(&name, from, planners, order.clone())
    };
    let mut kept = planners.header::<M::Checkpoint>()?.len() as u64;
    let mut rows = read(u64::MAX)?;
    while let Ok(Some(row)) = rows.read() {
        let at = (row.planner, row.row.checkpoint.field());
        if at != to_fly.from {
            (to_fly.from, kept) = (at, row.begins);
        }
    }
    let rows = read(kept)?;
    partial.cut(kept).with_context(|| name.clone())?;
    Ok(rows)
}

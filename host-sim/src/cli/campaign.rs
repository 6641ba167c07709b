//! `campaign`: the standard fields, all of them or a block.

use std::io::Write as _;
use std::ops::Range;
use std::path::PathBuf;

use anyhow::{Context as _, Result};
use clap::Args;

use crate::campaign::ensemble::Campaign;
use crate::campaign::field_record;
use crate::cli::campaign_flags::CampaignFlags;
use crate::cli::format::Format;
use crate::cli::fronts::FrontsFlags;
use crate::cli::help;
use crate::cli::patches::PatchesFlags;
use crate::cli::told::{Flown, tell};
use crate::output::ending;
use crate::output::file::{Output, prepare};

#[derive(Debug, Args)]
#[command(after_help = help::CAMPAIGN)]
pub(crate) struct CampaignArgs {
    #[command(flatten)]
    pub(crate) flags: CampaignFlags,
    #[command(flatten)]
    pub(crate) fronts: FrontsFlags,
    #[command(flatten)]
    pub(crate) patches: PatchesFlags,
    /// Write a row for each field and stage here, as they are finished
    #[arg(long, value_name = "FILE")]
    pub(crate) csv: Option<PathBuf>,
    /// The number of the first field: several machines share the fields by it
    #[arg(
        long,
        value_name = "FIELD",
        default_value_t = 0,
        value_parser = clap::value_parser!(u64).range(..=1_000_000_000)
    )]
    pub(crate) from: u64,
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

/// Flies them, and what to print.
pub(crate) fn campaign(args: &CampaignArgs) -> Result<String> {
    let CampaignArgs { flags, fronts, patches, csv, from, fields_csv, figure, format } = args;
    if fronts.fronts {
        return fronts.tell(flags, *format);
    }
    if patches.patches {
        return patches.tell(flags, *format);
    }
    let campaigns = flags.campaigns()?;
    campaigns.of_each.iter().try_for_each(Campaign::check)?;
    let fields = *from..from + flags.fields;
    let title = match format {
        Format::Text if *from > 0 => format!("Fields {from} to {}\n\n", fields.end - 1),
        _ => String::new(),
    };
    let rows: Vec<_> = csv.iter().map(|path| ("the place of --csv", &**path)).collect();
    let asked = [("--fields-csv", fields_csv.as_deref()), ("--figure", figure.as_deref())];
    let [output, drawn] = prepare(&rows, asked)?;
    csv.as_deref().map_or(Ok(()), |path| ending::check("--csv", path))?;
    if let (Some(output), Some(campaign)) = (output, campaigns.of_each.first()) {
        write_fields(campaign, fields.clone(), output)?;
    }
    let told = tell(&campaigns, &Flown { fields, csv: csv.as_deref() }, *format)?;
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

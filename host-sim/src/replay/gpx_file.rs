//! The samples of a GPX file: way points, route points and track points, with an element that is their label.

use anyhow::{Context as _, Result, anyhow, bail};
use roxmltree::{Document, Node};

use crate::replay::label_name::{label_name, no_label};
use crate::replay::label_words::LabelWords;
use crate::replay::missing::is_missing;
use crate::replay::numbers::{self, Decimal, Numbers};
use crate::replay::rows::{Layout, Rows};

/// Elements that are points.
const POINTS: [&str; 3] = ["wpt", "rtept", "trkpt"];

/// The points of a file, in their order there.
///
/// # Errors
/// Names the file and the line, what was found and what was expected.
pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Rows> {
    numbers::settled(|decimal| pass(name, text, layout, decimal))
}

fn pass(
    name: &str,
    text: &[u8],
    layout: &Layout,
    settled: Option<Decimal>,
) -> Result<(Rows, Option<Decimal>)> {
    let wanted = label_name(name, "GPX", layout)?;
    let text = std::str::from_utf8(text)
        .map_err(|error| anyhow!("{name}: expected XML in UTF-8: {error}"))?;
    let document = Document::parse(text)
        .map_err(|error| anyhow!("{name}:{}: expected XML: {error}", error.pos().row))?;
    let root = document.root_element();
    if root.tag_name().name() != "gpx" {
        let found = root.tag_name().name();
        let line = document.text_pos_at(root.range().start).row;
        bail!("{name}:{line}: found the element {found:?}, expected gpx");
    }
    let is_point = |node: &Node| node.is_element() && POINTS.contains(&node.tag_name().name());
    let mut numbers = Numbers::of(None, settled);
    let mut words = LabelWords::of(layout.threshold);
    let mut rows = Rows { is_geographic: true, ..Rows::default() };
    let (mut line, mut seen) = (1, 0);
    // The elements of the first point, and whether any point has the wanted one.
    let (mut others, mut has_label) = (None, false);
    for point in root.descendants().filter(is_point) {
        let begins = point.range().start;
        line += text[seen..begins].matches('\n').count();
        seen = begins;
        let at = |error: anyhow::Error| anyhow!("{name}:{line}: {error}");
        let label = label(point, wanted);
        has_label |= label.is_some();
        others.get_or_insert_with(|| (line, elements(point)));
        let mut position = [0.0; 2];
        let mut lacks = None;
        for (value, attribute) in position.iter_mut().zip(["lat", "lon"]) {
            let field = point.attribute(attribute);
            let field = field
                .with_context(|| format!("found a point without {attribute}, expected degrees"))
                .map_err(at)?
                .trim();
            if is_missing(field) {
                lacks = Some(format!("{attribute}: found {field:?}"));
                continue;
            }
            *value = numbers
                .read(field, line)
                .with_context(|| format!("{attribute}: found {field:?}, expected a finite number"))
                .map_err(at)?;
        }
        let label = label.unwrap_or_default();
        if is_missing(label) {
            lacks = Some(format!("label: found {label:?} in {wanted}"));
        }
        if let Some(lacks) = lacks {
            rows.skip(layout, line, lacks).map_err(at)?;
            continue;
        }
        rows.push(position, words.read(label, &mut numbers, line).map_err(at)?, line);
    }
    match others {
        None => bail!("{name}: found GPX with no points, expected wpt, rtept or trkpt"),
        Some((line, others)) if !has_label => {
            return Err(no_label(&format!("{name}:{line}"), wanted, layout, &others));
        }
        Some(_) => {}
    }
    let at = |(line, error)| anyhow!("{name}:{line}: {error}");
    words.end().map_err(at)?;
    let settled = numbers.end().map_err(at)?;
    Ok((rows, settled))
}

/// The text of the element called `wanted`: a child, or else one further below, as in extensions.
fn label<'a>(point: Node<'a, '_>, wanted: &str) -> Option<&'a str> {
    // Which prefix stands for a namespace is up to the file.
    let wanted = wanted.rsplit(':').next().unwrap_or(wanted);
    let is_it = |node: &Node| node.is_element() && node.tag_name().name() == wanted;
    let found = point.children().find(is_it).or_else(|| point.descendants().skip(1).find(is_it));
    found.map(|node| node.text().unwrap_or_default().trim())
}

/// The names of the elements below a point that have a text.
fn elements(point: Node) -> Vec<String> {
    let below = point.descendants().skip(1).filter(Node::is_element);
    let texts = below.filter(|node| node.text().is_some_and(|text| !text.trim().is_empty()));
    texts.map(|node| node.tag_name().name().to_owned()).collect()
}

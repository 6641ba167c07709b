//! The samples of a GPX file: way points, route points and track points, with an element that is their label.

use anyhow::{Context as _, Result, anyhow, bail};
use roxmltree::{Document, Node};

use crate::replay::label_name::LabelName;
use crate::replay::missing::is_missing;
use crate::replay::reading::{Reading, Row};
use crate::replay::rows::{Layout, Rows};

/// Elements that are points.
const POINTS: [&str; 3] = ["wpt", "rtept", "trkpt"];

/// The points of a file, in their order there.
///
/// # Errors
/// Names the file and the line, what was found and what was expected.
pub(crate) fn parse(name: &str, text: &[u8], layout: &Layout) -> Result<Rows> {
    Reading::of(name, layout, None, |reading| pass(reading, text))
}

fn pass(reading: &mut Reading, text: &[u8]) -> Result<()> {
    let name = reading.name;
    let mut label = LabelName::of(name, "GPX", reading.layout)?;
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
    reading.rows.is_geographic = true;
    let is_point = |node: &Node| node.is_element() && POINTS.contains(&node.tag_name().name());
    let (mut line, mut seen) = (1, 0);
    for point in root.descendants().filter(is_point) {
        let begins = point.range().start;
        line += text[seen..begins].matches('\n').count();
        seen = begins;
        reading.row(line, |reading| read(reading, &mut label, point, line))?;
    }
    if label.first.is_none() {
        bail!("{name}: found GPX with no points, expected wpt, rtept or trkpt");
    }
    label.end(|line| format!("{name}:{line}"))
}

fn read(reading: &mut Reading, label: &mut LabelName, point: Node, line: usize) -> Result<Row> {
    let wanted = label.wanted;
    let told = text(point, wanted);
    label.see(line, told.is_some(), || elements(point).map(|(name, _)| name).collect());
    let mut position = [0.0; 2];
    let mut lacks = None;
    for (value, attribute) in position.iter_mut().zip(["lat", "lon"]) {
        let field = point.attribute(attribute);
        let field = field
            .with_context(|| format!("found a point without {attribute}, expected degrees"))?
            .trim();
        if is_missing(field) {
            lacks = Some(format!("{attribute}: found {field:?}"));
        } else {
            *value = reading.number(attribute, field, line)?;
        }
    }
    let told = told.unwrap_or_default();
    if is_missing(told) {
        lacks = Some(format!("label: found {told:?} in {wanted}"));
    }
    if let Some(lacks) = lacks {
        return Ok(Row::Gap(lacks));
    }
    reading.keep(elements(point));
    reading.samples(vec![position], told, line)
}

/// The text of the element called `wanted`: a child, or else one further below, as in extensions.
fn text<'a>(point: Node<'a, '_>, wanted: &str) -> Option<&'a str> {
    // Which prefix stands for a namespace is up to the file.
    let wanted = wanted.rsplit(':').next().unwrap_or(wanted);
    let is_it = |node: &Node| node.is_element() && node.tag_name().name() == wanted;
    let found = point.children().find(is_it).or_else(|| point.descendants().skip(1).find(is_it));
    found.map(|node| node.text().unwrap_or_default().trim())
}

/// The elements below a point that have a text: their names and texts.
fn elements(point: Node<'_, '_>) -> impl Iterator<Item = (String, String)> {
    let below = point.descendants().skip(1).filter(Node::is_element);
    let texts = below.map(|it| (it.tag_name().name(), it.text().unwrap_or_default().trim()));
    texts.filter(|(_, text)| !text.is_empty()).map(|(name, text)| (name.into(), text.into()))
}

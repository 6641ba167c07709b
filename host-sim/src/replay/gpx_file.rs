//! The samples of a GPX file: way points, route points and track points, with an element that is their label.

use anyhow::{Context as _, Result, anyhow, bail};
use roxmltree::{Document, Node};

use crate::replay::reading::{Gap, Reading};
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
    let (name, wanted) = (reading.name, reading.label("GPX")?);
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
    let points = root.descendants().filter(is_point).map(|point| {
        let begins = point.range().start;
        line += text[seen..begins].matches('\n').count();
        seen = begins;
        (line, point)
    });
    let points: Vec<_> = points.collect();
    let Some((line, first)) = points.first() else {
        bail!("{name}: found GPX with no points, expected wpt, rtept or trkpt");
    };
    if points.iter().all(|it| label(it.1, wanted).is_none()) {
        let others: Vec<_> = elements(*first).map(|(name, _)| name).collect();
        return Err(reading.no_label(wanted, *line, &others));
    }
    for (line, point) in points {
        reading.row(line, |reading| read(reading, wanted, point, line))?;
    }
    Ok(())
}

fn read(reading: &mut Reading, wanted: &str, point: Node, line: usize) -> Result<Gap> {
    let [lat, lon] = ["lat", "lon"].map(|axis| {
        let field = point.attribute(axis).map(str::trim);
        field.with_context(|| format!("found a point without {axis}, expected degrees"))
    });
    reading.keep(elements(point));
    let label = label(point, wanted).unwrap_or_default();
    reading.sample(["lat", "lon", "label"], [lat?, lon?, label], line)
}

/// The text of the element called `wanted`: a child, or else one further below, as in extensions.
fn label<'a>(point: Node<'a, '_>, wanted: &str) -> Option<&'a str> {
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

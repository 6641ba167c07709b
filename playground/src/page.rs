//! The page: a template, filled with the report's own script and style, this page's, and the module.

const TEMPLATE: &str = include_str!("page/index.html");

/// What fills the slots of the template.
const SLOTS: [(&str, &[&str]); 5] = [
    (
        "style",
        &[
            include_str!("../../host-sim/src/report/page/page.css"),
            include_str!("page/playground.css"),
        ],
    ),
    ("controls", &[include_str!("../../host-sim/src/report/page/controls.html")]),
    // It draws missions.
    (
        "drawing",
        &[
            include_str!("../../host-sim/src/report/page/svg.js"),
            include_str!("../../host-sim/src/report/page/map.js"),
            include_str!("../../host-sim/src/report/page/charts.js"),
        ],
    ),
    // It steps through the first of them as soon as that is flown.
    ("stepping", &[include_str!("../../host-sim/src/report/page/page.js")]),
    (
        "script",
        &[
            include_str!("page/scenario.js"),
            include_str!("page/programs.js"),
            include_str!("page/field.js"),
            include_str!("page/playground.js"),
        ],
    ),
];

/// The page, with a module.
pub(crate) fn of(module: &[u8]) -> String {
    let mut page = TEMPLATE.to_owned();
    for (slot, parts) in SLOTS {
        page = filled(&page, slot, &parts.join("\n"));
    }
    let page = filled(&page, "client", include_str!("page/simulator.js"));
    filled(&page, "module", &base64(module))
}

fn filled(page: &str, slot: &str, text: &str) -> String {
    page.replacen(&format!("{{{{{slot}}}}}"), text, 1)
}

/// RFC 4648, with padding.
fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let mut text = String::with_capacity(bytes.len().div_ceil(3) * 4);
    for group in bytes.chunks(3) {
        let byte = |at: usize| u32::from(group.get(at).copied().unwrap_or(0));
        let bits = byte(0) << 16 | byte(1) << 8 | byte(2);
        for at in 0..4 {
            let letter = LETTERS[(bits >> (18 - 6 * at)) as usize & 63];
            text.push(if at <= group.len() { letter.into() } else { '=' });
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_are_coded_as_the_standard_has_them() {
        for (bytes, text) in
            [("", ""), ("f", "Zg=="), ("fo", "Zm8="), ("foo", "Zm9v"), ("foobar", "Zm9vYmFy")]
        {
            assert_eq!(base64(bytes.as_bytes()), text);
        }
        assert_eq!(base64(&[0xfb, 0xff, 0xbf]), "+/+/");
    }
}

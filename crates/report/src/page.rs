//! The page as text.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use sha2::{Digest, Sha256};

use crate::data::Data;
use crate::error::ReportError;
use crate::library::DrawingLibrary;
use crate::report::Report;

const PAGE: &str = include_str!("../page/page.html");
const STYLE: &str = include_str!("../page/style.css");
/// One script, in this order: later files use what earlier ones define.
const SCRIPTS: [&str; 10] = [
    include_str!("../page/data.js"),
    include_str!("../page/colour.js"),
    include_str!("../page/timeline.js"),
    include_str!("../page/shapes.js"),
    include_str!("../page/arm.js"),
    include_str!("../page/camera.js"),
    include_str!("../page/scene.js"),
    include_str!("../page/plots.js"),
    include_str!("../page/words.js"),
    include_str!("../page/main.js"),
];

/// Puts the page together.
///
/// # Errors
/// [`ReportError::Simulation`] where the run is not one of the plan.
pub fn page(report: &Report, library: &DrawingLibrary) -> Result<String, ReportError> {
    let data = json(&Data::of(report)?);
    let library = library.script();
    let script = format!("'use strict';\n(() => {{\n{}\n}})();\n", SCRIPTS.join("\n"));
    let policy = format!(
        "default-src 'none'; script-src {} {}; style-src {}; img-src data:; base-uri 'none'; form-action 'none'",
        hash(&library),
        hash(&script),
        hash(STYLE)
    );
    let parts = [
        ("{{policy}}", policy),
        ("{{version}}", env!("CARGO_PKG_VERSION").to_owned()),
        ("{{title}}", escaped(report.name)),
        ("{{style}}", STYLE.to_owned()),
        ("{{data}}", data),
        ("{{library}}", library),
        ("{{script}}", script),
    ];
    Ok(filled(PAGE, &parts))
}

/// Each placeholder once, from the first to the last: what was put in is not looked at again.
fn filled(template: &str, parts: &[(&str, String)]) -> String {
    let mut text = String::with_capacity(template.len() + parts.iter().map(|(_, part)| part.len()).sum::<usize>());
    let mut rest = template;
    for (placeholder, part) in parts {
        let (before, after) = rest.split_once(placeholder).unwrap_or((rest, ""));
        text.push_str(before);
        text.push_str(part);
        rest = after;
    }
    text + rest
}

/// As it stands in an element or attribute.
fn escaped(text: &str) -> String {
    let replaced = |character: char| match character {
        '&' => "&amp;".to_owned(),
        '<' => "&lt;".to_owned(),
        '>' => "&gt;".to_owned(),
        '"' => "&quot;".to_owned(),
        other => other.to_string(),
    };
    text.chars().map(replaced).collect()
}

/// As it stands in a script element: `<` begins the only things that end or nest one, and occurs in JSON within strings alone.
fn json(data: &Data) -> String {
    // Numbers, strings and lists always have a JSON form.
    serde_json::to_string(data).unwrap_or_default().replace('<', "\\u003c")
}

/// What a content security policy calls an inline script or style by.
fn hash(text: &str) -> String {
    format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text.as_bytes())))
}

#[cfg(test)]
#[path = "page_tests.rs"]
mod tests;

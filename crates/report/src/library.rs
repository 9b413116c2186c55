//! The drawing library, which is no part of this project.

use std::path::{Path, PathBuf};

use crate::error::ReportError;

/// Where `cargo xtask setup` puts it, in the checkout that this was built from.
const SET_UP: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/../../.deps/browser/node_modules/three/build/three.cjs");

/// The text of three.js's CommonJS build: one script that needs nothing else.
#[derive(Debug, Clone, PartialEq)]
pub struct DrawingLibrary {
    script: String,
}

impl DrawingLibrary {
    /// The file that the set-up made, where there is one. It is looked for when it is needed, not when this is built, so that a set-up
    /// serves programs that were built before.
    pub fn set_up() -> Option<PathBuf> {
        Some(PathBuf::from(SET_UP)).filter(|path| Path::new(path).is_file())
    }

    /// Takes the text of the file.
    ///
    /// # Errors
    /// [`ReportError::Library`] where it is something else.
    pub fn new(text: &str) -> Result<Self, ReportError> {
        let wrong = |reason| Err(ReportError::Library { reason });
        if !text.contains("Three.js Authors") {
            return wrong("it does not name the Three.js Authors");
        }
        if !text.contains("exports.WebGLRenderer") {
            return wrong("it does not export WebGLRenderer");
        }
        if contains_ignoring_case(text, "</script") || text.contains("<!--") {
            return wrong("it would end the script that it stands in");
        }
        Ok(Self { script: text.replace('\r', "") })
    }

    /// A script that defines `THREE`.
    pub(crate) fn script(&self) -> String {
        format!("const THREE = (() => {{\nconst exports = {{}};\n{}\nreturn exports;\n}})();\n", self.script)
    }
}

fn contains_ignoring_case(text: &str, needle: &str) -> bool {
    text.as_bytes().windows(needle.len()).any(|window| window.eq_ignore_ascii_case(needle.as_bytes()))
}

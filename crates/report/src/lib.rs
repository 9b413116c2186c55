//! One self-contained HTML page that shows a person what came of unordered points.
//!
//! ```text
//! points, order, spline, plan or refusal, simulation ─► Data (JSON) ─┐
//! page/*.{html,css,js}, part of this crate ──────────────────────────┼─► page
//! three.js, from an npm package, given at run time ──────────────────┘
//! ```
//!
//! The page loads nothing and sends nothing: its content security policy allows the scripts and the style that are in it, by their
//! hashes, and no connection. What comes from a user (names of files, joints and frames, reasons) is in the page as data alone. The same
//! input gives the same page, byte for byte.

mod data;
mod error;
mod library;
mod motion;
mod packed;
mod page;
mod points;
mod report;
mod simulation;
mod words;

pub use error::ReportError;
pub use library::DrawingLibrary;
pub use page::page;
pub use points::Points;
pub use report::Report;
pub use simulation::Simulation;
pub use words::{Statement, counted, explain};

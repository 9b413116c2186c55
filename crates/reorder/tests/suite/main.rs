//! All tests of the crate in one program: what is generic is compiled once for each space, and not once more for each file.

mod asked_for;
mod certificate;
mod certified_orders;
mod components;
mod errors;
mod experiments;
mod invariance;
mod methods;
mod open_or_closed;
mod passes;
mod random_orders;
mod recovered_order;
mod repair;
mod retraced;
mod sampling;
mod scales;
mod spanning_tree;
#[path = "../support/mod.rs"]
mod support;
mod verdict;

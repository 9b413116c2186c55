//! One measured quantity beside its peer and its bound, as JSON and as a line of a table.

use std::fmt::Write;

use serde_json::{Value, json};

/// A cost: less is better.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Figure {
    pub(crate) name: &'static str,
    pub(crate) unit: &'static str,
    pub(crate) ours: f64,
    /// The same cost of another library, where there is one that could be measured.
    pub(crate) peer: Option<Peer>,
    pub(crate) bound: Bound,
}

/// Another library's cost, in the unit of the figure.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Peer {
    pub(crate) name: &'static str,
    pub(crate) value: f64,
}

/// What must not be exceeded.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Bound {
    /// Our cost, in the unit of the figure.
    Ours(f64),
    /// Our cost divided by the peer's.
    Ratio(f64),
}

impl Figure {
    /// Our cost divided by the peer's.
    fn ratio(&self) -> Option<f64> {
        self.peer.as_ref().map(|peer| self.ours / peer.value)
    }

    /// A ratio that could not be measured, or is not a number, holds no bound.
    fn holds(&self) -> bool {
        match self.bound {
            Bound::Ours(most) => self.ours <= most,
            Bound::Ratio(most) => self.ratio().is_some_and(|ratio| ratio <= most),
        }
    }
}

/// The list that is kept in a file.
pub(crate) fn json(figures: &[Figure]) -> Value {
    let row = |figure: &Figure| {
        let (bounded, bound) = match figure.bound {
            Bound::Ours(most) => ("ours", most),
            Bound::Ratio(most) => ("ratio", most),
        };
        json!({
            "name": figure.name,
            "unit": figure.unit,
            "ours": figure.ours,
            "peer": figure.peer.as_ref().map(|peer| peer.value),
            "peer_name": figure.peer.as_ref().map(|peer| peer.name),
            "ratio": figure.ratio(),
            "bounded": bounded,
            "bound": bound,
            "holds": figure.holds(),
        })
    };
    figures.iter().map(row).collect()
}

/// The table for people; its last line counts the bounds that hold.
pub(crate) fn table(figures: &[Figure]) -> String {
    let number = |value: Option<f64>| value.map_or("-".to_owned(), three_digits);
    let mut text = format!(
        "{:<44}{:>5}{:>10}{:>10}{:>9}{:>14}{:>7}  {}\n",
        "figure", "unit", "ours", "peer", "ratio", "bound", "holds", "peer is"
    );
    for figure in figures {
        let bound = match figure.bound {
            Bound::Ours(most) => format!("≤ {}", three_digits(most)),
            Bound::Ratio(most) => format!("ratio ≤ {}", three_digits(most)),
        };
        let line = format!(
            "{:<44}{:>5}{:>10}{:>10}{:>9}{bound:>14}{:>7}  {}",
            figure.name,
            figure.unit,
            number(Some(figure.ours)),
            number(figure.peer.as_ref().map(|peer| peer.value)),
            number(figure.ratio()),
            if figure.holds() { "yes" } else { "NO" },
            figure.peer.as_ref().map_or("-", |peer| peer.name),
        );
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{line}");
    }
    let held = figures.iter().filter(|figure| figure.holds()).count();
    let _ = write!(text, "{held} of {} bounds hold", figures.len());
    text
}

/// Three significant digits, and whole numbers whole.
fn three_digits(value: f64) -> String {
    if value == value.trunc() && value.abs() < 1e6 {
        return value.to_string();
    }
    let digits_before_point = value.abs().log10().floor() as i32 + 1;
    format!("{value:.*}", (3 - digits_before_point).clamp(0, 9) as usize)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn figures() -> [Figure; 4] {
        let peer = |value| Some(Peer { name: "other 1.2", value });
        [
            Figure { name: "exp", unit: "ns", ours: 8.0, peer: peer(32.0), bound: Bound::Ours(8.0) },
            Figure { name: "log", unit: "ns", ours: 20.5, peer: None, bound: Bound::Ours(15.0) },
            Figure { name: "order", unit: "s", ours: 3.0, peer: peer(4.0), bound: Bound::Ratio(0.65) },
            Figure { name: "read", unit: "s", ours: 0.1234, peer: None, bound: Bound::Ratio(10.0) },
        ]
    }

    #[test]
    fn the_table_has_a_line_a_figure_and_ends_with_the_count() {
        let expected = "\
figure                                       unit      ours      peer    ratio         bound  holds  peer is
exp                                            ns         8        32    0.250           ≤ 8    yes  other 1.2
log                                            ns      20.5         -        -          ≤ 15     NO  -
order                                           s         3         4    0.750 ratio ≤ 0.650     NO  other 1.2
read                                            s     0.123         -        -    ratio ≤ 10     NO  -
1 of 4 bounds hold";
        assert_eq!(table(&figures()), expected);
    }

    #[test]
    fn the_list_has_null_for_a_peer_that_is_not_there() {
        let list = json(&figures());
        let first = json!({
            "name": "exp", "unit": "ns", "ours": 8.0, "peer": 32.0, "peer_name": "other 1.2", "ratio": 0.25,
            "bounded": "ours", "bound": 8.0, "holds": true,
        });
        let last = json!({
            "name": "read", "unit": "s", "ours": 0.1234, "peer": null, "peer_name": null, "ratio": null,
            "bounded": "ratio", "bound": 10.0, "holds": false,
        });
        assert_eq!((&list[0], &list[3]), (&first, &last));
        assert_eq!(list.as_array().map(Vec::len), Some(4));
    }

    #[test]
    fn what_is_not_a_number_holds_no_bound() {
        let broken = Figure { ours: f64::NAN, ..figures()[0].clone() };
        assert!(!broken.holds());
        let fast = Figure { ours: 2.0, ..figures()[2].clone() };
        assert!(fast.holds(), "half of the peer's");
    }

    #[test]
    fn numbers_have_three_digits() {
        let shown = [0.012_34, 0.999, 27.04, 149.6, 1234.5, 15.0].map(three_digits);
        assert_eq!(shown, ["0.0123", "0.999", "27.0", "150", "1234", "15"].map(str::to_owned));
    }
}

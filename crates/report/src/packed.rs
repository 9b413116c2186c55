//! Numbers as the page reads them: base64 of little-endian values, a third of their size in digits.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde::{Serialize, Serializer};

/// A list of numbers; serialises to one string.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum Packed {
    /// Seven digits: places, joint values, figures.
    Single(Vec<f32>),
    /// Times, whose differences matter.
    Double(Vec<f64>),
    /// Rows.
    Index(Vec<u32>),
}

impl Packed {
    pub(crate) fn single(values: impl IntoIterator<Item = f64>) -> Self {
        Self::Single(values.into_iter().map(|value| value as f32).collect())
    }

    pub(crate) fn double(values: impl IntoIterator<Item = f64>) -> Self {
        Self::Double(values.into_iter().collect())
    }

    pub(crate) fn index(values: impl IntoIterator<Item = usize>) -> Self {
        // More rows than that do not fit into a page anyway.
        Self::Index(values.into_iter().map(|value| u32::try_from(value).unwrap_or(u32::MAX)).collect())
    }

    fn bytes(&self) -> Vec<u8> {
        match self {
            Self::Single(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::Double(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
            Self::Index(values) => values.iter().flat_map(|value| value.to_le_bytes()).collect(),
        }
    }
}

impl Serialize for Packed {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(&STANDARD.encode(self.bytes()))
    }
}

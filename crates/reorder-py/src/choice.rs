//! Words for the choices that the libraries know.

use bag_replay::planner::reorder::Weight;
use pyo3::prelude::*;
use serde::de::DeserializeOwned;
use serde::de::IntoDeserializer;
use serde::de::value::{Error, StrDeserializer};

use crate::error::{ReorderError, raised};

/// The choice that `word` stands for, by the names that it has in configuration files and JSON.
pub(crate) fn choice<T: DeserializeOwned>(what: &str, word: &str) -> PyResult<T> {
    let deserializer: StrDeserializer<'_, Error> = word.into_deserializer();
    T::deserialize(deserializer).map_err(|error| raised::<ReorderError>(format!("{what}: {error}")))
}

/// `"auto"` or a number.
#[derive(FromPyObject)]
pub(crate) enum WeightChoice {
    Number(f64),
    Word(String),
}

impl WeightChoice {
    pub(crate) fn weight(&self) -> PyResult<Weight> {
        match self {
            Self::Number(length) => Ok(Weight::MetresPerRadian(*length)),
            Self::Word(word) if word == "auto" => Ok(Weight::Auto),
            Self::Word(word) => {
                Err(raised::<ReorderError>(format!("metres_per_radian: {word:?} is neither a number nor \"auto\"")))
            }
        }
    }
}

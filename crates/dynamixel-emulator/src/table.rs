//! Control tables as the data files in `tables/` say them. Facts from the e-manual's pages of the models.

use crate::error::Error;
use crate::item::Item;
use crate::model::Model;

/// One more than the greatest address of an X-series servo.
pub(crate) const SIZE: usize = 662;
/// Where the RAM area begins; what lies before is EEPROM.
pub(crate) const RAM: u16 = 64;
/// What all X-series servos have alike.
const INDIRECT: &str = include_str!("../tables/indirect.csv");

/// A row of a control table.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Row {
    pub(crate) item: Item,
    pub(crate) name: &'static str,
    pub(crate) writable: bool,
    pub(crate) initial: i32,
    pub(crate) range: Range,
}

/// The values that an item can hold.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Range {
    Any,
    Between(i32, i32),
    OneOf(Vec<i32>),
}

impl Range {
    pub(crate) fn contains(&self, value: i32) -> bool {
        match self {
            Self::Any => true,
            Self::Between(least, greatest) => (*least..=*greatest).contains(&value),
            Self::OneOf(values) => values.contains(&value),
        }
    }

    fn parse(text: &str) -> Option<Self> {
        if text.is_empty() {
            return Some(Self::Any);
        }
        if let Some((least, greatest)) = text.split_once("..") {
            return Some(Self::Between(least.parse().ok()?, greatest.parse().ok()?));
        }
        text.split('|').map(|value| value.parse().ok()).collect::<Option<_>>().map(Self::OneOf)
    }
}

/// All rows of a model, and which of them an address belongs to.
#[derive(Debug, Clone)]
pub(crate) struct Table {
    rows: Vec<Row>,
    row_of_address: Vec<Option<usize>>,
}

impl Table {
    pub(crate) fn of(model: Model) -> Result<Self, Error> {
        let mut table = Self { rows: Vec::new(), row_of_address: vec![None; SIZE] };
        for file in [model.table(), INDIRECT] {
            for (i, line) in file.lines().enumerate().skip(1) {
                let wrong = |what| Error::Table { model: model.name(), row: i + 1, what };
                let row = parse(line).ok_or_else(|| wrong("it is no item"))?;
                let (first, size) = (usize::from(row.item.address), usize::from(row.item.size));
                let owners = table.row_of_address.get_mut(first..first + size);
                let owners = owners.ok_or_else(|| wrong("it lies outside of the table"))?;
                if owners.iter().any(Option::is_some) {
                    return Err(wrong("it overlaps another item"));
                }
                owners.fill(Some(table.rows.len()));
                table.rows.push(row);
            }
        }
        Ok(table)
    }

    pub(crate) fn rows(&self) -> &[Row] {
        &self.rows
    }

    /// The item that an address is part of.
    pub(crate) fn row_at(&self, address: usize) -> Option<&Row> {
        self.rows.get((*self.row_of_address.get(address)?)?)
    }
}

fn parse(line: &'static str) -> Option<Row> {
    let mut fields = line.split(',');
    let mut next = || fields.next();
    let item = Item { address: next()?.parse().ok()?, size: next()?.parse().ok()? };
    let name = next()?;
    let writable = match next()? {
        "RW" => true,
        "R" => false,
        _ => return None,
    };
    let (initial, range) = (next()?.parse().ok()?, Range::parse(next()?)?);
    next()?;
    (matches!(item.size, 1 | 2 | 4) && next().is_none()).then_some(Row { item, name, writable, initial, range })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::item::ALL;

    const MODELS: [Model; 3] = [Model::Xm540W270, Model::Xm430W350, Model::Xl430W250];

    /// Which items a servo without a current sensor has otherwise.
    fn lacks(model: Model, name: &str) -> bool {
        match name {
            "CURRENT_LIMIT" | "GOAL_CURRENT" | "PRESENT_CURRENT" => model == Model::Xl430W250,
            "PRESENT_LOAD" => model != Model::Xl430W250,
            _ => false,
        }
    }

    #[test]
    fn the_items_of_the_code_are_those_of_the_tables() {
        for model in MODELS {
            let table = Table::of(model).unwrap();
            for (name, item) in ALL {
                let named = |row: &&Row| row.name.to_uppercase().replace("(SHADOW)", "").replace(' ', "_") == *name;
                let found = table.rows().iter().find(named).map(|row| row.item);
                assert_eq!(found, (!lacks(model, name)).then_some(*item), "{name} of the {}", model.name());
            }
        }
    }

    #[test]
    fn initial_values_lie_in_their_ranges() {
        for model in MODELS {
            let table = Table::of(model).unwrap();
            for row in table.rows() {
                assert!(row.range.contains(row.initial), "{} of the {}", row.name, model.name());
            }
            assert_eq!(table.rows().len() - 112, [59, 53, 51][MODELS.iter().position(|m| *m == model).unwrap()]);
        }
    }

    #[test]
    fn a_row_that_says_something_else_is_refused() {
        for line in [
            "7,1,ID,RW,1,0..252",
            "7,3,ID,RW,1,,",
            "7,1,ID,W,1,,",
            "7,1,ID,RW,one,,",
            "7,1,ID,RW,1,0..x,",
            "7,1,ID,RW,1,,,",
        ] {
            assert_eq!(parse(line), None, "{line}");
        }
    }
}

//! The bytes of a control table, and the rules by which a master reads and writes them.

use crate::error::Error;
use crate::item::{self, Item};
use crate::model::Model;
use crate::packet::Refusal;
use crate::table::{RAM, Row, SIZE, Table};

/// The first indirect addresses and data, and how many there are in each of the two blocks.
const INDIRECT_BLOCKS: [(usize, usize, usize); 2] = [(168, 224, 28), (578, 634, 28)];

/// The control table of one servo with its values.
#[derive(Debug, Clone)]
pub(crate) struct Memory {
    table: Table,
    bytes: Vec<u8>,
}

/// A write that all rules allow: the bytes, and the items that they make up.
#[derive(Debug, Clone, Default)]
pub(crate) struct Allowed {
    bytes: Vec<(usize, u8)>,
    items: Vec<Item>,
}

impl Allowed {
    /// Whether this item is written.
    pub(crate) fn writes(&self, item: Item) -> bool {
        self.items.contains(&item)
    }

    /// Whether something of the EEPROM area is written.
    pub(crate) fn writes_eeprom(&self) -> bool {
        self.items.iter().any(|item| item.address < RAM)
    }
}

impl Memory {
    pub(crate) fn new(model: Model) -> Result<Self, Error> {
        let mut memory = Self { table: Table::of(model)?, bytes: vec![0; SIZE] };
        let initial: Vec<_> = memory.table.rows().iter().map(|row| (row.item, row.initial)).collect();
        initial.into_iter().for_each(|(item, value)| memory.set(item, value));
        Ok(memory)
    }

    /// The value of an item; bytes are unsigned, longer items two's complements.
    pub(crate) fn get(&self, item: Item) -> i32 {
        decode(&self.bytes[usize::from(item.address)..usize::from(item.address + item.size)])
    }

    /// Sets an item without any rule; what does not fit is cut off.
    pub(crate) fn set(&mut self, item: Item, value: i32) {
        let size = usize::from(item.size);
        self.bytes[usize::from(item.address)..][..size].copy_from_slice(&value.to_le_bytes()[..size]);
    }

    /// Sets an item before the servo is on a bus; read-only ones too.
    pub(crate) fn preset(&mut self, item: Item, value: i32) -> Result<(), Refusal> {
        let row = self.table.row_at(usize::from(item.address)).filter(|row| row.item == item).ok_or(Refusal::Access)?;
        if !row.range.contains(value) {
            return Err(Refusal::DataRange);
        }
        self.set(item, value);
        Ok(())
    }

    /// What the factory sets an item to; 0 where there is no such item.
    pub(crate) fn initial(&self, item: Item) -> i32 {
        self.table.row_at(usize::from(item.address)).map_or(0, |row| row.initial)
    }

    /// Puts the initial values of some items back, of those that a master can write.
    pub(crate) fn reset(&mut self, which: impl Fn(Item) -> bool) {
        let rows = self.table.rows().iter().filter(|row| row.writable && which(row.item));
        let initial: Vec<_> = rows.map(|row| (row.item, row.initial)).collect();
        initial.into_iter().for_each(|(item, value)| self.set(item, value));
    }

    /// All values, for a backup.
    pub(crate) fn copy(&self) -> Vec<u8> {
        self.bytes.clone()
    }

    /// Takes some items from a copy.
    pub(crate) fn restore(&mut self, copy: &[u8], which: impl Fn(Item) -> bool) {
        for row in self.table.rows().iter().filter(|row| which(row.item)) {
            let bytes = usize::from(row.item.address)..usize::from(row.item.address + row.item.size);
            self.bytes[bytes.clone()].copy_from_slice(&copy[bytes]);
        }
    }

    /// Reads as a master does. Gaps between items are zeros; what lies wholly in a gap or outside of the table is refused.
    pub(crate) fn read(&self, address: usize, length: usize) -> Result<Vec<u8>, Refusal> {
        let addresses = address..address.saturating_add(length);
        if length == 0 || addresses.end > SIZE || addresses.clone().all(|a| self.table.row_at(a).is_none()) {
            return Err(Refusal::Access);
        }
        Ok(addresses.map(|address| self.bytes[self.target(address)]).collect())
    }

    /// Checks a master's write as a whole: either all of its items are written, or nothing is.
    pub(crate) fn check(&self, address: usize, data: &[u8]) -> Result<Allowed, Refusal> {
        let bytes: Vec<_> = data.iter().enumerate().map(|(i, byte)| (self.target(address + i), *byte)).collect();
        let mut allowed = Allowed::default();
        for (address, _) in &bytes {
            let row = self.table.row_at(*address).ok_or(Refusal::Access)?;
            if !allowed.writes(row.item) {
                self.check_item(row, &bytes)?;
                allowed.items.push(row.item);
            }
        }
        if allowed.items.is_empty() {
            return Err(Refusal::DataLength);
        }
        allowed.bytes = bytes;
        Ok(allowed)
    }

    pub(crate) fn write(&mut self, allowed: &Allowed) {
        allowed.bytes.iter().for_each(|(address, byte)| self.bytes[*address] = *byte);
    }

    fn check_item(&self, row: &Row, bytes: &[(usize, u8)]) -> Result<(), Refusal> {
        let is_locked = row.item.address < RAM && self.get(item::TORQUE_ENABLE) == 1;
        if !row.writable || is_locked {
            return Err(Refusal::Access);
        }
        let of_address = |address| bytes.iter().rfind(|(to, _)| *to == address).map(|(_, byte)| *byte);
        let first = usize::from(row.item.address);
        let data: Option<Vec<u8>> = (first..first + usize::from(row.item.size)).map(of_address).collect();
        let value = decode(&data.ok_or(Refusal::DataLength)?);
        let is_stopped = self.get(item::BUS_WATCHDOG) == WATCHDOG_ERROR;
        // Assumed: nothing but the 0 of the e-manual takes the watchdog's error away.
        let is_kept = is_stopped && (self.is_goal(row.item) || (row.item == item::BUS_WATCHDOG && value != 0));
        if is_kept || !row.range.contains(value) {
            return Err(Refusal::DataRange);
        }
        if self.limits(row.item).is_some_and(|(least, greatest)| !(least..=greatest).contains(&value)) {
            return Err(Refusal::DataLimit);
        }
        Ok(())
    }

    fn is_goal(&self, item: Item) -> bool {
        [item::GOAL_PWM, item::GOAL_CURRENT, item::GOAL_VELOCITY, item::GOAL_POSITION].contains(&item)
    }

    /// The limits that other items set.
    fn limits(&self, item: Item) -> Option<(i32, i32)> {
        let symmetric = |limit| Some((-self.get(limit), self.get(limit)));
        match item {
            item::GOAL_PWM => symmetric(item::PWM_LIMIT),
            item::GOAL_CURRENT => symmetric(item::CURRENT_LIMIT),
            item::GOAL_VELOCITY => symmetric(item::VELOCITY_LIMIT),
            item::GOAL_POSITION if self.get(item::OPERATING_MODE) == POSITION_MODE => {
                Some((self.get(item::MIN_POSITION_LIMIT), self.get(item::MAX_POSITION_LIMIT)))
            }
            _ => None,
        }
    }

    /// Where the byte at an address is: indirect data is that of the indirect address, one step far.
    fn target(&self, address: usize) -> usize {
        for (addresses, data, count) in INDIRECT_BLOCKS {
            if let Some(n) = address.checked_sub(data).filter(|n| *n < count) {
                let entry = addresses + 2 * n;
                return usize::from(u16::from_le_bytes([self.bytes[entry], self.bytes[entry + 1]])).min(SIZE - 1);
            }
        }
        address
    }
}

/// What Bus Watchdog reads when it has stopped the servo: −1.
pub(crate) const WATCHDOG_ERROR: i32 = 0xFF;
/// Operating Mode of a joint within one turn.
pub(crate) const POSITION_MODE: i32 = 3;

fn decode(bytes: &[u8]) -> i32 {
    match *bytes {
        [a] => i32::from(a),
        [a, b] => i32::from(i16::from_le_bytes([a, b])),
        [a, b, c, d] => i32::from_le_bytes([a, b, c, d]),
        _ => 0,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn memory() -> Memory {
        Memory::new(Model::Xm540W270).unwrap()
    }

    fn refusal(memory: &Memory, address: usize, data: &[u8]) -> Option<Refusal> {
        memory.check(address, data).err()
    }

    #[test]
    fn every_rule_has_its_error() {
        let mut memory = memory();
        for (address, data, expected, why) in [
            (65, &[1][..], None, "LED"),
            (65, &[2], Some(Refusal::DataRange), "LED out of range"),
            (116, &[0, 8, 0, 0], None, "goal position"),
            (116, &[0, 8], Some(Refusal::DataLength), "half of a goal position"),
            (118, &[0, 8], Some(Refusal::DataLength), "the other half"),
            (116, &[], Some(Refusal::DataLength), "nothing"),
            (116, &[0, 16, 0, 0], Some(Refusal::DataLimit), "4096 beyond the greatest position"),
            (116, &[0xFF, 0xFF, 0xFF, 0xFF], Some(Refusal::DataLimit), "−1 below the least position"),
            (104, &[129, 0, 0, 0], Some(Refusal::DataLimit), "129 beyond the velocity limit of 128"),
            (104, &[0x80, 0xFF, 0xFF, 0xFF], None, "−128"),
            (132, &[0; 4], Some(Refusal::Access), "read-only"),
            (66, &[0], Some(Refusal::Access), "a gap"),
            (661, &[0, 0], Some(Refusal::Access), "beyond the table"),
            (11, &[2], Some(Refusal::DataRange), "no such operating mode"),
            (64, &[1, 1], None, "torque and LED at once"),
        ] {
            assert_eq!(refusal(&memory, address, data), expected, "{why}");
        }
        memory.set(item::TORQUE_ENABLE, 1);
        assert_eq!(refusal(&memory, 9, &[0]), Some(Refusal::Access), "EEPROM is locked by torque");
        assert_eq!(refusal(&memory, 65, &[1]), None, "RAM is not");
        memory.set(item::BUS_WATCHDOG, WATCHDOG_ERROR);
        assert_eq!(refusal(&memory, 104, &[0; 4]), Some(Refusal::DataRange), "goals are locked by the watchdog");
    }

    #[test]
    fn reads_span_gaps_but_not_the_end() {
        let memory = memory();
        assert_eq!(memory.read(0, 2), Ok(vec![0x60, 0x04]));
        assert_eq!(memory.read(12, 9), Ok(vec![255, 2, 0, 0, 0, 0, 0, 0, 0]));
        for (address, length) in [(14, 2), (252, 10), (660, 3), (662, 1), (0, 0), (65535, 65535)] {
            assert_eq!(memory.read(address, length), Err(Refusal::Access), "{address}, {length}");
        }
    }

    #[test]
    fn indirect_data_is_what_its_address_says() {
        let mut memory = memory();
        for (n, target) in [65u8, 116, 117, 118, 119].into_iter().enumerate() {
            let allowed = memory.check(168 + 2 * n, &[target, 0]).unwrap();
            memory.write(&allowed);
        }
        let allowed = memory.check(224, &[1, 0xE8, 0x03, 0, 0]).unwrap();
        assert!(allowed.writes(item::LED) && allowed.writes(item::GOAL_POSITION) && !allowed.writes_eeprom());
        memory.write(&allowed);
        assert_eq!((memory.get(item::LED), memory.get(item::GOAL_POSITION)), (1, 1000));
        assert_eq!(memory.read(224, 5), Ok(vec![1, 0xE8, 0x03, 0, 0]));
        assert_eq!(refusal(&memory, 224, &[2]), Some(Refusal::DataRange), "rules are those of the target");
        assert_eq!(refusal(&memory, 225, &[0]), Some(Refusal::DataLength), "a quarter of the target");
        assert_eq!(refusal(&memory, 168, &[63, 0]), Some(Refusal::DataRange), "no EEPROM behind indirect data");
    }
}

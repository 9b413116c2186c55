use super::{BROADCAST_ID, HEADER, MAX_ID, Packet, crc16, unstuff};

/// Instruction and CRC: a packet without parameters.
const MIN_LENGTH: usize = 3;
/// Greater lengths are taken for noise, lest a flipped bit make a servo deaf for 65 kB. The SDK sends at most 1 kB.
const MAX_LENGTH: usize = 1024;
/// Header, ID and length.
const PREFIX: usize = 7;

/// What a parser has found in the bytes.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Heard {
    /// A whole packet.
    Packet(Packet),
    /// A whole packet but for its CRC; the ID may be what is wrong with it.
    WrongCrc {
        /// The ID as it was heard.
        id: u8,
    },
}

/// Finds packets in a stream of bytes that comes in any portions and may hold noise, fragments and lengths that lie.
///
/// After a wrong CRC the search goes on behind the header of the broken packet, not behind the length that it claims, so that a
/// truncated packet does not take the next one with it.
#[derive(Debug, Clone, Default)]
pub struct Parser {
    pending: Vec<u8>,
}

impl Parser {
    /// Takes bytes in.
    pub fn push(&mut self, bytes: &[u8]) {
        self.pending.extend_from_slice(bytes);
    }

    /// Forgets a packet that has begun, as a servo does after a pause in it.
    pub fn reset(&mut self) {
        self.pending.clear();
    }

    /// Whether a packet has begun and is not complete.
    #[must_use]
    pub fn is_amid(&self) -> bool {
        !self.pending.is_empty()
    }

    /// The next packet, if one is complete.
    pub fn next_heard(&mut self) -> Option<Heard> {
        loop {
            self.seek_header();
            let prefix = self.pending.get(..PREFIX)?;
            let (id, length) = (prefix[4], usize::from(u16::from_le_bytes([prefix[5], prefix[6]])));
            if !(id <= MAX_ID || id == BROADCAST_ID) || !(MIN_LENGTH..=MAX_LENGTH).contains(&length) {
                self.pending.drain(..HEADER.len());
                continue;
            }
            let packet = self.pending.get(..PREFIX + length)?;
            let (checked, crc) = packet.split_at(packet.len() - 2);
            if crc16(0, checked).to_le_bytes() != crc {
                self.pending.drain(..HEADER.len());
                return Some(Heard::WrongCrc { id });
            }
            let body = unstuff(&checked[PREFIX..]);
            self.pending.drain(..PREFIX + length);
            if let Some((instruction, parameters)) = body.split_first() {
                return Some(Heard::Packet(Packet { id, instruction: *instruction, parameters: parameters.to_vec() }));
            }
        }
    }

    /// Drops what comes before a header, or before what may become one.
    fn seek_header(&mut self) {
        let starts = |rest: &[u8]| rest.iter().zip(HEADER).all(|(byte, expected)| *byte == expected);
        let noise = (0..self.pending.len()).find(|i| starts(&self.pending[*i..])).unwrap_or(self.pending.len());
        self.pending.drain(..noise);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn packet(parameters: &[u8]) -> Packet {
        Packet { id: 5, instruction: 3, parameters: parameters.to_vec() }
    }

    fn all(parser: &mut Parser) -> Vec<Heard> {
        std::iter::from_fn(|| parser.next_heard()).collect()
    }

    #[test]
    fn packets_are_found_byte_by_byte_amid_noise() {
        let wanted = [packet(&[0xFF, 0xFF, 0xFD]), packet(&[0xFF, 0xFF, 0xFD, 0xFD, 0x00]), packet(&[])];
        let mut parser = Parser::default();
        let mut heard = Vec::new();
        for packet in &wanted {
            for byte in [0xFF, 0xFF, 0x00, 0xFF].iter().chain(&packet.encode()) {
                parser.push(&[*byte]);
                heard.extend(all(&mut parser));
            }
        }
        assert_eq!(heard, wanted.map(Heard::Packet));
        assert!(!parser.is_amid());
    }

    #[test]
    fn neither_a_truncated_packet_nor_a_length_that_lies_takes_the_next_packet_with_it() {
        let good = packet(&[1, 2, 3, 4]).encode();
        let broken = packet(&[9; 12]).encode();
        for (case, fragment) in [
            ("truncated", broken[..12].to_vec()),
            ("greatest length", [&broken[..5], &[0xFF, 0xFF]].concat()),
            ("no length", [&broken[..5], &[0x00, 0x00]].concat()),
            ("reserved ID", [&HEADER[..], &[0xFD, 0x03, 0x00]].concat()),
        ] {
            let mut parser = Parser::default();
            parser.push(&fragment);
            parser.push(&good);
            let heard = all(&mut parser);
            assert!(heard.contains(&Heard::Packet(packet(&[1, 2, 3, 4]))), "{case}: {heard:?}");
        }
    }

    #[test]
    fn a_flipped_bit_is_never_taken_for_the_packet() {
        let good = packet(&[1, 2, 3, 4]).encode();
        for bit in 0..good.len() * 8 {
            let mut flipped = good.clone();
            flipped[bit / 8] ^= 1 << (bit % 8);
            let mut parser = Parser::default();
            parser.push(&flipped);
            let heard = all(&mut parser);
            assert!(heard.iter().all(|heard| matches!(heard, Heard::WrongCrc { .. })), "bit {bit}: {heard:?}");
        }
    }
}

//! Any bytes and any packets on a bus of servos, with pauses between: no panic, shafts that stay finite, answers that are packets.
#![no_main]

use dynamixel_emulator::packet::{BROADCAST_ID, HEADER, Heard, Packet, Parser, crc16};
use dynamixel_emulator::units::BAUD_RATES;
use dynamixel_emulator::{Bus, FreeShafts, Model, ServoSettings};
use libfuzzer_sys::fuzz_target;

const MODELS: [Model; 3] = [Model::Xm540W270, Model::Xm430W350, Model::Xl430W250];

/// An answer of one servo, or the one packet of a fast read, which is not stuffed.
fn is_packet(bytes: &[u8]) -> bool {
    if bytes.starts_with(&HEADER) && bytes[4] == BROADCAST_ID {
        let (checked, crc) = bytes.split_at(bytes.len() - 2);
        return crc16(0, checked).to_le_bytes() == crc;
    }
    let mut parser = Parser::default();
    parser.push(bytes);
    matches!(parser.next_heard(), Some(Heard::Packet(_))) && !parser.is_amid()
}

fuzz_target!(|bytes: &[u8]| {
    let servos = [1, 2, 3].into_iter().zip(MODELS).map(|(id, model)| ServoSettings::new(id, model)).collect();
    let mut bus = Bus::new(servos, Box::new(FreeShafts::new(&MODELS))).expect("a bus");
    let mut rest = bytes;
    while let [what, count, tail @ ..] = rest {
        // Long enough for two reboots; more only takes longer.
        if bus.now_s() > 1.0 {
            break;
        }
        let count = usize::from(*count);
        rest = tail;
        // A rate and a pause need no data.
        if *what >= 0xF0 {
            bus.set_host_baud(BAUD_RATES.get(count).copied().unwrap_or(count as u32));
            continue;
        }
        if what % 4 == 1 {
            bus.advance(count as f64 * 1e-3);
            continue;
        }
        let (data, tail) = tail.split_at(count.min(tail.len()));
        rest = tail;
        let answers = match what % 4 {
            0 => bus.receive(data),
            _ => {
                let [id, instruction, parameters @ ..] = data else { continue };
                // Most packets are for servos that there are.
                let id = if *id < 0xF0 { id % 4 } else { BROADCAST_ID };
                bus.receive(&Packet { id, instruction: *instruction, parameters: parameters.to_vec() }.encode())
            }
        };
        // Servos whose IDs have been made the same garble one another.
        let ids = [0, 1, 2].map(|i| bus.servos()[i].id());
        let differ = ids[0] != ids[1] && ids[1] != ids[2] && ids[0] != ids[2];
        assert!(!differ || answers.iter().all(|answer| is_packet(&answer.bytes)), "{answers:?}");
    }
    for i in 0..MODELS.len() {
        let shaft = bus.plant().shaft(i);
        assert!(shaft.position_rad.is_finite() && shaft.velocity_rad_s.is_finite(), "{shaft:?}");
    }
});

//! The bus as a wire: times, names, collisions, and what becomes of hurt packets.
#![allow(clippy::unwrap_used, missing_docs)]

mod bench;

use bench::{Bench, heard, write};
use dynamixel_emulator::packet::{BROADCAST_ID, Heard, Packet, instruction};
use dynamixel_emulator::{Bus, Connection, Error, FreeShafts, Model, Rates, ServoSettings, item};

const PING: u8 = instruction::PING;

fn ping(id: u8) -> Vec<u8> {
    Packet { id, instruction: PING, parameters: vec![] }.encode()
}

fn is_whole(answers: &[Heard]) -> bool {
    matches!(answers, [Heard::Packet(_)])
}

#[test]
fn an_answer_takes_its_bytes_and_the_return_delay() {
    let shafts = FreeShafts::new(&[Model::Xm540W270; 2]);
    let servos = [1, 2].map(|id| ServoSettings::new(id, Model::Xm540W270)).to_vec();
    let mut bus = Bus::new(servos, Box::new(shafts)).unwrap();
    // Ten bits a byte at 57,600 baud, and 500 µs of the factory's return delay before every answer.
    let (byte_s, delay_s) = (10.0 / 57_600.0, 500e-6);
    let answers = bus.receive(&ping(BROADCAST_ID));
    let expected = [1.0, 2.0].map(|n| 10.0 * byte_s + n * (delay_s + 14.0 * byte_s));
    for (answer, expected) in answers.iter().zip(expected) {
        assert!((answer.at_s - expected).abs() < 1e-12, "{} instead of {expected}", answer.at_s);
    }
    assert!((bus.now_s() - 10.0 * byte_s).abs() < 1e-12, "servos know what they were told when they have heard it");
    let answers = bus.receive(&ping(2));
    let expected = expected[1] + 10.0 * byte_s + delay_s + 14.0 * byte_s;
    assert!((answers[0].at_s - expected).abs() < 1e-12, "the wire was busy until the last answer was over");
}

#[test]
fn a_host_that_does_not_wait_for_the_answer_is_found_out() {
    let mut bench = Bench::with_ids(&[1]);
    let talked_over = |bench: &Bench| bench.0.faults().talked_over;
    bench.0.receive(&ping(9));
    let ends_s = bench.0.receive(&ping(1))[0].at_s;
    assert_eq!(talked_over(&bench), 0, "nobody answers the first");
    bench.0.advance(ends_s - bench.0.now_s());
    let ends_s = bench.0.receive(&ping(1))[0].at_s;
    assert_eq!(talked_over(&bench), 0, "the answer is over");
    bench.0.advance((ends_s - bench.0.now_s()) / 2.0);
    assert!(is_whole(&bench.send(1, PING, &[])), "it waits");
    assert_eq!(talked_over(&bench), 1);
}

#[test]
fn a_servo_at_another_rate_is_silent() {
    let servo = ServoSettings::new(2, Model::Xl430W250).with(item::BAUD_RATE, 3);
    let mut bench = Bench::new(vec![ServoSettings::new(1, Model::Xl430W250), servo]);
    assert_eq!(bench.scan(), [1]);
    bench.0.set_host_baud(1_000_000);
    assert_eq!(bench.scan(), [2]);
    // The answer to a new rate still comes at the old one.
    bench.write(2, item::BAUD_RATE, 1);
    assert_eq!(bench.scan(), [0u8; 0]);
    bench.0.set_host_baud(57_600);
    assert_eq!(bench.scan(), [1, 2]);
}

#[test]
fn a_host_that_is_slower_than_any_servo_is_not_waited_for() {
    let mut bench = Bench::with_ids(&[1]);
    for baud in [0, 50, 9599] {
        bench.0.set_host_baud(baud);
        assert_eq!((bench.0.receive(&ping(1)), bench.0.now_s()), (vec![], 0.0), "{baud} baud");
    }
}

#[test]
fn the_host_hears_itself_through_an_adapter_that_echoes() {
    let mut bench = Bench::with_ids(&[1]);
    bench.0.set_echo(true);
    let answers = bench.0.receive(&ping(1));
    assert_eq!((answers.len(), &answers[0].bytes), (2, &ping(1)));
}

/// The example of the e-manual's Secondary ID(12).
#[test]
fn a_secondary_id_is_obeyed_in_silence() {
    let mut bench = Bench::with_ids(&[1, 2, 3, 4, 5]);
    let leds = |bench: &Bench| [1, 2, 3, 4, 5].map(|id| bench.item(id, item::LED));
    (1..=5).for_each(|id| bench.write(id, item::SECONDARY_ID, 5));
    bench.write(1, item::LED, 1);
    assert_eq!(leds(&bench), [1, 0, 0, 0, 0]);
    bench.write(5, item::LED, 1);
    assert_eq!(leds(&bench), [1; 5]);
    (1..=5).for_each(|id| bench.write(id, item::SECONDARY_ID, 100));
    assert_eq!(bench.send(100, instruction::WRITE, &write(item::LED, 0)), []);
    assert_eq!(leds(&bench), [0; 5]);
    assert_eq!(bench.send(100, instruction::WRITE, &write(item::HOMING_OFFSET, 9)), []);
    assert_eq!(bench.item(1, item::HOMING_OFFSET), 0, "the EEPROM is not written by that name");
}

#[test]
fn nothing_that_is_kept_without_power_changes_by_a_secondary_id() {
    let mut bench = Bench::with_ids(&[1]);
    bench.write(1, item::SECONDARY_ID, 100);
    bench.write(1, item::HOMING_OFFSET, 5);
    assert_eq!(bench.ask(1, instruction::CONTROL_TABLE_BACKUP, &[0x01, 0x43, 0x54, 0x52, 0x4C]), [0]);
    bench.write(1, item::HOMING_OFFSET, 7);
    bench.send(100, instruction::FACTORY_RESET, &[0x02]);
    bench.send(100, instruction::CONTROL_TABLE_BACKUP, &[0x02, 0x43, 0x54, 0x52, 0x4C]);
    bench.send(100, instruction::REG_WRITE, &write(item::HOMING_OFFSET, 9));
    assert_eq!(bench.item(1, item::REGISTERED_INSTRUCTION), 0);
    bench.send(1, instruction::ACTION, &[]);
    bench.0.advance(0.5);
    assert_eq!((bench.item(1, item::HOMING_OFFSET), bench.item(1, item::SECONDARY_ID)), (7, 100));
}

/// The factory's Secondary ID(12) is 255, which is nobody's.
#[test]
fn an_id_that_no_servo_can_have_is_not_obeyed() {
    let mut bench = Bench::with_ids(&[1]);
    for id in [253, 254, 255] {
        bench.write(1, item::SECONDARY_ID, i32::from(id));
        bench.send(BROADCAST_ID, instruction::SYNC_WRITE, &[65, 0, 1, 0, id, 1]);
        bench.send(BROADCAST_ID, instruction::BULK_WRITE, &[id, 65, 0, 1, 0, 1]);
        assert_eq!(bench.item(1, item::LED), 0, "{id}");
    }
    bench.send(BROADCAST_ID, instruction::SYNC_WRITE, &[65, 0, 1, 0, 1, 1]);
    assert_eq!(bench.item(1, item::LED), 1);
}

#[test]
fn the_status_return_level_is_kept() {
    let mut bench = Bench::with_ids(&[1]);
    let answers = |bench: &mut Bench| {
        let ping = bench.send(1, PING, &[]).len();
        let read = bench.send(1, instruction::READ, &[0, 0, 2, 0]).len();
        (ping, read, bench.send(1, instruction::WRITE, &write(item::LED, 0)).len())
    };
    for (level, expected) in [(2, (1, 1, 1)), (1, (1, 1, 0)), (0, (1, 0, 0))] {
        bench.send(1, instruction::WRITE, &write(item::STATUS_RETURN_LEVEL, level));
        assert_eq!(answers(&mut bench), expected, "level {level}");
    }
}

#[test]
fn two_servos_with_one_id_garble_each_other() {
    let mut bench = Bench::with_ids(&[1, 2]);
    bench.0.faults_mut().servos[1].id = Some(1);
    for _ in 0..100 {
        assert!(!is_whole(&bench.send(1, PING, &[])));
    }
    assert_eq!(bench.send(2, PING, &[]), []);
    bench.0.faults_mut().servos[1].id = None;
    assert_eq!(bench.scan(), [1, 2]);
}

#[test]
fn two_servos_with_one_id_garble_a_fast_read() {
    for (ids, longest) in [([1, 2], 16), ([2, 1], 24)] {
        let mut bench = Bench::with_ids(&[1, 2, 3]);
        bench.0.faults_mut().servos[2].id = Some(1);
        for instruction in [instruction::FAST_SYNC_READ, instruction::FAST_BULK_READ] {
            let parameters = match instruction {
                instruction::FAST_SYNC_READ => [&[132, 0, 4, 0][..], &ids].concat(),
                _ => ids.iter().flat_map(|id| [*id, 132, 0, 4, 0]).collect(),
            };
            let packet = Packet { id: BROADCAST_ID, instruction, parameters };
            for _ in 0..100 {
                let answers = bench.0.receive(&packet.encode());
                assert!(!answers.is_empty() && !is_whole(&heard(&answers)), "{ids:?}: {answers:?}");
                assert!(answers[0].bytes.len() <= longest, "{ids:?}: nobody goes on behind a collision");
            }
        }
    }
}

#[test]
fn a_bus_does_not_start_with_ids_that_are_none() {
    let bus = |ids: &[u8]| {
        let servos = ids.iter().map(|id| ServoSettings::new(*id, Model::Xl430W250)).collect();
        Bus::new(servos, Box::new(FreeShafts::new(&[Model::Xl430W250; 2]))).err()
    };
    assert!(matches!(bus(&[1, 1]), Some(Error::Id { index: 1, id: 1, .. })));
    assert!(matches!(bus(&[1, 253]), Some(Error::Id { index: 1, id: 253, .. })));
    assert!(bus(&[0, 252]).is_none());
}

#[test]
fn a_pause_in_a_packet_ends_it() {
    for (pause_s, answered) in [(1.4e-3, true), (1.6e-3, false)] {
        let mut bench = Bench::with_ids(&[1]);
        let packet = ping(1);
        assert_eq!(bench.0.receive(&packet[..6]), []);
        bench.0.advance(pause_s);
        assert_eq!(bench.0.receive(&packet[6..]).len(), usize::from(answered), "after {pause_s} s");
        assert!(is_whole(&bench.send(1, PING, &[])), "the next packet is heard");
    }
}

#[test]
fn a_wrong_crc_and_an_unknown_instruction_are_told() {
    let mut bench = Bench::with_ids(&[1]);
    let mut packet = ping(1);
    *packet.last_mut().unwrap() ^= 1;
    let answers = heard(&bench.0.receive(&packet));
    assert!(matches!(&answers[..], [Heard::Packet(status)] if status.parameters == [3]), "{answers:?}");
    assert_eq!(bench.ask(1, 0x77, &[]), [2]);
    assert_eq!(bench.send(1, instruction::STATUS, &[0]), [], "answers of others are not for servos");
}

#[test]
fn behind_a_missing_servo_all_are_silent() {
    let mut bench = Bench::with_ids(&[1, 2, 3]);
    let positions = [132, 0, 4, 0, 1, 2, 3];
    assert_eq!(bench.send(BROADCAST_ID, instruction::SYNC_READ, &positions).len(), 3);
    for connection in [Connection::NoData, Connection::Unplugged] {
        bench.0.faults_mut().servos[1].connection = connection;
        assert_eq!(bench.send(BROADCAST_ID, instruction::SYNC_READ, &positions).len(), 1);
        assert_eq!(bench.send(BROADCAST_ID, instruction::FAST_SYNC_READ, &positions), [], "a packet that breaks off");
        assert_eq!(bench.scan(), [1, 3]);
    }
}

#[test]
fn a_servo_that_loses_data_holds_and_one_that_loses_power_starts_afresh() {
    let mut bench = Bench::with_ids(&[1]);
    bench.write(1, item::TORQUE_ENABLE, 1);
    bench.0.faults_mut().servos[0].connection = Connection::NoData;
    bench.0.advance(0.1);
    bench.0.faults_mut().servos[0].connection = Connection::Whole;
    assert_eq!(bench.ask(1, instruction::READ, &[64, 0, 1, 0]), [0, 1]);
    bench.0.faults_mut().servos[0].connection = Connection::Unplugged;
    bench.0.advance(0.1);
    bench.0.faults_mut().servos[0].connection = Connection::Whole;
    assert_eq!(bench.send(1, PING, &[]), [], "it boots");
    bench.0.advance(0.5);
    assert_eq!(bench.ask(1, instruction::READ, &[64, 0, 1, 0]), [0, 0]);
}

#[test]
fn packets_are_hurt_as_often_as_was_asked_and_the_same_way_again() {
    let run = |seed| {
        let mut bench = Bench::with_ids(&[1]);
        bench.0.faults_mut().seed(seed);
        bench.0.faults_mut().to_host = Rates { delayed: 0.05, delay_s: 0.02, ..Rates::all(0.05) };
        let answers: Vec<_> = (0..4000).map(|_| bench.0.receive(&ping(1))).collect();
        (answers, bench.0.faults().hurt)
    };
    let (answers, hurt) = run(7);
    let whole = answers.iter().filter(|answers| is_whole(&heard(answers))).count();
    // A packet passes when none of three chances of 5 % hits it: 0.857, ± four standard deviations of 4000 draws.
    assert!((whole as f64 / 4000.0 - 0.95f64.powi(3)).abs() < 4.0 * 0.0055, "{whole} of 4000 are whole");
    let late = answers.iter().flatten().count();
    assert!(late < 4000, "some are lost");
    assert!((hurt as f64 / 4000.0 - (1.0 - 0.95f64.powi(4))).abs() < 4.0 * 0.0062, "{hurt} of 4000 are hurt");
    assert_eq!(run(7), (answers.clone(), hurt));
    assert_ne!(run(8).0, answers);
}

#[test]
fn hurt_instructions_do_nothing_wrong() {
    let mut bench = Bench::with_ids(&[1, 2]);
    bench.0.faults_mut().to_servos = Rates::all(0.2);
    let mut unanswered = 0;
    for i in 0..4000 {
        // A pause, as a host makes that waits for an answer; else a length that lies makes the servo wait for the next packet.
        bench.0.advance(2e-3);
        let before = bench.item(1, item::GOAL_POSITION);
        let answers = bench.send(1, instruction::WRITE, &write(item::GOAL_POSITION, i));
        let now = bench.item(1, item::GOAL_POSITION);
        assert!(now == before || now == i, "{now}, which nobody has written");
        unanswered += usize::from(answers.is_empty());
    }
    assert!((1000..2500).contains(&unanswered), "{unanswered}");
    assert_eq!(bench.item(2, item::GOAL_POSITION), 2048);
}

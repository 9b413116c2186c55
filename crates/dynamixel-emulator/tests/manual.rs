//! Every example of ROBOTIS's [manual of Protocol 2.0](https://emanual.robotis.com/docs/en/dxl/protocol2/), byte for byte: the bus is
//! set up as the example assumes, gets its instruction packet, and must answer with its status packets.
#![allow(clippy::unwrap_used, missing_docs)]

use dynamixel_emulator::packet::{Heard, Packet, Parser, instruction};
use dynamixel_emulator::units::{CENTRE, PULSE_RAD};
use dynamixel_emulator::{Bus, FreeShafts, Item, Model, ServoSettings, item};

/// The manual's servos are XM430-W210 and XC330-T288. Of the former only the model number shows, of the latter nothing does.
const XM430_W210: u16 = 1030;

struct Example {
    name: &'static str,
    servos: &'static [Servo],
    /// Packets before that of the example, whose answers the manual does not give.
    before: &'static [&'static str],
    instruction: &'static str,
    status: &'static str,
}

/// A servo as an example assumes it.
#[derive(Clone, Copy)]
struct Servo {
    id: u8,
    firmware: i32,
    position: i32,
    pwm: Option<i32>,
    temperature_c: f64,
}

const fn servo(id: u8) -> Servo {
    Servo { id, firmware: 46, position: CENTRE, pwm: None, temperature_c: 25.0 }
}

const fn at(id: u8, position: i32) -> Servo {
    Servo { position, ..servo(id) }
}

const fn old(id: u8) -> Servo {
    Servo { firmware: 38, ..servo(id) }
}

/// The supply in the example of Bulk Read: a present voltage of 119.
const SUPPLY_V: f64 = 11.9;
const ACCEPTED: &str = "FF FF FD 00 01 04 00 55 00 A1 0C";

const EXAMPLES: &[Example] = &[
    Example {
        name: "ping, example 1",
        servos: &[old(1)],
        before: &[],
        instruction: "FF FF FD 00 01 03 00 01 19 4E",
        status: "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D",
    },
    Example {
        name: "ping, example 2",
        servos: &[old(1), old(2)],
        before: &[],
        instruction: "FF FF FD 00 FE 03 00 01 31 42",
        status: "FF FF FD 00 01 07 00 55 00 06 04 26 65 5D  FF FF FD 00 02 07 00 55 00 06 04 26 6F 6D",
    },
    Example {
        name: "read",
        servos: &[at(1, 166)],
        before: &[],
        instruction: "FF FF FD 00 01 07 00 02 84 00 04 00 1D 15",
        status: "FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0",
    },
    Example {
        name: "write",
        servos: &[servo(1)],
        before: &[],
        instruction: "FF FF FD 00 01 09 00 03 74 00 00 02 00 00 CA 89",
        status: ACCEPTED,
    },
    Example {
        name: "reg write",
        servos: &[servo(1)],
        before: &[],
        instruction: "FF FF FD 00 01 09 00 04 68 00 C8 00 00 00 AE 8E",
        status: ACCEPTED,
    },
    Example {
        name: "action",
        servos: &[servo(1)],
        before: &["FF FF FD 00 01 09 00 04 68 00 C8 00 00 00 AE 8E"],
        instruction: "FF FF FD 00 01 03 00 05 02 CE",
        status: ACCEPTED,
    },
    Example {
        name: "factory reset",
        servos: &[servo(1)],
        before: &[],
        instruction: "FF FF FD 00 01 04 00 06 01 A1 E6",
        status: ACCEPTED,
    },
    Example {
        name: "reboot",
        servos: &[servo(1)],
        before: &[],
        instruction: "FF FF FD 00 01 03 00 08 2F 4E",
        status: ACCEPTED,
    },
    Example {
        name: "clear",
        servos: &[servo(1)],
        before: &[],
        instruction: "FF FF FD 00 01 08 00 10 01 44 58 4C 22 B1 DC",
        status: ACCEPTED,
    },
    Example {
        name: "control table backup, example 1",
        servos: &[servo(1)],
        before: &[],
        instruction: "FF FF FD 00 01 08 00 20 01 43 54 52 4C 16 F5",
        status: ACCEPTED,
    },
    // The manual ends this one with 92 F5; the CRC of the bytes is 9E F5.
    Example {
        name: "control table backup, example 2",
        servos: &[servo(1)],
        before: &["FF FF FD 00 01 08 00 20 01 43 54 52 4C 16 F5"],
        instruction: "FF FF FD 00 01 08 00 20 02 43 54 52 4C 9E F5",
        status: ACCEPTED,
    },
    Example {
        name: "sync read",
        servos: &[at(1, 166), at(2, 2079)],
        before: &[],
        instruction: "FF FF FD 00 FE 09 00 82 84 00 04 00 01 02 CE FA",
        status: "FF FF FD 00 01 08 00 55 00 A6 00 00 00 8C C0  FF FF FD 00 02 08 00 55 00 1F 08 00 00 BA BE",
    },
    Example {
        name: "sync write",
        servos: &[servo(1), servo(2)],
        before: &[],
        instruction: "FF FF FD 00 FE 11 00 83 74 00 04 00 01 96 00 00 00 02 AA 00 00 00 82 87",
        status: "",
    },
    Example {
        name: "fast sync read",
        servos: &[at(3, 166), at(7, 2079), at(4, 1023)],
        before: &[],
        instruction: "FF FF FD 00 FE 0A 00 8A 84 00 04 00 03 07 04 20 F2",
        status: "FF FF FD 00 FE 19 00 55 00 03 A6 00 00 00 84 08  00 07 1F 08 00 00 16 CA  00 04 FF 03 00 00 D1 9E",
    },
    Example {
        name: "bulk read",
        servos: &[servo(1), Servo { temperature_c: 36.0, ..servo(2) }],
        before: &[],
        instruction: "FF FF FD 00 FE 0D 00 92 01 90 00 02 00 02 92 00 01 00 1A 05",
        status: "FF FF FD 00 01 06 00 55 00 77 00 C3 69  FF FF FD 00 02 05 00 55 00 24 8B A9",
    },
    Example {
        name: "bulk write",
        servos: &[servo(1), servo(2)],
        before: &[],
        instruction: "FF FF FD 00 FE 10 00 93 01 20 00 02 00 A0 00 02 1F 00 01 00 50 B7 68",
        status: "",
    },
    // The manual gives this instruction the CRC of its fast sync read, 20 F2; that of the bytes is DA 2D.
    Example {
        name: "fast bulk read",
        servos: &[at(3, 166), Servo { pwm: Some(421), ..servo(7) }, Servo { temperature_c: 31.0, ..servo(4) }],
        before: &[],
        instruction: "FF FF FD 00 FE 12 00 9A 03 84 00 04 00 07 7C 00 02 00 04 92 00 01 00 DA 2D",
        status: "FF FF FD 00 FE 14 00 55 00 03 A6 00 00 00 67 A4  00 07 A5 01 24 74  00 04 1F D9 C1",
    },
];

fn bytes(text: &str) -> Vec<u8> {
    text.split_whitespace().map(|byte| u8::from_str_radix(byte, 16).unwrap()).collect()
}

fn write(id: u8, item: Item, value: i32) -> Packet {
    let data = &value.to_le_bytes()[..usize::from(item.size)];
    let parameters = [&item.address.to_le_bytes()[..], data].concat();
    Packet { id, instruction: instruction::WRITE, parameters }
}

fn bus(servos: &[Servo]) -> Bus {
    let model = Model::Xm430W350;
    let mut shafts = FreeShafts::new(&vec![model; servos.len()]);
    let mut settings = Vec::new();
    for (i, servo) in servos.iter().enumerate() {
        shafts = shafts.turned(i, f64::from(servo.position - CENTRE) * PULSE_RAD);
        let mode = if servo.pwm.is_some() { 16 } else { 3 };
        let sold = ServoSettings::new(servo.id, model).with(item::FIRMWARE_VERSION, servo.firmware);
        // Other limits than what the example of bulk write sets.
        let limited = sold.with(item::MAX_VOLTAGE_LIMIT, 150).with(item::TEMPERATURE_LIMIT, 70);
        settings.push(limited.with(item::OPERATING_MODE, mode));
    }
    let mut bus = Bus::new(settings, Box::new(shafts)).unwrap();
    bus.faults_mut().supply_v = SUPPLY_V;
    for (i, servo) in servos.iter().enumerate() {
        bus.faults_mut().servos[i].temperature_c = Some(servo.temperature_c);
        bus.faults_mut().servos[i].model_number = Some(XM430_W210);
        if let Some(pwm) = servo.pwm {
            bus.receive(&write(servo.id, item::TORQUE_ENABLE, 1).encode());
            bus.receive(&write(servo.id, item::GOAL_PWM, pwm).encode());
        }
    }
    bus.advance(0.01);
    bus
}

#[test]
fn every_example_of_the_manual_is_answered_byte_for_byte() {
    for Example { name, servos, before, instruction, status } in EXAMPLES {
        let mut bus = bus(servos);
        for packet in *before {
            bus.receive(&bytes(packet));
        }
        let answers: Vec<_> = bus.receive(&bytes(instruction)).into_iter().flat_map(|answer| answer.bytes).collect();
        assert_eq!(answers, bytes(status), "{name}");
    }
}

#[test]
fn our_packets_are_those_of_the_manual() {
    for Example { name, instruction, .. } in EXAMPLES {
        let mut parser = Parser::default();
        parser.push(&bytes(instruction));
        let Some(Heard::Packet(packet)) = parser.next_heard() else { panic!("{name} is no packet") };
        assert_eq!(packet.encode(), bytes(instruction), "{name}");
    }
}

#[test]
fn what_the_examples_write_is_written() {
    let written = |name: &str| {
        let example = EXAMPLES.iter().find(|example| example.name == name).unwrap();
        let mut bus = bus(example.servos);
        example.before.iter().for_each(|packet| drop(bus.receive(&bytes(packet))));
        bus.receive(&bytes(example.instruction));
        bus
    };
    let item = |bus: &Bus, id, item| bus.servo(id).unwrap().item(item);
    assert_eq!(item(&written("write"), 1, item::GOAL_POSITION), 512);
    assert_eq!(item(&written("reg write"), 1, item::GOAL_VELOCITY), 0);
    assert_eq!(item(&written("reg write"), 1, item::REGISTERED_INSTRUCTION), 1);
    assert_eq!(item(&written("action"), 1, item::GOAL_VELOCITY), 200);
    assert_eq!(item(&written("action"), 1, item::REGISTERED_INSTRUCTION), 0);
    let both = written("sync write");
    assert_eq!((item(&both, 1, item::GOAL_POSITION), item(&both, 2, item::GOAL_POSITION)), (150, 170));
    let both = written("bulk write");
    assert_eq!((item(&both, 1, item::MAX_VOLTAGE_LIMIT), item(&both, 2, item::TEMPERATURE_LIMIT)), (160, 80));
}

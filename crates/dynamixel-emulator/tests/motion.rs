//! What the shafts do in each operating mode, and what a master reads of it.
#![allow(clippy::unwrap_used, missing_docs)]

use dynamixel_emulator::packet::{Heard, Packet, Parser, instruction};
use dynamixel_emulator::{Bus, FreeShafts, Item, Model, ServoSettings, item};

/// One servo on free shafts, and a master that panics on any error of it.
struct Bench(Bus);

impl Bench {
    fn new(settings: ServoSettings) -> Self {
        let shafts = FreeShafts::new(&[settings.model]);
        Self(Bus::new(vec![settings.with(item::RETURN_DELAY_TIME, 0)], Box::new(shafts)).unwrap())
    }

    fn write(&mut self, item: Item, value: i32) {
        let mut parameters = item.address.to_le_bytes().to_vec();
        parameters.extend_from_slice(&value.to_le_bytes()[..usize::from(item.size)]);
        let answers = self.0.receive(&Packet { id: 1, instruction: instruction::WRITE, parameters }.encode());
        let mut parser = Parser::default();
        parser.push(&answers[0].bytes);
        let Some(Heard::Packet(status)) = parser.next_heard() else { panic!("no status") };
        assert_eq!(status.parameters, [0], "{item:?} = {value}");
    }

    fn item(&self, item: Item) -> i32 {
        self.0.servo(1).unwrap().item(item)
    }
}

#[test]
fn position_mode_reaches_its_goal() {
    for model in [Model::Xm540W270, Model::Xm430W350, Model::Xl430W250] {
        let mut bench = Bench::new(ServoSettings::new(1, model));
        bench.write(item::TORQUE_ENABLE, 1);
        bench.write(item::GOAL_POSITION, 3000);
        bench.0.advance(1.5);
        println!("{} {}", model.name(), bench.item(item::PRESENT_POSITION));
        assert!((bench.item(item::PRESENT_POSITION) - 3000).abs() <= 5, "{}", bench.item(item::PRESENT_POSITION));
    }
}

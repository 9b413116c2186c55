//! An arm of Dynamixel servos as an arm like any other.

use planner::manipulator::{JointTrajectory, audit};
use planner::{Arm, ArmLost, Controller, Present, Refused, START_TOLERANCE};

use crate::bus::Counters;
use crate::config::Config;
use crate::error::{HilError, Result};
use crate::joints::Joints;
use crate::link::Link;
use crate::search::Search;
use crate::servo_state::ServoState;
use crate::simulation::Simulation;
use crate::statistics::StepTimes;
use crate::trim::Trim;
use crate::watch::{Watchman, disagreement};

/// Tells the time in s: of the wall, or of an emulated bus that is run step by step.
pub type Clock = Box<dyn Fn() -> f64 + Send>;

/// Behind by more than so many steps, the arm goes on later: it would rush otherwise.
const STEPS_BEHIND: f64 = 4.0;
/// After a pause the joints are asked for so often, where an answer is missing.
const PAUSE_TRIES: usize = 3;
/// So much of a step passes on average between a goal's being sent and the middle of the time in which it holds.
const HALF_A_STEP: f64 = 0.5;
/// A trajectory may be faster than the bound by this much: what quintics overshoot, and rounding.
const SPEED_TOLERANCE: f64 = 1.001;

/// An arm on a bus that is open, holding where it stands. Dropped, it goes on holding at the last goal: [`Arm::stop`] it before, and run it
/// to its rest.
///
/// Every [`Arm::run`] is one step: a goal goes to all servos, and what they tell comes back. Goals are what the controller wants, shifted by what a
/// proportional servo lags and sags behind it ([`crate`]).
pub struct DynamixelArm {
    config: Config,
    link: Link,
    joints: Joints,
    controller: Controller,
    trim: Trim,
    clock: Clock,
    /// Where servos without a joint stay, as raw positions by servo.
    held: Vec<i32>,
    now_s: f64,
    stepped_at_s: f64,
    step_times: StepTimes,
    watchman: Watchman,
    fault: Option<HilError>,
    /// Some servos do not answer: the arm is led to rest while it is found out which.
    search: Option<Search>,
    port_is_lost: bool,
    /// What is to be there as long as the arm is.
    simulation: Option<Simulation>,
}

impl DynamixelArm {
    /// Opens `port`, checks every servo, sets it up, and holds the arm where it stands.
    ///
    /// # Errors
    /// Where a servo is missing, is another one, has latched an error, or does not do as it is told.
    pub fn open(config: Config, port: &str, clock: Clock) -> Result<Self> {
        let robot = config.robot()?;
        let link = Link::open(&config, port)?;
        let joints = Joints::new(&config, robot.clone());
        let zeros = vec![0.0; robot.chain.dof()];
        let controller = Controller::at_rest(robot, &zeros);
        let mut arm = Self {
            watchman: Watchman::new(config.watch, 0.0),
            trim: Trim::new(zeros.len()),
            joints,
            controller,
            link,
            held: Vec::new(),
            now_s: 0.0,
            stepped_at_s: clock(),
            step_times: StepTimes::default(),
            fault: None,
            search: None,
            port_is_lost: false,
            simulation: None,
            clock,
            config,
        };
        arm.hold_here()?;
        Ok(arm)
    }

    pub(crate) fn keep(&mut self, simulation: Simulation) {
        self.simulation = Some(simulation);
    }

    /// Switches all torques off: the arm falls, unless somebody holds it.
    ///
    /// # Errors
    /// The first servo that does not answer; all others are released.
    pub fn release(&mut self) -> Result<()> {
        let released: Vec<_> = self.config.ids().into_iter().map(|id| self.link.bus.set_torque(id, false)).collect();
        released.into_iter().collect()
    }

    /// What every servo told last, in the order of the configuration.
    pub fn servos(&self) -> &[ServoState] {
        &self.link.states
    }

    /// What happened on the bus.
    pub fn counters(&self) -> Counters {
        self.link.bus.counters()
    }

    /// How evenly the steps came.
    pub fn step_times(&self) -> StepTimes {
        self.step_times
    }

    /// This very moment on the arm's clock, which is later than its last step.
    pub fn clock_s(&self) -> f64 {
        self.now_s + (self.clock)() - self.stepped_at_s
    }

    /// Where the joints are to be at a time of the arm's clock, in rad.
    pub fn desired(&self, at_s: f64) -> Vec<f64> {
        self.controller.at(at_s)[0].as_slice().to_vec()
    }

    /// Reads where the joints are, makes that what is wanted, and switches the torques on.
    fn hold_here(&mut self) -> Result<()> {
        self.link.hear_surely()?;
        if let Some(apart) = disagreement(&self.config, &self.joints, &self.link.states) {
            return Err(apart);
        }
        self.held = self.link.states.iter().map(|state| state.position).collect();
        let [position, _] = self.measured();
        self.controller.rest_at(self.now_s, &position);
        self.trim.forget();
        self.watchman = Watchman::new(self.config.watch, self.now_s);
        self.send()?;
        self.link.torques_on(&self.config)
    }

    /// Positions and velocities of the joints as last heard, in rad and rad/s.
    fn measured(&self) -> [Vec<f64>; 2] {
        self.joints.measured(&self.link.states)
    }

    /// Sends the goals of now.
    fn send(&mut self) -> Result<()> {
        let ahead_s = HALF_A_STEP / self.config.rate_hz;
        let [position, velocity, acceleration] = self.controller.at(self.now_s + ahead_s);
        let position = self.trim.shifted(position.as_slice());
        let goals =
            self.joints.goals([&position, velocity.as_slice(), acceleration.as_slice()], &self.held, &self.link.ranges);
        self.link.send(&goals)
    }

    /// One step: goals out, states in, and a look at both.
    fn step(&mut self) {
        let at_s = (self.clock)();
        let gap_s = at_s - self.stepped_at_s;
        self.stepped_at_s = at_s;
        self.step_times.note(gap_s);
        let moves = self.controller.ends_at_s() > self.now_s;
        if gap_s > self.config.watch.pause_s && moves && self.fault.is_none() {
            // The servos have long come to rest at the last goal: that is where to go on from, and not where the motion would be by now.
            let heard = (0..PAUSE_TRIES).any(|_| self.link.hear().is_ok());
            let [measured, _] = self.measured();
            let stands = if heard { measured } else { self.desired(self.now_s - 1.0 / self.config.rate_hz) };
            self.controller.rest_at(self.now_s, &stands);
            // Who is silent is worth more to know.
            if self.search.is_none() {
                self.fail(HilError::Paused { pause_s: gap_s });
            }
        }
        if let Some(mut search) = self.search.take() {
            match self.send().and_then(|()| search.ask(&mut self.link.bus)) {
                Ok(None) => self.search = Some(search),
                Ok(Some(why)) | Err(why) => self.stopped_for(why),
            }
            return;
        }
        match self.send().and_then(|()| self.link.hear()) {
            Ok(()) => {
                self.watchman.heard(self.now_s);
                let [position, _] = self.measured();
                if self.fault.is_some() {
                    self.give_way(&position)
                } else {
                    self.learn(&position)
                }
                self.look(&position);
            }
            Err(HilError::GroupMissed) => {
                let [position, _] = self.measured();
                self.look(&position);
            }
            Err(error) => self.fail(error),
        }
    }

    /// Learns from what was just heard.
    fn learn(&mut self, position: &[f64]) {
        let asked_at_s = self.now_s + self.link.asks_after_s;
        self.trim.learn(self.controller.at(asked_at_s)[0].as_slice(), position, 1.0 / self.config.rate_hz);
    }

    /// After a stop, joints that press against something stand where they are.
    fn give_way(&mut self, position: &[f64]) {
        if self.controller.ends_at_s() <= self.now_s {
            let desired = self.desired(self.now_s);
            if let Some(stand) = self.watchman.give_way(position, &desired) {
                self.controller.rest_at(self.now_s, &stand);
            }
        }
    }

    /// Looks for faults.
    fn look(&mut self, position: &[f64]) {
        if self.fault.is_some() {
            return;
        }
        let desired = &self.controller.at(self.now_s)[0];
        let states = &self.link.states;
        match self.watchman.look(self.now_s, &self.config, &self.joints, states, [position, desired.as_slice()]) {
            None => {}
            // Somebody does not answer: who?
            Some(HilError::GroupMissed) => {
                self.controller.stop(self.now_s);
                self.search = Some(Search::among(self.config.ids()));
            }
            Some(why) => self.fail(why),
        }
    }

    /// Stops on the path, along which servos that do not answer may still hear that they are led.
    fn fail(&mut self, why: HilError) {
        if self.fault.is_none() {
            self.controller.stop(self.now_s);
        }
        self.stopped_for(why);
    }

    /// Keeps the first fault of an arm that has stopped, or does so.
    fn stopped_for(&mut self, why: HilError) {
        self.note_lost_port(&why);
        self.fault.get_or_insert(why);
    }

    fn note_lost_port(&mut self, why: &HilError) {
        if matches!(why, HilError::PortLost { .. }) && !std::mem::replace(&mut self.port_is_lost, true) {
            self.link.bus.close();
        }
    }

    /// Whether the servos may follow what `next` plays from `from_s` on.
    fn check(&self, next: &Controller, from_s: f64) -> std::result::Result<(), Refused> {
        let audit = audit(next.robot(), next.playing());
        let refused = |why: String| Err(Refused::Goal(why));
        let (velocity, acceleration) = (audit.max_ratio.velocity, audit.max_ratio.acceleration);
        if velocity > SPEED_TOLERANCE {
            let limit = self.config.velocity_rad_s;
            return refused(format!("it is {velocity:.2} times as fast as this arm may be ({limit} rad/s)"));
        }
        if acceleration > SPEED_TOLERANCE {
            return refused(format!("its acceleration is {acceleration:.2} times what this arm's limits allow"));
        }
        if audit.position_margin < -START_TOLERANCE {
            return refused(format!("it leads {:.3} rad beyond the position limit of a joint", -audit.position_margin));
        }
        if self.controller.ends_at_s() <= self.now_s {
            let [stands, _] = self.measured();
            let begins = &next.at(from_s)[0];
            let tolerance = self.config.watch.start_rad;
            for (joint, name) in self.joint_names().iter().enumerate() {
                let by = begins[joint] - stands[joint];
                if by.abs() > tolerance {
                    return Err(Refused::Goal(format!("{name} would begin with a jump of its position by {by:.4}")));
                }
            }
        }
        Ok(())
    }
}

impl Arm for DynamixelArm {
    fn joint_names(&self) -> &[String] {
        self.controller.robot().chain.joint_names()
    }

    fn run(&mut self, until_s: f64) -> std::result::Result<(), ArmLost> {
        self.now_s = until_s;
        self.step();
        Ok(())
    }

    fn play(&mut self, starts_at_s: Option<f64>, trajectory: JointTrajectory) -> std::result::Result<u64, Refused> {
        if let Some(fault) = &self.fault {
            return Err(Refused::Faulty(fault.to_string()));
        }
        if self.search.is_some() {
            return Err(Refused::Faulty(HilError::GroupMissed.to_string()));
        }
        let mut next = self.controller.clone();
        let number = next.play(self.now_s, starts_at_s, trajectory)?;
        self.check(&next, starts_at_s.unwrap_or(self.now_s).max(self.now_s))?;
        self.controller = next;
        Ok(number)
    }

    fn stop(&mut self) {
        self.controller.stop(self.now_s);
    }

    fn present(&self) -> Present {
        let [position, velocity] = self.measured();
        let fault = self.fault.as_ref().map(ToString::to_string);
        let mut present = Present { fault, ..self.controller.present(self.now_s, position, velocity) };
        if self.search.is_some() {
            // Whoever waits for the end of the motion waits until it is known why it stops.
            present.ends_at_s = present.ends_at_s.max(self.now_s + 1.0 / self.config.rate_hz);
        }
        present
    }

    fn recover(&mut self) -> std::result::Result<(), Refused> {
        if self.search.is_some() {
            return Err(Refused::Faulty(HilError::GroupMissed.to_string()));
        }
        if self.fault.is_none() {
            return Ok(());
        }
        let mended = self.link.mend(&self.config, self.port_is_lost).and_then(|()| {
            self.port_is_lost = false;
            self.hold_here()
        });
        if let Err(why) = mended {
            self.note_lost_port(&why);
            return Err(Refused::Faulty(why.to_string()));
        }
        self.fault = None;
        self.stepped_at_s = (self.clock)();
        Ok(())
    }

    fn most_behind_s(&self) -> f64 {
        STEPS_BEHIND / self.config.rate_hz
    }
}

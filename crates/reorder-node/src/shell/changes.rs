//! What changes the node itself: another robot, other parameters, another state of its life.

use planner::Input;

use super::{Shell, goals};
use crate::managed::LifeCycleCall;
use crate::parameters::ParameterCall;
use crate::stamps::Stamps;

impl Shell {
    /// Plans for the robot that is described, if it is one.
    pub(super) fn describe(&mut self, urdf: String) {
        if !self.parameters.robot.from_description || urdf == self.description {
            return;
        }
        match self.parameters.robot.described(&urdf) {
            Ok(robot) => {
                self.log.info(format!("robot_description is taken up: {}, {} joints", robot.name, robot.chain.dof()));
                self.health.robot_fault = None;
                self.handle(Input::Robot(Box::new(robot)), None);
            }
            Err(why) => {
                self.log.error(format!("robot_description is ignored: {why}"));
                self.health.robot_fault = Some(why);
            }
        }
        self.description = urdf;
        self.report_if_changed();
    }

    pub(super) fn answer(&mut self, call: ParameterCall) {
        match self.services.parameters.answer(call, &mut self.parameters, Stamps::now_ns()) {
            Ok(changed) if changed.is_empty() => {}
            Ok(changed) => {
                for (name, value) in changed {
                    self.log.info(format!("{name} is now {value:?}"));
                }
                self.handle(Input::Configure(Box::new(self.parameters.planner_config())), None);
            }
            Err(error) => self.check("answering about parameters", Err(error)),
        }
    }

    pub(super) fn live(&mut self, call: LifeCycleCall) {
        let before = self.life;
        let answered = self.services.life_cycle.answer(call, &mut self.life, Stamps::now_ns());
        self.check("answering about the state", answered);
        if self.life == before {
            return;
        }
        self.log.info(format!("{}, and was {}", self.life.state().1, before.state().1));
        if before.is_active() {
            // Nothing that was asked for before may come out after the next activation, or go on.
            self.forget_waiting();
            self.handle(Input::Clear, None);
            if let Some(goal) = self.goal.1.take() {
                tokio::spawn(async move { goals::cancelled(&goal).await });
            }
        }
        self.report();
    }
}

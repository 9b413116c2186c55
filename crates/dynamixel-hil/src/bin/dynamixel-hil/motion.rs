//! A motion while it is made: where the joints are to be, and where MuJoCo has them.

use dynamixel_hil::planner::Arm;
use dynamixel_hil::planner::manipulator::Robot;
use dynamixel_hil::planner::manipulator::nalgebra::DVector;
use dynamixel_hil::planner::se3_geom::{Manifold, So3};
use dynamixel_hil::{DynamixelArm, Simulation};

use crate::pacer::Pacer;
use crate::shape::Shape;

/// How long the arm may settle after a motion, in s.
const SETTLE_S: f64 = 0.5;

/// The joints in simulation, all along a motion.
#[derive(Default)]
pub(crate) struct Record {
    /// Time from the motion's start in s, and positions in rad.
    samples: Vec<(f64, Vec<f64>)>,
    squares: f64,
    count: usize,
    /// The greatest error of a joint, in rad.
    pub(crate) max_rad: f64,
    /// The greatest speed of a joint, in rad/s.
    pub(crate) fastest_rad_s: f64,
}

impl Record {
    /// Plays a shape's trajectory to its end, or to a fault, in real time.
    pub(crate) fn of(
        shape: &Shape,
        arm: &mut DynamixelArm,
        simulation: &Simulation,
        pacer: &mut Pacer,
    ) -> Result<Self, String> {
        let begins_s = arm.present().now_s;
        arm.play(Some(begins_s), shape.trajectory.clone()).map_err(|why| format!("{}: {why}", shape.name))?;
        let mut record = Self::default();
        let ends_s = begins_s + shape.trajectory.duration_s();
        loop {
            pacer.step(arm).map_err(|lost| lost.to_string())?;
            let (at_s, truth) = (arm.clock_s(), simulation.view().now());
            if at_s > ends_s + SETTLE_S {
                return Ok(record);
            }
            if let Some(fault) = arm.present().fault {
                return Err(format!("{}: {fault}", shape.name));
            }
            for (is, wanted) in truth.position.iter().zip(&arm.desired(at_s)) {
                let error = (is - wanted).abs();
                record.squares += error * error;
                record.count += 1;
                record.max_rad = record.max_rad.max(error);
            }
            record.fastest_rad_s = truth.velocity.iter().fold(record.fastest_rad_s, |most, v| most.max(v.abs()));
            record.samples.push((at_s - begins_s, truth.position));
        }
    }

    /// Root mean square of the error over all joints and samples, in rad.
    pub(crate) fn rms_rad(&self) -> f64 {
        (self.squares / self.count.max(1) as f64).sqrt()
    }

    /// The tool's greatest distance (m) and angle (rad) from each pose at its time.
    pub(crate) fn pose_errors(&self, robot: &Robot, shape: &Shape) -> [f64; 2] {
        let mut worst = [0.0_f64; 2];
        for (pose, &time_s) in shape.poses.iter().zip(&shape.pose_times_s) {
            let tool = robot.chain.forward(&self.at(time_s));
            worst[0] = worst[0].max((tool.translation.vector - pose.translation.vector).norm());
            worst[1] = worst[1].max(So3.distance(&tool.rotation, &pose.rotation));
        }
        worst
    }

    /// The joints at a time, on a line between samples 5 ms apart: at 5 rad/s² that is off by 5·0.005²/8 = 2e-5 rad.
    fn at(&self, time_s: f64) -> DVector<f64> {
        let after = self.samples.partition_point(|(at_s, _)| *at_s < time_s);
        let [(t0, q0), (t1, q1)] =
            [after.saturating_sub(1), after].map(|k| &self.samples[k.min(self.samples.len() - 1)]);
        let share = if t1 > t0 { ((time_s - t0) / (t1 - t0)).clamp(0.0, 1.0) } else { 0.0 };
        DVector::from_iterator(q0.len(), q0.iter().zip(q1).map(|(a, b)| a + share * (b - a)))
    }
}

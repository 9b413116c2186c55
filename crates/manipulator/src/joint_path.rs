//! A path of the joints, without time.

use nalgebra::DVector;

use crate::error::Result;
use crate::quintic_spline::{EndDerivatives, QuinticSpline};

/// A C⁴ quintic spline q(s) through configurations, with the parameters at which it passes given tool poses.
#[derive(Debug, Clone)]
pub struct JointPath {
    spline: QuinticSpline,
    pose_parameters: Vec<f64>,
}

impl JointPath {
    /// The C⁴ path that passes `configurations[i]`, of shape (dof), at `parameters[i]`, with the given end derivatives. Every
    /// configuration counts as one of its poses.
    ///
    /// # Errors
    /// [`crate::ManipulatorError`] for parameters that do not increase, sizes that do not agree, or numbers that are not finite.
    pub fn through(parameters: &[f64], configurations: &[DVector<f64>], ends: [&EndDerivatives; 2]) -> Result<Self> {
        let spline = QuinticSpline::through(parameters, configurations, ends)?;
        Ok(Self { spline, pose_parameters: parameters.to_vec() })
    }

    pub(crate) fn with_poses_at(spline: QuinticSpline, pose_parameters: Vec<f64>) -> Self {
        Self { spline, pose_parameters }
    }

    /// First and last parameter.
    pub fn domain(&self) -> (f64, f64) {
        let knots = self.spline.knots();
        (knots[0], knots[knots.len() - 1])
    }

    /// q, q′, q″ and q‴ at `s`, each of shape (dof). Beyond its domain the path stays at its end.
    pub fn at(&self, s: f64) -> [DVector<f64>; 4] {
        self.spline.at(s)
    }

    /// q, q′, q″ and q‴ of each joint in turn at `s`, without memory from the heap.
    pub(crate) fn joints_at(&self, s: f64) -> impl ExactSizeIterator<Item = [f64; 4]> + '_ {
        let (polynomials, local) = self.spline.polynomials_at(s);
        polynomials.iter().map(move |polynomial| polynomial.at(local))
    }

    /// The parameter at which each input pose is passed, increasing.
    pub fn pose_parameters(&self) -> &[f64] {
        &self.pose_parameters
    }

    /// The parameters of the samples that the spline interpolates.
    pub fn knots(&self) -> &[f64] {
        self.spline.knots()
    }
}

use nalgebra::{DMatrix, DVector, Matrix3, Vector3};
use se3_geom::{LieGroup, Pose, Se3Group};

use super::*;

fn number(seed: usize, k: usize) -> f64 {
    ((37 * seed + 101 * k) as f64).sin()
}

fn vector(seed: usize, k: usize) -> Vector3<f64> {
    Vector3::new(number(seed, k), number(seed, k + 1), number(seed, k + 2))
}

/// A chain of turning and sliding joints on skew axes, every link with mass and a full tensor, gravity aslant, drives without friction.
struct Arm {
    chain: Chain,
    dynamics: Dynamics,
    bodies: Vec<(f64, Vector3<f64>, Matrix3<f64>)>,
    gravity: Vector3<f64>,
}

fn arm(dof: usize, seed: usize) -> Arm {
    let joints = (0..dof).map(|i| {
        let axis = vector(seed, 10 * i + 1).normalize();
        let through = vector(seed, 10 * i + 4);
        let screw =
            if i % 3 == 2 { Twist::new(axis, Vector3::zeros()) } else { Twist::new(through.cross(&axis), axis) };
        (format!("joint{i}"), screw)
    });
    let home = Se3Group::exp(Twist::new(vector(seed, 500), vector(seed, 503)));
    let chain = Chain::from_space_screws(joints.collect(), home).unwrap();
    let bodies: Vec<_> = (0..dof)
        .map(|i| {
            let spread = Matrix3::from_fn(|r, c| number(seed, 600 + 20 * i + 3 * r + c));
            (1.5 + number(seed, 700 + i), vector(seed, 800 + 5 * i), spread * spread.transpose())
        })
        .collect();
    let links: Vec<_> = bodies.iter().map(|(m, c, i)| Inertia::of_body(*m, *c, *i).unwrap()).collect();
    let drive = Drive { rotor_inertia_kg_m2: 0.3, ..Drive::default() };
    let gravity = Vector3::new(1.0, -2.0, -9.0);
    let dynamics = Dynamics::new(&chain, &links, &vec![drive; dof], gravity.into()).unwrap();
    Arm { chain, dynamics, bodies, gravity }
}

impl Arm {
    /// `base_from_link` of every link: where the base frame of the arm at zero has been carried, a product of exponentials in the base.
    fn links(&self, q: &DVector<f64>) -> Vec<Pose> {
        let home = self.chain.home();
        let mut moved = *home;
        let chain = self.chain.screws().iter().zip(q.iter());
        chain
            .map(|(screw, angle)| {
                moved *= Se3Group::exp(*screw * *angle);
                moved * home.inverse()
            })
            .collect()
    }

    fn potential(&self, q: &DVector<f64>) -> f64 {
        let links = self.links(q);
        links
            .iter()
            .zip(&self.bodies)
            .map(|(link, (mass, center, _))| {
                -mass * self.gravity.dot(&(link.rotation * center + link.translation.vector))
            })
            .sum()
    }

    /// From differences of link poses along q + t·q̇: knows nothing of the recursion.
    fn kinetic(&self, q: &DVector<f64>, rates: &DVector<f64>) -> f64 {
        const H: f64 = 1e-4;
        // Five-point differences: error H⁴/30 of the fifth derivative, some 1e-16 · 1e3, and rounding 1e-16/H.
        let at = |k: f64| self.links(&(q + rates * (k * H)));
        let samples = [-2.0, -1.0, 1.0, 2.0].map(at);
        let rotor: f64 = 0.15 * rates.norm_squared();
        let bodies = self.bodies.iter().enumerate().map(|(i, (mass, center, tensor))| {
            let [a, b, c, d] = [0, 1, 2, 3].map(|k| samples[k][i]);
            let place = |pose: Pose| pose.rotation * center + pose.translation.vector;
            let speed = (place(a) - place(b) * 8.0 + place(c) * 8.0 - place(d)) / (12.0 * H);
            let turn = |from: Pose, to: Pose| (from.rotation.inverse() * to.rotation).scaled_axis();
            let spin = (turn(b, c) * 8.0 - turn(a, d)) / (12.0 * H);
            0.5 * mass * speed.norm_squared() + 0.5 * spin.dot(&(tensor * spin))
        });
        rotor + bodies.sum::<f64>()
    }

    fn torque(&self, q: &DVector<f64>, rates: &DVector<f64>, accelerations: &DVector<f64>) -> DVector<f64> {
        let mut torque = DVector::from_element(q.len(), f64::NAN);
        self.dynamics.torque(q.as_slice(), rates.as_slice(), accelerations.as_slice(), torque.as_mut_slice());
        torque
    }
}

fn state(dof: usize, seed: usize) -> [DVector<f64>; 3] {
    [0, 1, 2].map(|k| DVector::from_fn(dof, |j, _| 1.3 * number(seed + 7, 1000 * k + 3 * j)))
}

/// τ·q̇ = d/dt (kinetic + potential energy) along q + q̇t + q̈t²/2: halving the step of the central difference quarters the defect.
#[test]
fn power_is_the_rate_of_kinetic_and_potential_energy() {
    for (dof, seed) in [(1, 1), (2, 2), (6, 3), (7, 4), (20, 5)] {
        let arm = arm(dof, seed);
        let [q, rates, accelerations] = state(dof, seed);
        let power = arm.torque(&q, &rates, &accelerations).dot(&rates);
        let energy = |t: f64| {
            let there = &q + &rates * t + &accelerations * (0.5 * t * t);
            let rates = &rates + &accelerations * t;
            arm.potential(&there) + arm.kinetic(&there, &rates)
        };
        let defect = |h: f64| ((energy(h) - energy(-h)) / (2.0 * h) - power).abs();
        let [coarse, fine] = [4e-3, 2e-3].map(defect);
        assert!(fine < 1e-3 * power.abs().max(1.0), "{dof} joints: {fine} of {power}");
        assert!((coarse / fine - 4.0).abs() < 0.2, "{dof} joints: {coarse} {fine}");
    }
}

#[test]
fn mass_matrix_is_symmetric_positive_definite_and_the_kinetic_energy() {
    for (dof, seed) in [(6, 11), (7, 12)] {
        let arm = arm(dof, seed);
        let [q, rates, _] = state(dof, seed);
        let zero = DVector::zeros(dof);
        let at_rest = arm.torque(&q, &zero, &zero);
        let columns: Vec<_> = (0..dof)
            .map(|j| arm.torque(&q, &zero, &DVector::from_fn(dof, |i, _| f64::from(i == j))) - &at_rest)
            .collect();
        let matrix = DMatrix::from_columns(&columns);
        let size = matrix.amax();
        assert!((&matrix - matrix.transpose()).amax() < 1e-13 * size);
        assert!(matrix.clone().symmetric_eigenvalues().min() > 0.0);
        let energy = 0.5 * rates.dot(&(&matrix * &rates));
        // Differences of poses: see `kinetic`.
        assert!((energy - arm.kinetic(&q, &rates)).abs() < 1e-9 * energy);
    }
}

#[test]
fn holding_torque_is_the_gradient_of_the_potential() {
    for (dof, seed) in [(6, 21), (7, 22)] {
        let arm = arm(dof, seed);
        let [q, ..] = state(dof, seed);
        let zero = DVector::zeros(dof);
        let holding = arm.torque(&q, &zero, &zero);
        for joint in 0..dof {
            let defect = |h: f64| {
                let step = DVector::from_fn(dof, |j, _| if j == joint { h } else { 0.0 });
                ((arm.potential(&(&q + &step)) - arm.potential(&(&q - &step))) / (2.0 * h) - holding[joint]).abs()
            };
            let [coarse, fine] = [0.02, 0.01].map(defect);
            // A slide's potential is linear: only rounding is left.
            assert!(fine < 1e-2 && (fine < 1e-10 || (coarse / fine - 4.0).abs() < 0.1), "{joint}: {coarse} {fine}");
        }
        assert!(holding.amax() > 1.0);
    }
}

#[test]
fn drives_add_inertia_damping_and_friction_of_the_right_sign() {
    let mut arm = arm(3, 31);
    let [q, _, accelerations] = state(3, 31);
    let rates = DVector::from_vec(vec![0.5, -0.25, 0.0]);
    let links: Vec<_> = arm.bodies.iter().map(|(m, c, i)| Inertia::of_body(*m, *c, *i).unwrap()).collect();
    let drive = Drive { rotor_inertia_kg_m2: 0.3, damping_n_m_s: 2.0, friction_n_m: 3.0 };
    let without = arm.torque(&q, &rates, &accelerations);
    arm.dynamics = Dynamics::new(&arm.chain, &links, &[drive; 3], arm.gravity.into()).unwrap();
    let added = arm.torque(&q, &rates, &accelerations) - without;
    assert!((added - DVector::from_vec(vec![1.0 + 3.0, -0.5 - 3.0, 0.0])).amax() < 1e-13);
}

#[test]
fn malformed_dynamics_are_refused() {
    let arm = arm(2, 41);
    let (links, drives) = ([Inertia::default(); 2], [Drive::default(); 2]);
    let made = |links: &[Inertia], drives: &[Drive], gravity| Dynamics::new(&arm.chain, links, drives, gravity);
    assert!(made(&links, &drives, GRAVITY_M_S2).is_ok());
    assert!(matches!(made(&links[..1], &drives, GRAVITY_M_S2), Err(ManipulatorError::WrongSize { .. })));
    assert!(matches!(made(&links, &drives[..1], GRAVITY_M_S2), Err(ManipulatorError::WrongSize { .. })));
    assert!(matches!(made(&links, &drives, [f64::NAN; 3]), Err(ManipulatorError::NonFinite { .. })));
    for value in [-1.0, f64::NAN, f64::INFINITY] {
        let bad = Drive { damping_n_m_s: value, ..Drive::default() };
        assert!(matches!(made(&links, &[drives[0], bad], GRAVITY_M_S2), Err(ManipulatorError::InvalidJoint { .. })));
    }
}

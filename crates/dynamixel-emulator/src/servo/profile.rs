//! The trajectory between goals, after [What is the Profile](https://emanual.robotis.com/docs/en/dxl/x/xm540-w270/#what-is-the-profile).

/// How a goal is approached. Units are pulses and seconds.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    /// The trajectory is the goal.
    Step,
    /// At most so fast, and no faster gained than so; an infinite acceleration gives a rectangle.
    Velocity { velocity: f64, acceleration: f64 },
    /// In so much time, and accelerating for so long at either end.
    Time { total_s: f64, accelerating_s: f64 },
}

/// Names of the shapes in Moving Status.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Step = 0,
    Rectangular = 1,
    Triangular = 2,
    Trapezoidal = 3,
}

/// Where the trajectory is, how fast and how it gains speed.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Desired {
    pub(crate) position: f64,
    pub(crate) velocity: f64,
    pub(crate) acceleration: f64,
}

/// Three stretches of constant acceleration, of which the second has none, that end at rest on the goal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Profile {
    from: Desired,
    goal: f64,
    /// Velocity of the second stretch.
    cruise: f64,
    durations: [f64; 3],
    elapsed: f64,
    pub(crate) kind: Kind,
}

impl Profile {
    /// No motion: the goal is where the trajectory is.
    pub(crate) fn at_rest(position: f64) -> Self {
        let from = Desired { position, ..Desired::default() };
        Self { from, goal: position, cruise: 0.0, durations: [0.0; 3], elapsed: 0.0, kind: Kind::Step }
    }

    /// From the present state of the trajectory to rest at `goal`.
    pub(crate) fn new(from: Desired, goal: f64, shape: Shape) -> Self {
        let distance = goal - from.position;
        let (cruise, durations, kind) = match shape {
            Shape::Step => return Self::at_rest(goal),
            Shape::Time { total_s, accelerating_s } => {
                // Accelerating from the present velocity, cruising, braking: the three areas make up the distance.
                let accelerating_s = accelerating_s.min(total_s / 2.0);
                let cruise = (distance - from.velocity * accelerating_s / 2.0) / (total_s - accelerating_s);
                let kind = if accelerating_s > 0.0 { Kind::Trapezoidal } else { Kind::Rectangular };
                (cruise, [accelerating_s, total_s - 2.0 * accelerating_s, accelerating_s], kind)
            }
            Shape::Velocity { velocity, acceleration } if acceleration.is_infinite() => {
                (velocity * distance.signum(), [0.0, distance.abs() / velocity, 0.0], Kind::Rectangular)
            }
            Shape::Velocity { velocity, acceleration } => trapezoid(from.velocity, distance, velocity, acceleration),
        };
        Self { from, goal, cruise, durations, elapsed: 0.0, kind }
    }

    pub(crate) fn is_ongoing(&self) -> bool {
        self.elapsed < self.durations.iter().sum()
    }

    pub(crate) fn goal(&self) -> f64 {
        self.goal
    }

    pub(crate) fn advance(&mut self, dt_s: f64) {
        self.elapsed += dt_s;
    }

    pub(crate) fn desired(&self) -> Desired {
        let [t1, t2, t3] = self.durations;
        let (at, remaining) = (self.elapsed, t1 + t2 + t3 - self.elapsed);
        if remaining <= 0.0 {
            return Desired { position: self.goal, ..Desired::default() };
        }
        if at < t1 {
            let acceleration = (self.cruise - self.from.velocity) / t1;
            let velocity = self.from.velocity + acceleration * at;
            return Desired {
                position: self.from.position + (self.from.velocity + velocity) / 2.0 * at,
                velocity,
                acceleration,
            };
        }
        // Backwards from the goal, where the trajectory rests.
        if remaining < t3 {
            let (velocity, acceleration) = (self.cruise * remaining / t3, -self.cruise / t3);
            return Desired { position: self.goal - velocity / 2.0 * remaining, velocity, acceleration };
        }
        let position = self.goal - self.cruise * (t3 / 2.0 + remaining - t3);
        Desired { position, velocity: self.cruise, acceleration: 0.0 }
    }
}

/// The fastest way over `distance` from velocity `v0` to rest under limits of velocity and acceleration.
fn trapezoid(v0: f64, distance: f64, velocity: f64, acceleration: f64) -> (f64, [f64; 3], Kind) {
    // Braking at once leads here; the goal beyond or before it says which way to go.
    let ahead = distance - v0 * v0.abs() / (2.0 * acceleration);
    let sign = if ahead < 0.0 { -1.0 } else { 1.0 };
    let (v0, distance) = (sign * v0, sign * distance);
    let peak = (acceleration * distance + v0 * v0 / 2.0).max(0.0).sqrt();
    let cruise = peak.min(velocity);
    let (t1, t3) = ((cruise - v0).abs() / acceleration, cruise / acceleration);
    let rest = distance - (v0 + cruise) / 2.0 * t1 - cruise / 2.0 * t3;
    let t2 = if peak > velocity { (rest / cruise).max(0.0) } else { 0.0 };
    let kind = if peak > velocity { Kind::Trapezoidal } else { Kind::Triangular };
    (sign * cruise, [t1, t2, t3], kind)
}

#[cfg(test)]
mod tests {
    use super::*;

    const DT: f64 = 1e-3;

    /// Runs a profile, and checks that position, velocity and acceleration are one another's rates and within limits.
    fn run(from: Desired, goal: f64, shape: Shape, limits: (f64, f64)) -> f64 {
        let mut profile = Profile::new(from, goal, shape);
        let (mut before, mut elapsed) = (profile.desired(), 0.0);
        assert!((before.position - from.position).abs() < 1e-9 && (before.velocity - from.velocity).abs() < 1e-9);
        while profile.is_ongoing() {
            profile.advance(DT);
            elapsed += DT;
            let now = profile.desired();
            assert!(now.velocity.abs() <= limits.0 * (1.0 + 1e-9), "{now:?}");
            // A step of the trapezoid rule over a change of acceleration is wrong by at most a·dt²/2.
            let moved = (before.velocity + now.velocity) / 2.0 * DT;
            assert!((now.position - before.position - moved).abs() <= limits.1 * DT * DT, "{before:?} {now:?}");
            assert!((now.velocity - before.velocity).abs() <= limits.1 * DT * (1.0 + 1e-9), "{before:?} {now:?}");
            before = now;
        }
        assert_eq!(profile.desired(), Desired { position: goal, ..Desired::default() });
        elapsed
    }

    #[test]
    fn velocity_profiles_keep_their_limits_from_any_state() {
        let shape = Shape::Velocity { velocity: 500.0, acceleration: 2000.0 };
        for (velocity, goal) in [
            (0.0, 1000.0),
            (0.0, -1000.0),
            (0.0, 10.0),
            (400.0, 1000.0),
            (400.0, -1000.0),
            (400.0, 20.0),
            (-400.0, 20.0),
            (0.0, 0.0),
        ] {
            run(Desired { velocity, ..Desired::default() }, goal, shape, (500.0, 2000.0));
        }
        // 1000 pulses at 500/s, and half a quarter of a second lost at either end.
        let took = run(Desired::default(), 1000.0, shape, (500.0, 2000.0));
        assert!((took - 2.25).abs() < 1.5 * DT, "{took}");
    }

    #[test]
    fn time_profiles_arrive_in_time() {
        let shape = Shape::Time { total_s: 2.0, accelerating_s: 0.5 };
        for velocity in [0.0, 100.0, -100.0] {
            let took = run(Desired { velocity, ..Desired::default() }, 1000.0, shape, (1000.0, 3000.0));
            assert!((took - 2.0).abs() < 1.5 * DT, "{took}");
        }
    }

    #[test]
    fn shapes_have_their_names() {
        let kind = |velocity, acceleration| {
            Profile::new(Desired::default(), 1000.0, Shape::Velocity { velocity, acceleration }).kind
        };
        assert_eq!(kind(500.0, 2000.0), Kind::Trapezoidal);
        assert_eq!(kind(5000.0, 2000.0), Kind::Triangular);
        assert_eq!(kind(500.0, f64::INFINITY), Kind::Rectangular);
        assert_eq!(Profile::new(Desired::default(), 1000.0, Shape::Step).kind, Kind::Step);
    }
}

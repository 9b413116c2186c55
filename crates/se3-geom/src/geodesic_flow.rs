//! Initial-value problems: geodesics and parallel fields along them, where no closed form exists.
//!
//! Gragg–Bulirsch–Stoer extrapolation of the modified midpoint rule (Hairer, Nørsett, Wanner, *Solving Ordinary Differential
//! Equations I*, §II.9): a Runge–Kutta method of order 16 without a table of coefficients. At the accuracy wanted here, close to
//! rounding, a fifth-order pair needs some fifty times the evaluations.

use nalgebra::{SMatrix, SVector};

/// What a space of points in ℝᴺ must state to have its geodesics computed.
pub(crate) trait Connection<const N: usize> {
    /// dW/dt of a parallel field with value `w` at `x` along a curve of velocity `u`: −Γ(u, w), thesis eq. (3.8).
    fn parallel_rate(&self, x: &SVector<f64, N>, u: &SVector<f64, N>, w: &SVector<f64, N>) -> SVector<f64, N>;
    /// The metric's matrix at `x`.
    fn metric(&self, x: &SVector<f64, N>) -> SMatrix<f64, N, N>;
    /// The point of the space next to `x`, if there is one.
    fn project(&self, x: &SVector<f64, N>) -> Option<SVector<f64, N>>;
    /// The part of `v` tangent to the space at `x`.
    fn project_tangent(&self, x: &SVector<f64, N>, v: &SVector<f64, N>) -> SVector<f64, N>;
}

/// A point, its velocity, and C − 2 parallel fields.
pub(crate) type State<const N: usize, const C: usize> = [SVector<f64, N>; C];

const COLUMNS: usize = 8;
/// Relative error of one step; extrapolation multiplies the rounding of its columns by 60 at most, that is 1.3e-14.
const TOLERANCE: f64 = 1e-13;
/// A geodesic that needs steps shorter than this part of itself runs into a place where the space is not smooth.
const SHORTEST_STEP: f64 = 1e-6;

/// The state after unit time along the geodesic; `None` where the space's derivatives are not finite or not smooth.
pub(crate) fn flow<const N: usize, const C: usize>(
    space: &impl Connection<N>,
    start: State<N, C>,
) -> Option<State<N, C>> {
    let mut state = start;
    let (mut time, mut step) = (0.0, 1.0_f64);
    while time < 1.0 {
        let last = time + step >= 1.0;
        let width = if last { 1.0 - time } else { step };
        match extrapolated_step(space, &state, width) {
            Some((columns, increment)) => {
                for (value, change) in state.iter_mut().zip(increment) {
                    *value += change;
                }
                state[0] = space.project(&state[0])?;
                let [point, vectors @ ..] = &mut state[..] else { return None };
                for vector in vectors {
                    *vector = space.project_tangent(point, vector);
                }
                if last {
                    return Some(state);
                }
                time += width;
                step = width * if columns < COLUMNS - 2 { 1.5 } else { 0.9 };
            }
            None if width < SHORTEST_STEP => return None,
            None => step = 0.5 * width,
        }
    }
    Some(state)
}

fn rate<const N: usize, const C: usize>(space: &impl Connection<N>, state: &State<N, C>) -> State<N, C> {
    let mut rate = *state;
    rate[0] = state[1];
    for (rate, vector) in rate[1..].iter_mut().zip(&state[1..]) {
        *rate = space.parallel_rate(&state[0], &state[1], vector);
    }
    rate
}

fn shifted<const N: usize, const C: usize>(state: &State<N, C>, by: &State<N, C>, factor: f64) -> State<N, C> {
    std::array::from_fn(|i| state[i] + by[i] * factor)
}

/// The increment of the state over `width` and how many columns it took; `None` where they do not settle.
fn extrapolated_step<const N: usize, const C: usize>(
    space: &impl Connection<N>,
    state: &State<N, C>,
    width: f64,
) -> Option<(usize, State<N, C>)> {
    let zero = [SVector::zeros(); C];
    let first_rate = rate(space, state);
    // table[j] holds T(k, j) of the row in work; the row before is overwritten from the left.
    let mut table = [zero; COLUMNS];
    for k in 0..COLUMNS {
        let substeps = 2 * (k + 1);
        let h = width / substeps as f64;
        let (mut before, mut now) = (zero, shifted(&zero, &first_rate, h));
        for _ in 1..substeps {
            let slope = rate(space, &shifted(state, &now, 1.0));
            (before, now) = (now, shifted(&before, &slope, 2.0 * h));
        }
        let mut entry = now;
        for (j, above) in table[..k].iter_mut().enumerate() {
            let ratio = (k + 1) as f64 / (k - j) as f64;
            let coarse = std::mem::replace(above, entry);
            entry = std::array::from_fn(|i| entry[i] + (entry[i] - coarse[i]) / (ratio * ratio - 1.0));
        }
        table[k] = entry;
        if k >= 2 && settled(state, &entry, &table[k - 1]) {
            return Some((k, entry));
        }
    }
    None
}

/// The position to the size of its coordinates and of the whole geodesic, every vector to its own size.
fn settled<const N: usize, const C: usize>(state: &State<N, C>, fine: &State<N, C>, coarse: &State<N, C>) -> bool {
    (0..C).all(|i| {
        let size = state[i].norm() + if i == 0 { state[1].norm() } else { 0.0 };
        (fine[i] - coarse[i]).norm() <= TOLERANCE * size
    })
}

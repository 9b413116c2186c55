//! Whether gaps are those of points thrown on a line independently.

/// Kuiper's statistic exceeds this about once in a thousand times (N. H. Kuiper, *Tests concerning random points on a circle*, 1960).
const KUIPER: f64 = 2.2;
/// Rank correlation of consecutive gaps, in units of its deviation 1/√n, that is as rare.
const CORRELATION: f64 = -3.0;

/// Gaps between independent points are independent and exponential, so that g/(g + h) is uniform on [0, 1] for any two of them,
/// and no long gap makes the next one short. Points of a pen that comes back over its own line are not so, unless each pass
/// was thrown independently too: even passes that fall between each other have gaps that make up for each other, and
/// stretches of even gaps have far too many equal ones.
///
/// Tested on gaps that are one and two apart, by Kuiper's statistic, and by the rank correlation of consecutive gaps: independent
/// gaps fail about once in 300 times. Fewer than ten gaps tell nothing and fail. Around a loop the last gap is followed by the
/// first, so that it does not matter where the loop is said to start.
pub(crate) fn look_independent(gaps: &[f64], closed: bool) -> bool {
    gaps.len() >= 10
        && [1, 2].iter().all(|&lag| kuiper(gaps, lag, closed) < KUIPER)
        && rank_correlation(gaps, closed) > CORRELATION
}

/// Every element with the one `lag` places on.
fn pairs(of: &[f64], lag: usize, closed: bool) -> impl Iterator<Item = (f64, f64)> {
    let count = if closed { of.len() } else { of.len() - lag };
    of.iter().zip(of[lag..].iter().chain(of)).take(count).map(|(&a, &b)| (a, b))
}

/// √n·(D⁺ + D⁻) of the shares g/(g + h) against the uniform distribution.
fn kuiper(gaps: &[f64], lag: usize, closed: bool) -> f64 {
    let mut shares: Vec<f64> = pairs(gaps, lag, closed).map(|(g, h)| g / (g + h)).collect();
    shares.sort_by(f64::total_cmp);
    let n = shares.len() as f64;
    let above = shares.iter().zip(1..).map(|(share, k)| f64::from(k) / n - share).fold(0.0, f64::max);
    let below = shares.iter().zip(0..).map(|(share, k)| share - f64::from(k) / n).fold(0.0, f64::max);
    n.sqrt() * (above + below)
}

/// Correlation of the ranks of consecutive gaps, times √n.
fn rank_correlation(gaps: &[f64], closed: bool) -> f64 {
    let n = gaps.len();
    let mut by_length: Vec<usize> = (0..n).collect();
    by_length.sort_by(|&a, &b| gaps[a].total_cmp(&gaps[b]));
    let mut ranks = vec![0.0; n];
    for (rank, &k) in by_length.iter().enumerate() {
        ranks[k] = rank as f64 - 0.5 * (n - 1) as f64;
    }
    let sum: f64 = pairs(&ranks, 1, closed).map(|(a, b)| a * b).sum();
    let square: f64 = ranks.iter().map(|a| a * a).sum();
    sum / square * (n as f64).sqrt()
}

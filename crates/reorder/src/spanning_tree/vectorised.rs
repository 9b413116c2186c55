//! The widest vector instructions that the processor at hand has.

use super::kd_tree::LANES;

/// Work that is written once and compiled for every instruction set.
pub(super) trait Task {
    type Output;
    /// To be inlined, with all that it calls in its loops: neither functions nor closures that others call, as `map` does, are
    /// compiled for more than the baseline, where a fused operation is a call of a library. `FUSED`: multiply and add round once.
    fn run<const FUSED: bool>(self) -> Self::Output;
}

#[cfg(test)]
thread_local! {
    /// Whether this thread does without vector instructions, as other processors must.
    pub(super) static PLAIN: std::cell::Cell<bool> = const { std::cell::Cell::new(false) };
}

/// Runs the task with AVX-512, or AVX2 and FMA, where there are such; both round alike.
#[cfg(target_arch = "x86_64")]
#[expect(unsafe_code, reason = "the compiler cannot see that the processor was asked")]
pub(super) fn run<T: Task>(task: T) -> T::Output {
    #[target_feature(enable = "avx2,fma")]
    fn wide<T: Task>(task: T) -> T::Output {
        task.run::<true>()
    }
    #[target_feature(enable = "avx512f,avx512dq,avx512vl,fma")]
    fn widest<T: Task>(task: T) -> T::Output {
        task.run::<true>()
    }
    #[cfg(test)]
    if PLAIN.get() {
        return task.run::<false>();
    }
    let fused = std::is_x86_feature_detected!("avx2") && std::is_x86_feature_detected!("fma");
    let masked = std::is_x86_feature_detected!("avx512f")
        && std::is_x86_feature_detected!("avx512dq")
        && std::is_x86_feature_detected!("avx512vl");
    if fused && masked {
        // SAFETY: the processor has just said that it has these features, and they are all that `widest` asks for.
        unsafe { widest(task) }
    } else if fused {
        // SAFETY: as above, for `wide`.
        unsafe { wide(task) }
    } else {
        task.run::<false>()
    }
}

/// Runs the task. AArch64 has its vectors and fused operations in the baseline.
#[cfg(not(target_arch = "x86_64"))]
pub(super) fn run<T: Task>(task: T) -> T::Output {
    task.run::<{ cfg!(target_arch = "aarch64") }>()
}

/// x² + sum.
#[inline(always)]
pub(super) fn add_square<const FUSED: bool>(sum: f64, x: f64) -> f64 {
    multiply_add::<FUSED>(x, x, sum)
}

/// The greater of two numbers in one instruction: `f64::max` takes three, to be right about NaN.
#[inline(always)]
pub(super) fn greater(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The lesser of two numbers.
#[inline(always)]
pub(super) fn lesser(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// a·b + c.
#[inline(always)]
pub(super) fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

/// Bit k: `values[k]` is at most `limit`.
#[inline(always)]
pub(super) fn at_most<const FUSED: bool>(values: &[f64; LANES], limit: f64) -> u32 {
    #[cfg(target_arch = "x86_64")]
    #[expect(unsafe_code, reason = "the compiler cannot see that the processor was asked")]
    if FUSED {
        // SAFETY: `run` fuses only where the processor has AVX2.
        return unsafe { at_most_avx(values, limit) };
    }
    (0..LANES).fold(0, |mask, k| mask | u32::from(values[k] <= limit) << k)
}

/// The plain loop makes the compiler split the arithmetic that leads there into vectors of odd lengths.
#[cfg(target_arch = "x86_64")]
#[target_feature(enable = "avx2")]
#[inline]
fn at_most_avx(values: &[f64; LANES], limit: f64) -> u32 {
    use std::arch::x86_64::{_CMP_LE_OQ, _mm256_cmp_pd, _mm256_movemask_pd, _mm256_set1_pd, _mm256_setr_pd};
    let mut mask = 0;
    for k in [0, 4, 8, 12] {
        let four = _mm256_setr_pd(values[k], values[k + 1], values[k + 2], values[k + 3]);
        mask |= _mm256_movemask_pd(_mm256_cmp_pd::<_CMP_LE_OQ>(four, _mm256_set1_pd(limit))) << k;
    }
    mask as u32
}

//! The widest vector instructions that the processor at hand has.

/// Work that is written once and compiled for every instruction set.
pub(super) trait Task {
    type Output;
    /// To be inlined, with all that it calls in its loops: neither functions nor closures that others call, as `map` does, are
    /// compiled for more than the baseline, where a fused operation is a call of a library. `FUSED`: multiply and add round once.
    fn run<const FUSED: bool>(self) -> Self::Output;
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

/// a·b + c.
#[inline(always)]
pub(super) fn multiply_add<const FUSED: bool>(a: f64, b: f64, c: f64) -> f64 {
    if FUSED { a.mul_add(b, c) } else { a * b + c }
}

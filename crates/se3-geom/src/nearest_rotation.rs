//! The rotation nearest to a matrix.

use nalgebra::{Matrix3, Matrix4, Quaternion, UnitQuaternion};

/// A matrix that has no single nearest rotation.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum NearestRotationError {
    /// An entry is NaN or infinite.
    #[error("the entry in row {row}, column {column} (from 0) of the matrix is not a finite number")]
    NonFinite {
        /// Its row, from 0.
        row: usize,
        /// Its column, from 0.
        column: usize,
    },
    /// Several rotations are equally near.
    #[error(
        "several rotations are equally near to the matrix: σ₂ ± σ₃ = {gap:e} is rounding beside σ₁ + σ₂ + σ₃ = {size:e}"
    )]
    NotUnique {
        /// σ₂ + sign(det)·σ₃ of the singular values σ₁ ≥ σ₂ ≥ σ₃.
        gap: f64,
        /// σ₁ + σ₂ + sign(det)·σ₃.
        size: f64,
    },
    /// The eigenvalue iteration did not end.
    #[error("the eigenvalues of the matrix were not found within {iterations} iterations")]
    NotConverged {
        /// Iterations made.
        iterations: usize,
    },
}

/// Rounding of the sums below and of the eigenvalue solver, relative to the largest eigenvalue.
const GAP_TOLERANCE: f64 = 16.0 * f64::EPSILON;
const ITERATIONS: usize = 1000;

/// The rotation R that minimises ‖R − M‖ (Frobenius): R = U·diag(1, 1, det UVᵀ)·Vᵀ with M = UΣVᵀ (thesis appendix E, whose
/// U·Vᵀ can come out as a reflection; Markley, *J. Astronautical Sciences* 36, 1988).
///
/// Found as a quaternion: qᵀKq = tr(RᵀM) is largest for the eigenvector of Davenport's symmetric 4×4 matrix K with the largest
/// eigenvalue, σ₁ + σ₂ ± σ₃. It leads the next one by 2(σ₂ ± σ₃), with the sign of det M, which is what decides whether R is
/// unique; and it is a rotation whatever the rounding.
///
/// # Errors
/// [`NearestRotationError`] where M is not finite, or σ₂ ± σ₃ vanishes up to rounding: M of rank below two, or a reflection
/// (det M < 0) whose two smallest singular values are equal.
///
/// ```
/// use se3_geom::{nearest_rotation, nalgebra::Matrix3};
/// let drifted = Matrix3::new(0.0, -1.001, 0.0, 0.999, 0.0, 0.0, 0.0, 0.0, 1.0);
/// let rotation = nearest_rotation(&drifted)?;
/// assert!((rotation.angle() - std::f64::consts::FRAC_PI_2).abs() < 1e-15);
/// # Ok::<(), se3_geom::NearestRotationError>(())
/// ```
pub fn nearest_rotation(m: &Matrix3<f64>) -> Result<UnitQuaternion<f64>, NearestRotationError> {
    if let Some(i) = m.iter().position(|x| !x.is_finite()) {
        return Err(NearestRotationError::NonFinite { row: i % 3, column: i / 3 });
    }
    let scale = m.amax();
    if scale == 0.0 {
        return Err(NearestRotationError::NotUnique { gap: 0.0, size: 0.0 });
    }
    // Sums of four entries must not overflow; dividing entry by entry, as 1/scale can overflow too.
    let eigen = davenport(&m.map(|x| x / scale))
        .try_symmetric_eigen(f64::EPSILON, ITERATIONS)
        .ok_or(NearestRotationError::NotConverged { iterations: ITERATIONS })?;
    let largest = eigen.eigenvalues.imax();
    let second = (0..4).filter(|i| *i != largest).map(|i| eigen.eigenvalues[i]).fold(f64::NEG_INFINITY, f64::max);
    let size = eigen.eigenvalues[largest];
    let gap = 0.5 * (size - second);
    if gap <= GAP_TOLERANCE * size {
        return Err(NearestRotationError::NotUnique { gap: gap * scale, size: size * scale });
    }
    let [x, y, z, w]: [f64; 4] = eigen.eigenvectors.column(largest).into_owned().into();
    Ok(UnitQuaternion::from_quaternion(Quaternion::new(w, x, y, z)))
}

/// K with qᵀKq = tr(R(q)ᵀM) for unit q = (x, y, z, w).
fn davenport(m: &Matrix3<f64>) -> Matrix4<f64> {
    let trace = m.trace();
    let mut k = Matrix4::zeros();
    k.fixed_view_mut::<3, 3>(0, 0).copy_from(&(m + m.transpose() - Matrix3::from_diagonal_element(trace)));
    let axial = [m.m32 - m.m23, m.m13 - m.m31, m.m21 - m.m12];
    for (i, entry) in axial.into_iter().enumerate() {
        k[(i, 3)] = entry;
        k[(3, i)] = entry;
    }
    k[(3, 3)] = trace;
    k
}

//! What the law suite sees of a group: numbers and matrices.

use nalgebra::{DMatrix, Matrix1, Matrix2, Matrix3, Matrix4, Vector2, Vector3, Vector6};
use se3_geom::{
    LieGroup, PlanarTwist, Se2Group, Se3Group, Sim2Group, SimilarityTwist, So2Group, So3Group, Twist, nalgebra,
};

/// The coordinates of a group: linear part first, then the angular part, then the scale.
pub(crate) trait Coordinates: LieGroup {
    const LINEAR: usize;
    const ANGULAR: usize;
    const SCALING: usize;
    const DIMENSION: usize = Self::LINEAR + Self::ANGULAR + Self::SCALING;
    fn algebra(v: &[f64]) -> Self::Algebra;
    fn coordinates(v: Self::Algebra) -> Vec<f64>;
    fn map(m: Self::AlgebraMap) -> DMatrix<f64>;
    /// The element as a matrix that acts on (x, 1), or on x where nothing translates.
    fn matrix(a: &Self::Element) -> DMatrix<f64>;
    fn point(x: &[f64]) -> Self::Point;
    fn point_coordinates(x: Self::Point) -> Vec<f64>;

    /// The matrix of an algebra element.
    fn hat(v: &[f64]) -> DMatrix<f64> {
        let (linear, rest) = v.split_at(Self::LINEAR);
        let (angular, scaling) = rest.split_at(Self::ANGULAR);
        let n = if Self::ANGULAR == 1 { 2 } else { 3 };
        let mut hat = DMatrix::zeros(n + linear.len().min(1), n + linear.len().min(1));
        if n == 2 {
            (hat[(0, 1)], hat[(1, 0)]) = (-angular[0], angular[0]);
        } else {
            (hat[(2, 1)], hat[(1, 2)]) = (angular[0], -angular[0]);
            (hat[(0, 2)], hat[(2, 0)]) = (angular[1], -angular[1]);
            (hat[(1, 0)], hat[(0, 1)]) = (angular[2], -angular[2]);
        }
        (0..n).for_each(|i| hat[(i, i)] = scaling.iter().sum());
        linear.iter().enumerate().for_each(|(i, x)| hat[(i, n)] = *x);
        hat
    }
}

fn dynamic<const R: usize, const C: usize>(m: nalgebra::SMatrix<f64, R, C>) -> DMatrix<f64> {
    DMatrix::from_column_slice(R, C, m.as_slice())
}

impl Coordinates for So2Group {
    const LINEAR: usize = 0;
    const ANGULAR: usize = 1;
    const SCALING: usize = 0;
    fn algebra(v: &[f64]) -> f64 {
        v[0]
    }
    fn coordinates(v: f64) -> Vec<f64> {
        vec![v]
    }
    fn map(m: f64) -> DMatrix<f64> {
        dynamic(Matrix1::new(m))
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(Matrix2::new(a.re, -a.im, a.im, a.re))
    }
    fn point(x: &[f64]) -> Vector2<f64> {
        Vector2::from_column_slice(&x[..2])
    }
    fn point_coordinates(x: Vector2<f64>) -> Vec<f64> {
        x.as_slice().to_vec()
    }
}

impl Coordinates for So3Group {
    const LINEAR: usize = 0;
    const ANGULAR: usize = 3;
    const SCALING: usize = 0;
    fn algebra(v: &[f64]) -> Vector3<f64> {
        Vector3::from_column_slice(v)
    }
    fn coordinates(v: Vector3<f64>) -> Vec<f64> {
        v.as_slice().to_vec()
    }
    fn map(m: Matrix3<f64>) -> DMatrix<f64> {
        dynamic(m)
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(a.to_rotation_matrix().into_inner())
    }
    fn point(x: &[f64]) -> Vector3<f64> {
        Vector3::from_column_slice(x)
    }
    fn point_coordinates(x: Vector3<f64>) -> Vec<f64> {
        x.as_slice().to_vec()
    }
}

impl Coordinates for Se2Group {
    const LINEAR: usize = 2;
    const ANGULAR: usize = 1;
    const SCALING: usize = 0;
    fn algebra(v: &[f64]) -> PlanarTwist {
        PlanarTwist::from_vector(&Vector3::from_column_slice(v))
    }
    fn coordinates(v: PlanarTwist) -> Vec<f64> {
        v.to_vector().as_slice().to_vec()
    }
    fn map(m: Matrix3<f64>) -> DMatrix<f64> {
        dynamic(m)
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(a.to_homogeneous())
    }
    fn point(x: &[f64]) -> Vector2<f64> {
        Vector2::from_column_slice(&x[..2])
    }
    fn point_coordinates(x: Vector2<f64>) -> Vec<f64> {
        vec![x.x, x.y, 1.0]
    }
}

impl Coordinates for Se3Group {
    const LINEAR: usize = 3;
    const ANGULAR: usize = 3;
    const SCALING: usize = 0;
    fn algebra(v: &[f64]) -> Twist {
        Twist::from_vector(&Vector6::from_column_slice(v))
    }
    fn coordinates(v: Twist) -> Vec<f64> {
        v.to_vector().as_slice().to_vec()
    }
    fn map(m: nalgebra::Matrix6<f64>) -> DMatrix<f64> {
        dynamic(m)
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(a.to_homogeneous())
    }
    fn point(x: &[f64]) -> Vector3<f64> {
        Vector3::from_column_slice(x)
    }
    fn point_coordinates(x: Vector3<f64>) -> Vec<f64> {
        vec![x.x, x.y, x.z, 1.0]
    }
}

impl Coordinates for Sim2Group {
    const LINEAR: usize = 2;
    const ANGULAR: usize = 1;
    const SCALING: usize = 1;
    fn algebra(v: &[f64]) -> SimilarityTwist {
        SimilarityTwist::from_vector(&nalgebra::Vector4::from_column_slice(v))
    }
    fn coordinates(v: SimilarityTwist) -> Vec<f64> {
        v.to_vector().as_slice().to_vec()
    }
    fn map(m: Matrix4<f64>) -> DMatrix<f64> {
        dynamic(m)
    }
    fn matrix(a: &Self::Element) -> DMatrix<f64> {
        dynamic(a.to_homogeneous())
    }
    fn point(x: &[f64]) -> Vector2<f64> {
        Vector2::from_column_slice(&x[..2])
    }
    fn point_coordinates(x: Vector2<f64>) -> Vec<f64> {
        vec![x.x, x.y, 1.0]
    }
}

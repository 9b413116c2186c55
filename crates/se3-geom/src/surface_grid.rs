//! Surfaces given by heights on a grid.

use nalgebra::{Vector2, Vector3};

/// Heights that are no surface.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum SurfaceGridError {
    /// Less than one cell.
    #[error("a surface needs at least 2 x 2 nodes, {columns} x {rows} given")]
    TooFewNodes {
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
    },
    /// The heights do not fill the grid.
    #[error("{columns} x {rows} nodes need as many heights, {given} given")]
    HeightCount {
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
        /// How many heights there are.
        given: usize,
    },
    /// The nodes do not fit into memory.
    #[error("{columns} x {rows} nodes are more heights than memory holds")]
    TooManyNodes {
        /// Nodes along x.
        columns: usize,
        /// Nodes along y.
        rows: usize,
    },
    /// The corners do not span a rectangle.
    #[error("the corners ({x0}, {y0}) and ({x1}, {y1}) do not span a finite rectangle: x and y must both increase")]
    Corners {
        /// x of the first corner.
        x0: f64,
        /// y of the first corner.
        y0: f64,
        /// x of the opposite corner.
        x1: f64,
        /// y of the opposite corner.
        y1: f64,
    },
}

/// The surface z = h(x, y) over a rectangle, by its heights at the nodes of a regular grid; bilinear between them.
///
/// A height that is not finite makes a hole: the cells around that node are no part of the surface.
///
/// Inside the crate places are *grid coordinates*: the node in column i and row j lies at (i, j), so that a place is on a grid
/// line exactly if a coordinate is whole.
#[derive(Debug, Clone, PartialEq)]
pub struct SurfaceGrid {
    corner: Vector2<f64>,
    spacing: Vector2<f64>,
    columns: usize,
    rows: usize,
    heights: Vec<f64>,
}

impl SurfaceGrid {
    /// The grid over the rectangle between two corners with `columns` nodes along x and `rows` along y, boundary included.
    /// Heights come row by row, those of y = `corner.y` first.
    ///
    /// # Errors
    /// [`SurfaceGridError`] for fewer than 2 × 2 nodes, another number of heights, and corners that span no rectangle.
    pub fn new(
        corner: Vector2<f64>,
        opposite: Vector2<f64>,
        [columns, rows]: [usize; 2],
        heights: Vec<f64>,
    ) -> Result<Self, SurfaceGridError> {
        let spacing = spacing(corner, opposite, [columns, rows])?;
        if columns.checked_mul(rows) != Some(heights.len()) {
            return Err(SurfaceGridError::HeightCount { columns, rows, given: heights.len() });
        }
        Ok(Self { corner, spacing, columns, rows, heights })
    }

    /// The same grid with heights taken from a function, such as `|x, y| patch.embed(&Vector2::new(x, y)).z` of a
    /// [`MongePatch`](crate::MongePatch).
    ///
    /// # Errors
    /// Those of [`SurfaceGrid::new`], and [`SurfaceGridError::TooManyNodes`] where memory for the heights, 8 bytes each, is refused.
    pub fn sample(
        corner: Vector2<f64>,
        opposite: Vector2<f64>,
        [columns, rows]: [usize; 2],
        height: impl Fn(f64, f64) -> f64,
    ) -> Result<Self, SurfaceGridError> {
        let spacing = spacing(corner, opposite, [columns, rows])?;
        let mut heights = Vec::new();
        let count = columns.checked_mul(rows).filter(|&count| heights.try_reserve_exact(count).is_ok());
        count.ok_or(SurfaceGridError::TooManyNodes { columns, rows })?;
        let mut grid = Self { corner, spacing, columns, rows, heights: Vec::new() };
        let nodes = (0..rows).flat_map(|row| (0..columns).map(move |column| [column, row]));
        heights.extend(nodes.map(|node| grid.node_place(node)).map(|place| height(place.x, place.y)));
        grid.heights = heights;
        Ok(grid)
    }

    /// Nodes along x and along y.
    pub fn nodes(&self) -> [usize; 2] {
        [self.columns, self.rows]
    }

    /// Where the node in this column and row lies in the plane.
    pub fn node_place(&self, [column, row]: [usize; 2]) -> Vector2<f64> {
        self.corner + self.spacing.component_mul(&Vector2::new(column as f64, row as f64))
    }

    /// The point (x, y, h(x, y)) of space; `None` outside the rectangle and in holes.
    pub fn embed(&self, place: &Vector2<f64>) -> Option<Vector3<f64>> {
        let place = self.to_grid(place);
        let point = self.embed_grid(&place);
        (self.cells_at(&place).next().is_some() && point.z.is_finite()).then_some(point)
    }

    /// Grid coordinates; those within 1e-9 of a whole number are taken for it, so that rounding puts no point next to a line
    /// on which it is meant to lie.
    pub(crate) fn to_grid(&self, place: &Vector2<f64>) -> Vector2<f64> {
        let coordinates = (place - self.corner).component_div(&self.spacing);
        coordinates.map(|x| if (x - x.round()).abs() < 1e-9 { x.round() } else { x })
    }

    pub(crate) fn to_plane(&self, place: &Vector2<f64>) -> Vector2<f64> {
        self.corner + self.spacing.component_mul(place)
    }

    pub(crate) fn node_index(&self, [column, row]: [usize; 2]) -> usize {
        row * self.columns + column
    }

    pub(crate) fn embed_node(&self, node: [usize; 2]) -> Vector3<f64> {
        let place = self.node_place(node);
        Vector3::new(place.x, place.y, self.heights[self.node_index(node)])
    }

    /// The point of space of a place inside the rectangle.
    pub(crate) fn embed_grid(&self, place: &Vector2<f64>) -> Vector3<f64> {
        let within = |coordinate: f64, nodes: usize| (coordinate.max(0.0) as usize).min(nodes - 2);
        let cell = [within(place.x, self.columns), within(place.y, self.rows)];
        let (across, up) = (place.x - cell[0] as f64, place.y - cell[1] as f64);
        // A corner of weight zero counts for nothing, even where it is a hole.
        let weights = [(1.0 - across) * (1.0 - up), across * (1.0 - up), across * up, (1.0 - across) * up];
        let parts = corners(cell).into_iter().zip(weights).filter(|(_, weight)| *weight != 0.0);
        let height = parts.map(|(node, weight)| weight * self.heights[self.node_index(node)]).sum();
        let plane = self.to_plane(place);
        Vector3::new(plane.x, plane.y, height)
    }

    /// The cells of the surface, by their lowest node, that a place touches: one inside a cell, two on an edge, four at a node.
    pub(crate) fn cells_at(&self, place: &Vector2<f64>) -> impl Iterator<Item = [usize; 2]> + '_ {
        let [across, up] = [touched(place.x, self.columns), touched(place.y, self.rows)];
        let cells = up.into_iter().flatten().flat_map(move |row| across.into_iter().flatten().map(move |c| [c, row]));
        cells.filter(|&cell| corners(cell).iter().all(|&node| self.heights[self.node_index(node)].is_finite()))
    }
}

/// How far nodes are apart along x and along y.
fn spacing(
    corner: Vector2<f64>,
    opposite: Vector2<f64>,
    [columns, rows]: [usize; 2],
) -> Result<Vector2<f64>, SurfaceGridError> {
    if columns < 2 || rows < 2 {
        return Err(SurfaceGridError::TooFewNodes { columns, rows });
    }
    let spacing = (opposite - corner).component_div(&Vector2::new((columns - 1) as f64, (rows - 1) as f64));
    if !spacing.iter().all(|s| s.is_finite() && *s > 0.0) {
        let [x0, y0, x1, y1] = [corner.x, corner.y, opposite.x, opposite.y];
        return Err(SurfaceGridError::Corners { x0, y0, x1, y1 });
    }
    Ok(spacing)
}

/// The nodes of a cell, counter-clockwise from the lowest.
pub(crate) fn corners([column, row]: [usize; 2]) -> [[usize; 2]; 4] {
    [[column, row], [column + 1, row], [column + 1, row + 1], [column, row + 1]]
}

/// The intervals between `nodes` whole numbers that a coordinate touches.
fn touched(coordinate: f64, nodes: usize) -> [Option<usize>; 2] {
    if !(0.0..=(nodes - 1) as f64).contains(&coordinate) {
        return [None; 2];
    }
    let floor = coordinate as usize;
    let before = if coordinate == floor as f64 { floor.checked_sub(1) } else { None };
    [before, (floor + 1 < nodes).then_some(floor)]
}

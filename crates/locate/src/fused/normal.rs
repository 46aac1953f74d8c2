//! The normal equations of one fit: two unknowns (the place), four edges, and a turn looked at on the side.

use super::edges::{EDGES, Edges};
use nalgebra::{Matrix2, Matrix4, Matrix4x2, Vector2};

/// Everything the edges say about the place, in the form that an edge is easily taken out of.
#[derive(Clone, Copy, Debug)]
pub(super) struct Normal {
    information: Matrix2<f64>,
    /// Slope of the cost at the place the outline was taken at, halved and downhill.
    pull: Vector2<f64>,
    cost: f64,
    /// How the turn goes with the place, its own pull, and how much is known of it.
    turn_by_place: Vector2<f64>,
    turn_pull: f64,
    turn_information: f64,
    /// The same per edge: rows of `precision * by_place`, `precision * residual`, `precision * turn`.
    edges: [(Vector2<f64>, f64, f64); EDGES],
}

/// A solved fit.
#[derive(Clone, Copy, Debug)]
pub(super) struct Solved {
    /// To the best place, in the axes of the place's slopes.
    pub(super) step: Vector2<f64>,
    pub(super) covariance: Matrix2<f64>,
    /// Of the covariance.
    pub(super) determinant: f64,
    /// Weighted squared residuals that are left.
    pub(super) cost: f64,
    /// Mean and variance of the turn, in its standard deviations.
    pub(super) turn: f64,
    pub(super) turn_variance: f64,
}

impl Normal {
    /// From the precision of the edges; their slopes by the place, their residuals, and what a standard
    /// deviation of the turn does to them; and the place where the search began with its precision.
    #[inline(always)]
    pub(super) fn new(
        precision: &Matrix4<f64>,
        (by_place, residual, turn): (&Matrix4x2<f64>, &Edges, &Edges),
        (from_start, start_precision): (Vector2<f64>, f64),
    ) -> Self {
        let weighted = precision * by_place;
        let pulled = precision * residual;
        let turned = precision * turn;
        let edge = |at: usize| {
            let by = Vector2::new(weighted[(at, 0)], weighted[(at, 1)]);
            (by, pulled[at], turned[at])
        };
        Self {
            information: by_place.tr_mul(&weighted) + Matrix2::identity() * start_precision,
            pull: by_place.tr_mul(&pulled) + from_start * start_precision,
            cost: residual.dot(&pulled) + from_start.norm_squared() * start_precision,
            turn_by_place: by_place.tr_mul(&turned),
            turn_pull: turn.dot(&pulled),
            turn_information: turn.dot(&turned),
            edges: std::array::from_fn(edge),
        }
    }

    /// Without an edge, whose own element of the precision is given: the others' marginal, a downdate of rank
    /// one.
    #[inline(always)]
    pub(super) fn without(&self, edge: usize, own_precision: f64) -> Self {
        let (by, pulled, turned) = self.edges[edge];
        let share = own_precision.recip();
        Self {
            information: self.information - by * by.transpose() * share,
            pull: self.pull - by * (pulled * share),
            cost: self.cost - pulled * pulled * share,
            turn_by_place: self.turn_by_place - by * (turned * share),
            turn_pull: self.turn_pull - turned * pulled * share,
            turn_information: self.turn_information - turned * turned * share,
            edges: self.edges,
        }
    }

    /// Mean and variance of a cause that is part of the covariance, in its standard deviations, given what one
    /// of them does to the edges.
    #[inline(always)]
    pub(super) fn of_cause(
        &self,
        precision: &Matrix4<f64>,
        (by_place, residual): (&Matrix4x2<f64>, &Edges),
        cause: &Edges,
    ) -> (f64, f64) {
        let weighted = precision * cause;
        let with_place = by_place.tr_mul(&weighted);
        let [[a, b], [_, d]] = self.information.data.0;
        let covariance = Matrix2::new(d, -b, -b, a) / (a * d - b * b);
        let mean = weighted.dot(residual) - with_place.dot(&(covariance * self.pull));
        let known = with_place.dot(&(covariance * with_place));
        (mean, 1.0 - weighted.dot(cause) + known)
    }

    #[inline(always)]
    pub(super) fn solve(&self) -> Solved {
        let [[a, b], [_, d]] = self.information.data.0;
        let determinant = (a * d - b * b).recip();
        let covariance = Matrix2::new(d, -b, -b, a) * determinant;
        let step = covariance * self.pull;
        let known = self.turn_by_place.dot(&(covariance * self.turn_by_place));
        Solved {
            step,
            covariance,
            determinant,
            cost: self.cost - self.pull.dot(&step),
            turn: self.turn_pull - self.turn_by_place.dot(&step),
            turn_variance: 1.0 - self.turn_information + known,
        }
    }
}

/// Of a symmetric positive definite matrix, by blocks of two.
#[inline(always)]
pub(super) fn inverse_and_determinant(matrix: &Matrix4<f64>) -> (Matrix4<f64>, f64) {
    let block = |row: usize, column: usize| matrix.fixed_view::<2, 2>(row, column).into_owned();
    let (upper, beside, lower) = (block(0, 0), block(0, 2), block(2, 2));
    let (upper_inverse, upper_determinant) = inverse_of_two(&upper);
    let carried = upper_inverse * beside;
    let (rest_inverse, rest_determinant) = inverse_of_two(&(lower - beside.tr_mul(&carried)));
    let corner = carried * rest_inverse;
    let mut inverse = Matrix4::zeros();
    let mut set = |row: usize, column: usize, block: Matrix2<f64>| {
        inverse
            .fixed_view_mut::<2, 2>(row, column)
            .copy_from(&block);
    };
    set(0, 0, upper_inverse + corner * carried.transpose());
    set(0, 2, -corner);
    set(2, 0, -corner.transpose());
    set(2, 2, rest_inverse);
    (inverse, upper_determinant * rest_determinant)
}

#[inline(always)]
fn inverse_of_two(matrix: &Matrix2<f64>) -> (Matrix2<f64>, f64) {
    let [[a, b], [c, d]] = matrix.data.0;
    let determinant = a * d - b * c;
    (Matrix2::new(d, -c, -b, a) / determinant, determinant)
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn numbers<const N: usize>() -> impl Strategy<Value = [f64; N]> {
        prop::array::uniform(-2.0..2.0_f64)
    }

    fn positive(factor: [f64; 16]) -> Matrix4<f64> {
        let factor = Matrix4::from_row_slice(&factor);
        factor * factor.transpose() + Matrix4::identity() * 0.1
    }

    proptest! {
        #[test]
        fn blocks_give_the_inverse(factor in numbers::<16>()) {
            let matrix = positive(factor);
            let (inverse, determinant) = inverse_and_determinant(&matrix);
            prop_assert!((matrix * inverse - Matrix4::identity()).norm() < 1e-8);
            prop_assert!((determinant / matrix.determinant() - 1.0).abs() < 1e-8);
        }

        #[test]
        fn without_an_edge_the_place_is_that_of_the_other_three(
            factor in numbers::<16>(), slopes in numbers::<8>(), residual in numbers::<4>(),
            turn in numbers::<4>(), edge in 0..EDGES,
        ) {
            let covariance = positive(factor);
            let by_place = Matrix4x2::from_row_slice(&slopes);
            let (residual, turn) = (Edges::from(residual), Edges::from(turn) * 0.1);
            let start = (Vector2::new(0.1, -0.2), 0.5);
            let (precision, _) = inverse_and_determinant(&covariance);
            let all = Normal::new(&precision, (&by_place, &residual, &turn), start);
            let three = all.without(edge, precision[(edge, edge)]).solve();
            // The same with an edge of which nothing is known.
            let mut blind = covariance;
            blind[(edge, edge)] += 1e7;
            let (precision, _) = inverse_and_determinant(&blind);
            let other = Normal::new(&precision, (&by_place, &residual, &turn), start).solve();
            prop_assert!((three.step - other.step).norm() < 1e-4);
            prop_assert!((three.covariance - other.covariance).norm() < 1e-4);
            prop_assert!((three.cost - other.cost).abs() < 1e-4);
            prop_assert!((three.turn - other.turn).abs() < 1e-4);
            prop_assert!((three.turn_variance - other.turn_variance).abs() < 1e-4);
        }
    }
}

//! Which numbers of a row the forest sees.

use crate::row::Row;
use std::fmt;

/// In place of the column of a component that was not found: left of everything.
const MISSING: f64 = -1.0;

/// A choice of features.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Recipe {
    /// The paper's: horizontal centres of tyres, mirrors and plates, of each kind from left to right, whichever
    /// they are.
    Paper,
    /// Every component by its name, column and score; the box's aspect; the direction the model sees at once.
    Roadwatch,
}

/// Kinds of the paper's recipe, by the beginning of their names, and how many of each one side of a car shows.
const PAPER_KINDS: [(&str, usize); 3] = [("tyre", 4), ("mirror", 2), ("plate", 2)];

impl Recipe {
    /// Both, in the order of their numbers in files.
    pub const ALL: [Self; 2] = [Self::Paper, Self::Roadwatch];

    /// The name in commands and files.
    #[must_use]
    pub const fn as_str(self) -> &'static str {
        match self {
            Self::Paper => "paper",
            Self::Roadwatch => "roadwatch",
        }
    }

    /// The recipe of that name.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        Self::ALL.into_iter().find(|recipe| recipe.as_str() == name)
    }

    /// The features of a row, whose components have these names; always as many.
    pub fn features(self, row: &Row, names: &[String], features: &mut Vec<f64>) {
        features.clear();
        match self {
            Self::Paper => {
                for (kind, most) in PAPER_KINDS {
                    let start = features.len();
                    let of_kind = row.components.iter().zip(names);
                    let of_kind = of_kind.filter(|(_, name)| name.starts_with(kind));
                    features.extend(of_kind.filter_map(|((column, _), _)| *column));
                    features[start..].sort_by(f64::total_cmp);
                    features.resize(start + most, MISSING);
                }
            }
            Self::Roadwatch => {
                let columns = row.components.iter();
                features.extend(columns.map(|(column, _)| column.unwrap_or(MISSING)));
                features.extend(row.components.iter().map(|(_, score)| f64::from(*score)));
                let (cos, sin) = row.facing_mean();
                features.extend([row.aspect, cos, sin]);
            }
        }
    }
}

impl fmt::Display for Recipe {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.as_str())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_papers_recipe_sorts_each_kind_and_knows_no_front() {
        let names = [
            "tyre_a",
            "tyre_b",
            "plate_front",
            "plate_rear",
            "headlamp_left",
        ];
        let names = names.map(str::to_owned);
        let seen = |columns: [Option<f64>; 5]| Row {
            aspect: 1.0,
            components: columns.map(|column| (column, 0.5)).to_vec(),
            facing: Vec::new(),
        };
        let mut features = Vec::new();
        let first = seen([Some(0.9), Some(0.1), Some(0.5), None, Some(0.3)]);
        Recipe::Paper.features(&first, &names, &mut features);
        assert_eq!(features, [0.1, 0.9, -1.0, -1.0, -1.0, -1.0, 0.5, -1.0]);
        let turned = seen([Some(0.1), Some(0.9), None, Some(0.5), None]);
        let before = features.clone();
        Recipe::Paper.features(&turned, &names, &mut features);
        assert_eq!(features, before);
    }
}

//! All samples of an evaluation, and how they are taken apart.

use crate::{
    grouping::Grouping,
    sample::{Estimator, Sample, Target},
    score::Figures,
};
use std::{
    collections::{BTreeMap, BTreeSet},
    sync::Arc,
};

/// Every object that is scored, and every estimator's answer for each that was found.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SampleTable {
    /// The objects, found or not, one per image.
    pub targets: Vec<Arc<Target>>,
    /// The answers.
    pub samples: Vec<Sample>,
}

/// A part of the table.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Its name, such as `10-20`.
    pub name: String,
    /// Objects that are scored.
    pub objects: usize,
    /// Those of them that were found.
    pub found: usize,
    /// Figures of each estimator.
    pub figures: BTreeMap<Estimator, Figures>,
}

impl SampleTable {
    /// The estimators with samples, what was published first.
    #[must_use]
    pub fn estimators(&self) -> BTreeSet<Estimator> {
        let samples = self.samples.iter();
        samples.map(|sample| sample.estimator).collect()
    }

    /// One estimator's samples.
    pub fn of(&self, estimator: Estimator) -> impl Iterator<Item = &Sample> {
        let samples = self.samples.iter();
        samples.filter(move |sample| sample.estimator == estimator)
    }

    /// The groups that have objects, in order.
    #[must_use]
    pub fn groups(&self, grouping: Grouping) -> Vec<Group> {
        let in_order = self.targets.iter().map(|target| grouping.group(target));
        let in_order: BTreeSet<(usize, String)> = in_order.collect();
        in_order
            .into_iter()
            .map(|group| self.group(grouping, group))
            .collect()
    }

    fn group(&self, grouping: Grouping, group: (usize, String)) -> Group {
        let belongs = |target: &Arc<Target>| grouping.group(target) == group;
        let objects: Vec<_> = self
            .targets
            .iter()
            .filter(|target| belongs(target))
            .collect();
        let of = |estimator| {
            let samples = self.of(estimator);
            Figures::of(samples.filter(|sample| belongs(&sample.target)))
        };
        let estimators = self.estimators().into_iter();
        Group {
            objects: objects.len(),
            found: objects.iter().filter(|target| target.found).count(),
            figures: estimators
                .map(|estimator| (estimator, of(estimator)))
                .collect(),
            name: group.1,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::made::{sample, table};

    #[test]
    fn groups_come_in_order_and_hold_every_sample_once() {
        let samples: Vec<_> = [62.0, 5.0, 15.0, 12.0]
            .map(|range_m| sample(range_m + 1.0, range_m))
            .into();
        let groups = table(samples).groups(Grouping::Distance);
        let counted = groups.iter().map(|group| {
            let n = group.figures[&Estimator::Published].distance.n;
            (group.name.as_str(), group.objects, n)
        });
        let expected = [("0-10", 1, 1), ("10-20", 2, 2), ("60+", 1, 1)];
        assert_eq!(counted.collect::<Vec<_>>(), expected);
    }
}

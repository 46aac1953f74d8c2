//! How large things really are, per class, with a spread.

use roadwatch_core::{ObjectClass, SizeLwh};
use std::collections::BTreeMap;

/// Which published size of a car category is meant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SizeStatistic {
    /// The category's greatest dimensions (Table 1), which the paper prefers: accuracy declines more
    /// gently when a size is overestimated.
    #[default]
    Maximum,
    /// The average of all cars (Table 2), whatever the category.
    Average,
}

/// The paper's car categories.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum CarCategory {
    /// No category is known, as with COCO's one class `car`: Table 2, 5.1 x 1.9 x 1.5 m.
    #[default]
    Average,
    /// 4.2 x 1.8 x 1.5 m.
    Compact,
    /// 4.8 x 1.8 x 1.7 m.
    Midsize,
    /// 5.4 x 1.8 x 1.4 m.
    FullSize,
    /// 5.0 x 1.9 x 1.2 m.
    Sports,
    /// SUV and crossover, 5.1 x 2.1 x 1.6 m.
    Suv,
    /// 6.0 x 2.0 x 1.8 m.
    Pickup,
    /// 5.4 x 2.1 x 1.8 m.
    Minivan,
    /// 5.4 x 1.8 x 1.4 m.
    Luxury,
    /// 4.8 x 1.8 x 1.6 m.
    StationWagon,
}

impl CarCategory {
    /// Every category with its name in configuration.
    pub const ALL: [(&'static str, Self); 10] = [
        ("average", Self::Average),
        ("compact", Self::Compact),
        ("midsize", Self::Midsize),
        ("full_size", Self::FullSize),
        ("sports", Self::Sports),
        ("suv", Self::Suv),
        ("pickup", Self::Pickup),
        ("minivan", Self::Minivan),
        ("luxury", Self::Luxury),
        ("station_wagon", Self::StationWagon),
    ];

    /// The category of that name, `None` when there is none.
    #[must_use]
    pub fn from_name(name: &str) -> Option<Self> {
        let found = Self::ALL.into_iter().find(|(known, _)| *known == name);
        found.map(|(_, category)| category)
    }

    /// Length, width and height, metres (Tables 1 and 2).
    #[must_use]
    pub const fn size(self, statistic: SizeStatistic) -> SizeLwh {
        match (statistic, self) {
            (SizeStatistic::Average, _) | (_, Self::Average) => lwh(5.1, 1.9, 1.5),
            (_, Self::Compact) => lwh(4.2, 1.8, 1.5),
            (_, Self::Midsize) => lwh(4.8, 1.8, 1.7),
            (_, Self::FullSize | Self::Luxury) => lwh(5.4, 1.8, 1.4),
            (_, Self::Sports) => lwh(5.0, 1.9, 1.2),
            (_, Self::Suv) => lwh(5.1, 2.1, 1.6),
            (_, Self::Pickup) => lwh(6.0, 2.0, 1.8),
            (_, Self::Minivan) => lwh(5.4, 2.1, 1.8),
            (_, Self::StationWagon) => lwh(4.8, 1.8, 1.6),
        }
    }
}

/// What the bottom of an object's box means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// It stands on the ground.
    OnGround,
    /// It hangs or stands on a post, so the ground says nothing about it.
    Raised,
}

/// The size of a class.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ClassSize {
    /// Length, width and height, metres.
    pub size: SizeLwh,
    /// Standard deviation of each, metres.
    pub std_dev: SizeLwh,
    /// Where its lower edge is.
    pub standing: Standing,
}

const fn lwh(length_m: f64, width_m: f64, height_m: f64) -> SizeLwh {
    SizeLwh {
        length_m,
        width_m,
        height_m,
    }
}

const fn on_ground(size: SizeLwh, std_dev: SizeLwh) -> ClassSize {
    ClassSize {
        size,
        std_dev,
        standing: Standing::OnGround,
    }
}

const fn raised(size: SizeLwh, std_dev: SizeLwh) -> ClassSize {
    ClassSize {
        size,
        std_dev,
        standing: Standing::Raised,
    }
}

const CAR: &str = "car";
/// Scatter of the nine categories of Table 1 about their mean: nobody told which category it is.
const CAR_STD_DEV: SizeLwh = lwh(0.51, 0.13, 0.20);

/// Cars as they are met, with nothing known but that they are cars: the mean of three published ones, rounded.
/// Labelled cars are 3.88 x 1.63 x 1.53 m in KITTI and 4.63 x 1.97 x 1.74 m in nuScenes (roof rails and mirrors
/// included), and Table 2 has 5.1 x 1.9 x 1.5 m. Length and width spread as KITTI's do; heights by 0.14 m there
/// and by 0.10 m among the simulator's cars.
const MET_CAR: ClassSize = on_ground(lwh(4.6, 1.85, 1.6), lwh(0.43, 0.10, 0.12));

/// Everything but cars.
///
/// - `person`: NCD Risk Factor Collaboration 2016, adults worldwide 1.65 m, and shoes; width and depth
///   of a walking person as KITTI's labels have them (VoxelNet's anchors, 0.8 x 0.6 m).
/// - `bicycle`, `motorcycle`, `truck`, `bus`: FGSV 287, design vehicles for swept paths (bicycle,
///   motorcycle, van, the mean of city bus and coach). COCO's `truck` is anything from a pickup to a
///   semi-trailer, hence the spread.
/// - `traffic light`: MUTCD 4D, three sections of 12-inch lenses with their visors and backs.
/// - `stop sign`: MUTCD R1-1, 30 inches (0.75 m) on ordinary roads, 36 inches on wide ones.
/// - animals: shoulder heights and lengths in Nowak, Walker's Mammals of the World (1999), with the
///   head as it is usually carried.
const OTHERS: &[(&str, ClassSize)] = &[
    (
        "person",
        on_ground(lwh(0.8, 0.6, 1.70), lwh(0.2, 0.1, 0.10)),
    ),
    (
        "bicycle",
        on_ground(lwh(1.9, 0.6, 1.0), lwh(0.15, 0.08, 0.1)),
    ),
    (
        "motorcycle",
        on_ground(lwh(2.2, 0.7, 1.0), lwh(0.2, 0.1, 0.15)),
    ),
    (
        "truck",
        on_ground(lwh(6.89, 2.17, 2.70), lwh(2.5, 0.25, 0.8)),
    ),
    ("bus", on_ground(lwh(12.0, 2.5, 3.3), lwh(2.0, 0.1, 0.35))),
    (
        "traffic light",
        raised(lwh(0.35, 0.35, 1.05), lwh(0.08, 0.08, 0.15)),
    ),
    (
        "stop sign",
        raised(lwh(0.03, 0.75, 0.75), lwh(0.01, 0.08, 0.08)),
    ),
    ("cat", on_ground(lwh(0.5, 0.2, 0.35), lwh(0.08, 0.04, 0.06))),
    ("dog", on_ground(lwh(0.8, 0.3, 0.6), lwh(0.25, 0.08, 0.2))),
    (
        "sheep",
        on_ground(lwh(1.3, 0.5, 0.95), lwh(0.2, 0.08, 0.15)),
    ),
    ("cow", on_ground(lwh(2.4, 0.7, 1.5), lwh(0.25, 0.1, 0.15))),
    (
        "horse",
        on_ground(lwh(2.4, 0.6, 2.0), lwh(0.25, 0.08, 0.25)),
    ),
    ("bear", on_ground(lwh(1.8, 0.8, 1.1), lwh(0.3, 0.15, 0.25))),
    ("zebra", on_ground(lwh(2.3, 0.6, 1.7), lwh(0.2, 0.08, 0.2))),
    (
        "elephant",
        on_ground(lwh(6.0, 2.2, 3.0), lwh(0.7, 0.3, 0.4)),
    ),
    (
        "giraffe",
        on_ground(lwh(4.0, 1.2, 5.0), lwh(0.4, 0.15, 0.5)),
    ),
];

/// The sizes in force: the built-in ones, and whatever the configuration sets.
#[derive(Clone, Debug, PartialEq)]
pub struct ClassSizes {
    sizes: BTreeMap<ObjectClass, ClassSize>,
    /// Nobody said what kind of car is met.
    any_car: bool,
}

impl ClassSizes {
    /// The built-in sizes, with cars of one category.
    #[must_use]
    pub fn new(category: CarCategory, statistic: SizeStatistic) -> Self {
        let car = on_ground(category.size(statistic), CAR_STD_DEV);
        let all = OTHERS.iter().copied().chain([(CAR, car)]);
        Self {
            sizes: all
                .map(|(name, size)| (ObjectClass::new(name), size))
                .collect(),
            any_car: category == CarCategory::Average,
        }
    }

    /// Sets the size of a class, known before or not.
    pub fn set(&mut self, class: ObjectClass, size: ClassSize) {
        self.any_car &= class.as_str() != CAR;
        self.sizes.insert(class, size);
    }

    /// Each class that stands on the ground with the size to expect of it. It differs from [`Self::get`] for
    /// cars of no stated category, whose published average is longer than the cars that are met.
    pub fn expected(&self) -> impl Iterator<Item = (&ObjectClass, &ClassSize)> {
        let on_ground = self.sizes.iter();
        let on_ground = on_ground.filter(|(_, size)| size.standing == Standing::OnGround);
        on_ground.map(|(class, size)| {
            let any_car = self.any_car && class.as_str() == CAR;
            (class, if any_car { &MET_CAR } else { size })
        })
    }

    /// The size of a class; `None` for a class whose size nobody knows, which then has no location.
    #[must_use]
    pub fn get(&self, class: &ObjectClass) -> Option<&ClassSize> {
        self.sizes.get(class)
    }
}

impl Default for ClassSizes {
    fn default() -> Self {
        Self::new(CarCategory::default(), SizeStatistic::default())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cars_of_no_known_category_are_average_whatever_the_statistic() {
        for statistic in [SizeStatistic::Maximum, SizeStatistic::Average] {
            let car = ClassSizes::new(CarCategory::Average, statistic);
            let size = car.get(&ObjectClass::new("car")).map(|class| class.size);
            assert_eq!(size, Some(lwh(5.1, 1.9, 1.5)));
        }
    }

    #[test]
    fn a_known_category_has_its_maximum_or_the_average() {
        assert_eq!(
            CarCategory::Pickup.size(SizeStatistic::Maximum),
            lwh(6.0, 2.0, 1.8)
        );
        assert_eq!(
            CarCategory::Pickup.size(SizeStatistic::Average),
            lwh(5.1, 1.9, 1.5)
        );
        assert_eq!(
            CarCategory::from_name("station_wagon"),
            Some(CarCategory::StationWagon)
        );
        assert_eq!(CarCategory::from_name("spaceship"), None);
    }

    #[test]
    fn every_size_and_every_spread_is_positive() {
        for (class, known) in &ClassSizes::default().sizes {
            for size in [known.size, known.std_dev] {
                let all = [size.length_m, size.width_m, size.height_m];
                assert!(all.iter().all(|&number| number > 0.0), "{class}");
            }
            assert!(
                known.std_dev.height_m < known.size.height_m / 2.0,
                "{class}"
            );
        }
    }

    #[test]
    fn what_the_configuration_sets_holds_and_the_unknown_has_no_size() {
        let mut sizes = ClassSizes::default();
        let kite = ObjectClass::new("kite");
        assert_eq!(sizes.get(&kite), None);
        let own = raised(lwh(1.0, 1.0, 0.1), lwh(0.1, 0.1, 0.01));
        sizes.set(kite.clone(), own);
        assert_eq!(sizes.get(&kite), Some(&own));
    }
}

//! Scenarios for identities: what may make two objects of one, or one of two.

use crate::{
    path::{Leg, Path, pose},
    rigs::six_cameras,
    scenario::{Actor, Scenario},
};
use roadwatch_core::{ObjectClass, SizeLwh};
use std::time::Duration;

const PERIOD: Duration = Duration::from_millis(100);
/// The cameras fire one after another.
const STAGGER: Duration = Duration::from_millis(12);

const BUS: SizeLwh = SizeLwh {
    length_m: 12.0,
    width_m: 2.5,
    height_m: 3.1,
};

fn around_six_cameras(ego: Path, actors: Vec<Actor>, frames: u64) -> Scenario {
    Scenario {
        rig: six_cameras(),
        ego,
        actors,
        frames,
        period: PERIOD,
        stagger: STAGGER,
        stamp_jitter: Duration::ZERO,
    }
}

fn cars(paths: Vec<Path>) -> Vec<Actor> {
    paths.into_iter().map(Actor::car).collect()
}

fn standing() -> Path {
    Path::standing(0.0, 0.0, 0.0)
}

/// Two cars cross before the standing vehicle, one from each side, on two lanes.
#[must_use]
pub fn crossing() -> Scenario {
    let paths = vec![
        Path::driving(16.0, 25.0, -90.0, 8.0),
        Path::driving(20.0, -25.0, 90.0, 7.0),
    ];
    around_six_cameras(standing(), cars(paths), 60)
}

/// One car overtakes the vehicle, from behind to far ahead, and another is overtaken.
#[must_use]
pub fn overtaking() -> Scenario {
    let paths = vec![
        Path::driving(-18.0, 3.5, 0.0, 13.0),
        Path::driving(20.0, -3.5, 0.0, 4.0),
    ];
    around_six_cameras(Path::driving(0.0, 0.0, 0.0, 8.0), cars(paths), 80)
}

/// A bus passes before a parked car and before one that drives slowly the other way.
#[must_use]
pub fn behind_a_bus() -> Scenario {
    let mut actors = cars(vec![
        Path::standing(26.0, 2.0, 0.0),
        Path::driving(24.0, -8.0, 90.0, 1.5),
    ]);
    actors.push(Actor {
        class: ObjectClass::new("bus"),
        size: BUS,
        path: Path::driving(14.0, 24.0, -90.0, 6.0),
    });
    around_six_cameras(standing(), actors, 90)
}

/// Rows of parked cars on both sides, passed at ten metres per second.
#[must_use]
pub fn parked_rows() -> Scenario {
    let places = (0..12).map(|place| {
        let (row, side) = (place / 2, if place % 2 == 0 { -6.0 } else { 6.5 });
        Path::standing(f64::from(row) * 8.0 + 6.0, side, 0.0)
    });
    around_six_cameras(
        Path::driving(0.0, 0.0, 0.0, 10.0),
        cars(places.collect()),
        60,
    )
}

/// A car ahead turns round and comes back past the vehicle.
#[must_use]
pub fn u_turn() -> Scenario {
    // Half a circle of 6 m to the left at 5 m/s.
    let legs = vec![
        Leg::straight(2.0, 5.0),
        Leg {
            secs: 6.0 * std::f64::consts::PI / 5.0,
            speed_m_s: 5.0,
            turn_rad_s: 5.0 / 6.0,
        },
        Leg::straight(10.0, 5.0),
    ];
    let turning = Path::Legs {
        start: pose(12.0, -5.0, 0.0),
        legs,
    };
    around_six_cameras(standing(), cars(vec![turning]), 110)
}

/// A car drives a circle around the standing vehicle: through the views of all six cameras.
#[must_use]
pub fn around_the_vehicle() -> Scenario {
    let circle = Path::Arc {
        start: pose(-14.0, 0.0, -90.0),
        speed_m_s: 7.0,
        turn_rad_s: 0.5,
    };
    around_six_cameras(standing(), cars(vec![circle]), 126)
}

/// The vehicle turns left by ninety degrees, between parked cars and one that comes towards it.
#[must_use]
pub fn turning() -> Scenario {
    let ego = Path::Legs {
        start: pose(0.0, 0.0, 0.0),
        legs: vec![
            Leg::straight(1.5, 6.0),
            // It ends with a frame: labels know where the vehicle is then, and go straight from one such moment to the next.
            Leg {
                secs: 3.2,
                speed_m_s: 6.0,
                turn_rad_s: std::f64::consts::FRAC_PI_2 / 3.2,
            },
            Leg::straight(3.0, 6.0),
        ],
    };
    let paths = vec![
        Path::standing(14.0, -7.0, 0.0),
        Path::standing(30.0, -5.0, 90.0),
        Path::standing(31.0, 20.0, 90.0),
        Path::standing(10.0, 24.0, -90.0),
        Path::driving(17.0, 50.0, -90.0, 7.0),
    ];
    around_six_cameras(ego, cars(paths), 75)
}

/// The car of [`around_the_vehicle`], by cameras that do not keep time.
#[must_use]
pub fn jittered() -> Scenario {
    Scenario {
        stamp_jitter: Duration::from_millis(35),
        ..around_the_vehicle()
    }
}

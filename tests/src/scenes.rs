//! Scenarios that several tests look at.

use crate::{
    path::{Path, pose},
    random::{Purpose, Random},
    rigs::{one_camera, six_cameras},
    scenario::{Actor, Scenario},
};
use nalgebra::{Isometry2, Vector2};
use roadwatch_core::{Rig, SizeLwh};
use std::time::Duration;

const PERIOD: Duration = Duration::from_millis(100);

/// `actors` around one standing camera.
#[must_use]
pub fn before_one_camera(actors: Vec<Actor>, frames: u64) -> Scenario {
    Scenario {
        rig: one_camera(),
        ego: Path::standing(0.0, 0.0, 0.0),
        actors,
        frames,
        period: PERIOD,
        stagger: Duration::ZERO,
        stamp_jitter: Duration::ZERO,
    }
}

/// How far paths are from the rows and columns of a metre's grid, which would flatter tables on that grid, metres.
const OFF_GRID_M: f64 = 0.4;

/// The paper's Y path: a car ahead of the camera from 8 to 45 m, half a metre from frame to frame.
#[must_use]
pub fn y_path(heading_deg: f64) -> Scenario {
    along(
        pose(8.85, OFF_GRID_M, heading_deg),
        Vector2::new(5.0, 0.0),
        75,
    )
}

/// The paper's X path: a car 30 m ahead from 12 m left to 12 m right, a third of a metre from frame to frame.
#[must_use]
pub fn x_path(heading_deg: f64) -> Scenario {
    along(
        pose(30.85 + OFF_GRID_M, 12.0, heading_deg),
        Vector2::new(0.0, -3.2),
        75,
    )
}

fn along(start: Isometry2<f64>, velocity_m_s: Vector2<f64>, frames: u64) -> Scenario {
    let path = Path::Line {
        start,
        velocity_m_s,
    };
    before_one_camera(vec![Actor::car(path)], frames)
}

/// One car that stands everywhere before one camera once: in each cell of a grid of `step_m`, from 6 to 48 m
/// ahead and up to 15 m aside, at `headings` headings over a whole turn, each time somewhere in the cell.
#[must_use]
pub fn everywhere(step_m: f64, headings: u32, seed: u64) -> Scenario {
    let rows = (42.0 / step_m) as u32 + 1;
    let columns = (30.0 / step_m) as u32 + 1;
    let mut poses = Vec::new();
    for cell in 0..rows * columns {
        for heading in 0..headings {
            let key = [u64::from(cell), u64::from(heading)];
            let mut random = Random::keyed(seed, Purpose::Place, &key);
            let mut within = |at: u32| (f64::from(at) + random.between(-0.5, 0.5)) * step_m;
            let ahead_m = 6.85 + within(cell / columns);
            let aside_m = -15.0 + within(cell % columns);
            let turned = f64::from(heading) + random.unit();
            poses.push(pose(ahead_m, aside_m, 360.0 * turned / f64::from(headings)));
        }
    }
    let frames = poses.len() as u64;
    let path = Path::Stations {
        poses,
        dwell: PERIOD,
    };
    before_one_camera(vec![Actor::car(path)], frames)
}

/// Five cars far enough from each other that none hides another or takes its box, before one camera.
#[must_use]
pub fn spread_cars(frames: u64) -> Scenario {
    let cars = [
        Path::driving(15.1, 4.6, 18.0, 0.5),
        Path::driving(20.3, -4.8, 166.0, -0.7),
        Path::driving(26.8, 1.4, 90.0, 0.3),
        Path::standing(34.6, -3.7, 24.0),
        Path::driving(39.8, -15.7, 150.0, 0.5),
    ];
    before_one_camera(cars.into_iter().map(Actor::car).collect(), frames)
}

/// A vehicle with six cameras in a street: traffic both ways, parked cars, a crossing bus, people, and the
/// vehicle itself in a gentle bend.
#[must_use]
pub fn street(frames: u64) -> Scenario {
    let small = SizeLwh {
        length_m: 4.2,
        width_m: 1.8,
        height_m: 1.5,
    };
    let mut actors = vec![
        Actor::car(Path::driving(18.0, 0.3, 2.0, 8.5)),
        Actor::car(Path::driving(-14.0, 0.0, 0.0, 8.0)),
        Actor::car(Path::driving(55.0, 4.0, 180.0, 9.0)),
        Actor::car_of(small, Path::driving(80.0, 4.2, 181.0, 11.0)),
        Actor::car(Path::driving(30.0, -25.0, 90.0, 6.0)),
        named(
            "bus",
            [12.0, 2.5, 3.3],
            Path::driving(45.0, 30.0, -90.0, 5.0),
        ),
        named(
            "person",
            [0.8, 0.6, 1.7],
            Path::driving(20.0, -9.0, 60.0, 1.4),
        ),
        named("person", [0.8, 0.6, 1.7], Path::standing(9.0, 9.0, 0.0)),
    ];
    let parked = (0..8).map(|place| {
        let side = if place % 2 == 0 { -7.0 } else { 11.0 };
        Actor::car_of(
            small,
            Path::standing(f64::from(place) * 9.0 - 20.0, side, 1.0),
        )
    });
    actors.extend(parked);
    Scenario {
        rig: six_cameras(),
        ego: Path::Arc {
            start: pose(0.0, 0.0, 0.0),
            speed_m_s: 8.0,
            turn_rad_s: 0.02,
        },
        actors,
        frames,
        period: PERIOD,
        stagger: Duration::from_millis(12),
        stamp_jitter: Duration::ZERO,
    }
}

/// Two cameras side by side, both before [`spread_cars`].
///
/// # Panics
/// Never: the rig is a fixed one.
#[must_use]
pub fn two_cameras(frames: u64) -> Scenario {
    let six = six_cameras();
    let chosen = six.cameras()[..2].to_vec();
    Scenario {
        rig: Rig::new(chosen, six.ground_z_m).expect("two of six cameras are a rig"),
        ..spread_cars(frames)
    }
}

fn named(class: &str, [length_m, width_m, height_m]: [f64; 3], path: Path) -> Actor {
    Actor {
        class: roadwatch_core::ObjectClass::new(class),
        size: SizeLwh {
            length_m,
            width_m,
            height_m,
        },
        path,
    }
}

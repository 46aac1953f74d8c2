//! From beliefs in the steady frame to what is published: base_link of a moment.

use super::{
    filter::{ACCELERATION, TURN, VELOCITY},
    object::Object,
    tracker::Tracker,
};
use nalgebra::{Matrix2, Matrix3, Rotation2, Vector2};
use roadwatch_core::{
    CameraId, Ego, Heading, Location, Motion, Oriented, Phase, SceneObject, Timestamp, Track,
    TrackId,
    angle::wrapped,
    space::{Covariance, Point, Steady},
};

impl Tracker {
    /// What is believed of an object at a moment, `ego` where the vehicle is then.
    pub(super) fn motion(&self, object: &Object, at: Timestamp, ego: &Ego) -> Motion {
        let mut belief = object.belief_at(at);
        if object.is_over_ground() {
            belief = belief.or_standing();
        }
        let base_from_steady = ego.steady_from_base.inverse();
        let yaw_rad = ego.steady_from_base.yaw_rad();
        let turn = Rotation2::new(-yaw_rad);
        let turned = |vector: Vector2<f64>| turn * vector;
        let turned_matrix =
            |matrix: Matrix2<f64>| turn.matrix() * matrix * turn.matrix().transpose();
        let part = |at: usize| belief.mean.fixed_rows::<2>(at).into_owned();
        let spread = |at: usize| belief.covariance.fixed_view::<2, 2>(at, at).into_owned();
        let place = belief.position();
        let mut covariance = Matrix3::zeros();
        covariance
            .fixed_view_mut::<2, 2>(0, 0)
            .copy_from(&turned_matrix(belief.position_covariance()));
        covariance[(2, 2)] = object.observed.located.location.covariance.matrix[(2, 2)];
        let heading = belief.heading(object.is_over_ground());
        Motion {
            phase: self.phase(object, at),
            first_seen: object.first_seen,
            class: object.class().clone(),
            position: base_from_steady * Point::<Steady>::new(place.x, place.y, object.height_m()),
            covariance: Covariance::new(covariance),
            size: object.size(),
            heading: heading.map(|heading| Heading {
                yaw_rad: wrapped(heading.yaw_rad - yaw_rad),
                ..heading
            }),
            velocity_m_s: turned(part(VELOCITY)),
            velocity_covariance: turned_matrix(belief.velocity_covariance()),
            acceleration_m_s2: turned(part(ACCELERATION)),
            acceleration_covariance: turned_matrix(spread(ACCELERATION)),
            turn_rate_rad_s: belief.mean[TURN],
            turn_rate_variance: belief.covariance[(TURN, TURN)],
        }
    }

    /// The location that an object would have if a frame of a camera gave none.
    pub(super) fn location(&self, object: &Object, motion: &Motion, camera: CameraId) -> Location {
        let before = &object.observed.located.location;
        let camera = self.rig.camera(camera);
        Location {
            position: motion.position,
            covariance: motion.covariance,
            depth_m: camera.depth_m(motion.position),
            range_m: camera.range_m(motion.position),
            held: false,
            ..before.clone()
        }
    }

    /// One object of a frame.
    pub(super) fn track(&self, id: TrackId, observed: Oriented, at: Timestamp, ego: &Ego) -> Track {
        let object = self.object(id);
        Track {
            id,
            observed,
            motion: object.map(|object| self.motion(object, at, ego)),
        }
    }

    /// One object of a scene.
    pub(super) fn scene_object(
        &self,
        object: &Object,
        seen_by: Option<&Vec<CameraId>>,
        stamp: Timestamp,
        ego: &Ego,
    ) -> SceneObject {
        let mut motion = self.motion(object, stamp, ego);
        if seen_by.is_some() && motion.phase == Phase::Coasting {
            motion.phase = Phase::Confirmed;
        }
        let last = || object.last_seen_by();
        SceneObject {
            seen_by: seen_by.cloned().unwrap_or_else(last),
            seen_at: object.seen_at,
            stamp,
            trail: object.trail(ego).map(Point::from_coords).collect(),
            track: Track {
                id: object.id,
                observed: object.observed.clone(),
                motion: Some(motion),
            },
        }
    }
}

//! The locational and the rotational data frame (section III-B): what a camera's frame said of places and of headings.

use super::data_frame::{Field, Kind, Value};
use nalgebra::{Point3, Vector2};
use roadwatch_ros::msg::{
    builtin_interfaces::Time,
    roadwatch_msgs::{Object, ObjectArray},
};
use roadwatch_rotate::{RayAngle, Yaw};

const fn field(name: &'static str, kind: Kind, about: &'static str) -> Field {
    Field { name, about, kind }
}

/// Columns of the locational data frame: one row per object of a camera's frame.
pub const LOCATIONAL: [Field; 26] = [
    field(
        "stamp",
        Kind::Time,
        "capture time of the frame, nanoseconds since 1970, UTC",
    ),
    field("camera", Kind::Text, "name of the camera"),
    field("track_id", Kind::Integer, "who it is"),
    field(
        "state",
        Kind::Text,
        "tentative, confirmed, coasting, or untracked",
    ),
    field("class", Kind::Text, "what it is"),
    field("score", Kind::Real, "how sure the detector is, 0 to 1"),
    field(
        "x_m",
        Kind::Real,
        "centre of its box in base_link, forward, metres",
    ),
    field("y_m", Kind::Real, "to the left, metres"),
    field("z_m", Kind::Real, "up, metres"),
    field(
        "odom_x_m",
        Kind::Real,
        "the same in odom, metres; empty when nobody tells where the vehicle is",
    ),
    field("odom_y_m", Kind::Real, "in odom, metres"),
    field("odom_z_m", Kind::Real, "in odom, metres"),
    field(
        "depth_m",
        Kind::Real,
        "distance from the camera along its optical axis, metres",
    ),
    field(
        "range_m",
        Kind::Real,
        "horizontal distance from the camera, metres",
    ),
    field(
        "cov_xx_m2",
        Kind::Real,
        "covariance of the place in base_link, square metres",
    ),
    field("cov_xy_m2", Kind::Real, "covariance, square metres"),
    field("cov_xz_m2", Kind::Real, "covariance, square metres"),
    field("cov_yy_m2", Kind::Real, "covariance, square metres"),
    field("cov_yz_m2", Kind::Real, "covariance, square metres"),
    field("cov_zz_m2", Kind::Real, "covariance, square metres"),
    field("length_m", Kind::Real, "size along the heading, metres"),
    field("width_m", Kind::Real, "size across, metres"),
    field("height_m", Kind::Real, "size upwards, metres"),
    field("method", Kind::Text, "how the place was found"),
    field("held", Kind::Flag, "whether the place is an earlier one"),
    field(
        "predicted",
        Kind::Flag,
        "whether no frame of this moment shows it",
    ),
];

/// Columns of the rotational data frame: one row per object of a camera's frame.
pub const ROTATIONAL: [Field; 12] = [
    field(
        "stamp",
        Kind::Time,
        "capture time of the frame, nanoseconds since 1970, UTC",
    ),
    field("camera", Kind::Text, "name of the camera"),
    field("track_id", Kind::Integer, "who it is"),
    field("class", Kind::Text, "what it is"),
    field(
        "observation_angle_rad",
        Kind::Real,
        "heading less ray angle: 0 seen from behind; empty when the heading is unknown",
    ),
    field(
        "ray_angle_rad",
        Kind::Real,
        "direction from the camera to it about base_link's z, 0 forward, counter-clockwise",
    ),
    field(
        "yaw_rad",
        Kind::Real,
        "heading about base_link's z; empty when unknown",
    ),
    field(
        "deviation_rad",
        Kind::Real,
        "standard deviation of the heading, the chance of a flip included",
    ),
    field(
        "flip_probability",
        Kind::Real,
        "how likely it points the other way, 0 to 0.5",
    ),
    field(
        "heading_age_s",
        Kind::Real,
        "time since the heading was found, seconds",
    ),
    field("part_count", Kind::Integer, "number of key components seen"),
    field("parts", Kind::Text, "their names, separated by blanks"),
];

/// Rows of the locational data frame.
pub fn locational_rows(array: &ObjectArray) -> impl Iterator<Item = Vec<Value>> {
    let odom_from_base = array.odom_from_base();
    array.objects.iter().map(move |object| {
        let place = Point3::new(object.position.x, object.position.y, object.position.z);
        let in_odom = odom_from_base.map(|isometry| isometry * place);
        let odom = |axis: usize| Value::Real(in_odom.map(|place| place[axis]));
        let [xx, xy, xz, _, yy, yz, _, _, zz] = object.position_covariance;
        let mut row = vec![
            stamp(object.header.stamp),
            Value::Text(array.camera.clone()),
            Value::Integer(object.track_id.cast_signed()),
            Value::Text(object.state.clone()),
            Value::Text(object.class_id.clone()),
            real(f64::from(object.score)),
            real(place.x),
            real(place.y),
            real(place.z),
            odom(0),
            odom(1),
            odom(2),
        ];
        let size = &object.size;
        let numbers = [
            object.depth_m,
            object.range_m,
            xx,
            xy,
            xz,
            yy,
            yz,
            zz,
            size.x,
            size.y,
            size.z,
        ];
        row.extend(numbers.map(real));
        row.extend([
            Value::Text(object.method.clone()),
            Value::Flag(object.held),
            Value::Flag(object.predicted),
        ]);
        row
    })
}

/// Rows of the rotational data frame, given where the camera is above base_link's ground, metres; without it rays are
/// unknown.
pub fn rotational_rows(
    array: &ObjectArray,
    eye: Option<Vector2<f64>>,
) -> impl Iterator<Item = Vec<Value>> {
    array.objects.iter().map(move |object| {
        let ray =
            eye.map(|eye| RayAngle::towards(object.position.x - eye.x, object.position.y - eye.y));
        let yaw = object.heading_known.then(|| Yaw::new(object.yaw_rad));
        let seen = yaw.zip(ray).map(|(yaw, ray)| yaw.seen_along(ray));
        let if_known = |number: f64| Value::Real(yaw.map(|_| number));
        vec![
            stamp(object.header.stamp),
            Value::Text(array.camera.clone()),
            Value::Integer(object.track_id.cast_signed()),
            Value::Text(object.class_id.clone()),
            Value::Real(seen.map(|angle| angle.radians())),
            Value::Real(ray.map(|ray| ray.radians())),
            Value::Real(yaw.map(|yaw| yaw.radians())),
            if_known(object.yaw_variance.sqrt()),
            if_known(f64::from(object.flip_probability)),
            if_known(f64::from(object.heading_age)),
            Value::Integer(object.components.len() as i64),
            Value::Text(part_names(object)),
        ]
    })
}

fn part_names(object: &Object) -> String {
    let names: Vec<&str> = object
        .components
        .iter()
        .map(|part| part.name.as_str())
        .collect();
    names.join(" ")
}

fn real(number: f64) -> Value {
    Value::Real(Some(number))
}

fn stamp(time: Time) -> Value {
    Value::Time(i64::from(time.sec) * 1_000_000_000 + i64::from(time.nanosec))
}

#[cfg(test)]
mod tests {
    use super::*;
    use roadwatch_ros::msg::{geometry_msgs::Point, roadwatch_msgs::KeyComponent};
    use std::f64::consts::FRAC_PI_2;

    #[test]
    fn the_documentation_has_every_column_with_its_meaning() {
        let page = include_str!("../../../../docs/data-frames.md");
        for Field { name, about, .. } in LOCATIONAL.iter().chain(&ROTATIONAL) {
            let row = page
                .lines()
                .find(|line| line.starts_with(&format!("| `{name}` |")));
            let row = row.unwrap_or_else(|| panic!("docs/data-frames.md lacks `{name}`"));
            assert!(
                page.contains(&format!("| {about} |")),
                "another meaning of {row}"
            );
        }
    }

    fn array(object: Object) -> ObjectArray {
        ObjectArray {
            camera: "front".to_owned(),
            ego_motion: "measured".to_owned(),
            objects: vec![object],
            ..ObjectArray::default()
        }
    }

    fn value(fields: &[Field], row: &[Value], name: &str) -> Value {
        assert_eq!(fields.len(), row.len(), "a value for each column");
        let at = fields
            .iter()
            .position(|field| field.name == name)
            .expect("a column");
        row[at].clone()
    }

    #[test]
    fn a_place_is_told_in_base_link_and_where_the_vehicle_is_known_in_odom() {
        let object = Object {
            position: Point {
                x: 10.0,
                y: 2.0,
                z: 0.8,
            },
            position_covariance: [1.0, 2.0, 3.0, 2.0, 5.0, 6.0, 3.0, 6.0, 9.0],
            ..Object::default()
        };
        let mut told = array(object);
        told.ego_pose.position.x = 100.0;
        let row = locational_rows(&told).next().expect("a row");
        let of = |name| value(&LOCATIONAL, &row, name);
        assert_eq!(of("x_m"), Value::Real(Some(10.0)));
        assert_eq!(of("odom_x_m"), Value::Real(Some(110.0)));
        assert_eq!(of("cov_yy_m2"), Value::Real(Some(5.0)));
        assert_eq!(of("cov_zz_m2"), Value::Real(Some(9.0)));
        told.ego_motion = "none".to_owned();
        let row = locational_rows(&told).next().expect("a row");
        assert_eq!(value(&LOCATIONAL, &row, "odom_x_m"), Value::Real(None));
    }

    #[test]
    fn a_heading_is_told_against_the_ray_and_left_empty_when_unknown() {
        // To the left of a camera one metre ahead of base_link, pointing away from it.
        let object = Object {
            position: Point {
                x: 1.0,
                y: 7.0,
                z: 0.8,
            },
            heading_known: true,
            yaw_rad: FRAC_PI_2,
            yaw_variance: 0.04,
            components: vec![KeyComponent {
                name: "plate_rear".to_owned(),
                ..KeyComponent::default()
            }],
            ..Object::default()
        };
        let eye = Some(Vector2::new(1.0, 0.0));
        let row = rotational_rows(&array(object.clone()), eye)
            .next()
            .expect("a row");
        let of = |name| value(&ROTATIONAL, &row, name);
        assert_eq!(of("observation_angle_rad"), Value::Real(Some(0.0)));
        assert_eq!(of("ray_angle_rad"), Value::Real(Some(FRAC_PI_2)));
        assert_eq!(of("deviation_rad"), Value::Real(Some(0.2)));
        assert_eq!(of("parts"), Value::Text("plate_rear".to_owned()));
        let unknown = Object {
            heading_known: false,
            ..object
        };
        let row = rotational_rows(&array(unknown), eye).next().expect("a row");
        let of = |name| value(&ROTATIONAL, &row, name);
        assert_eq!(of("yaw_rad"), Value::Real(None));
        assert_eq!(of("observation_angle_rad"), Value::Real(None));
        assert_eq!(of("deviation_rad"), Value::Real(None));
        assert_eq!(of("ray_angle_rad"), Value::Real(Some(FRAC_PI_2)));
    }
}

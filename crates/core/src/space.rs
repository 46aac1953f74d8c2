//! Coordinate spaces as types: composing the wrong two does not compile.

use nalgebra::{Isometry3, Matrix3, Point3, Vector3};
use std::{marker::PhantomData, ops::Mul};

/// A coordinate space. The types below are its only members.
pub trait Space: Copy + std::fmt::Debug + Send + Sync + 'static {}

/// A camera's optical space: x right, y down, z along the optical axis (REP-103), metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Optical;
/// The ground below a camera: x along the horizontal projection of the optical axis, y left, z up,
/// origin at the camera's foot on the ground plane, metres. `LocX = -y`, `LocY = x` (docs/method.md, section 3).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraGround;
/// The vehicle: x forward, y left, z up (REP-105 `base_link`), metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct BaseLink;
/// The frame that whoever tells of the vehicle's motion tells it in (REP-105 `odom`), metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Odom;
/// Fixed to the ground as odom is, and never jumps: the vehicle is at its origin when it is first known, and goes on as it
/// did where odom takes a new origin. What is tracked lives here, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Steady;

impl Space for Optical {}
impl Space for CameraGround {}
impl Space for BaseLink {}
impl Space for Odom {}
impl Space for Steady {}

/// A point in space `S`, metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Point<S: Space> {
    /// The coordinates, metres.
    pub coords: Point3<f64>,
    space: PhantomData<S>,
}

impl<S: Space> Point<S> {
    /// A point from its coordinates in metres.
    #[must_use]
    pub fn new(x: f64, y: f64, z: f64) -> Self {
        Self::from_coords(Point3::new(x, y, z))
    }

    /// A point from nalgebra's coordinates, metres.
    #[must_use]
    pub const fn from_coords(coords: Point3<f64>) -> Self {
        Self {
            coords,
            space: PhantomData,
        }
    }

    /// First coordinate, metres.
    #[must_use]
    pub fn x(&self) -> f64 {
        self.coords.x
    }

    /// Second coordinate, metres.
    #[must_use]
    pub fn y(&self) -> f64 {
        self.coords.y
    }

    /// Third coordinate, metres.
    #[must_use]
    pub fn z(&self) -> f64 {
        self.coords.z
    }
}

/// A 3x3 position covariance in the axes of space `S`, square metres.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Covariance<S: Space> {
    /// The symmetric matrix, square metres.
    pub matrix: Matrix3<f64>,
    space: PhantomData<S>,
}

impl<S: Space> Covariance<S> {
    /// A covariance from a matrix in square metres; its symmetric part is kept.
    #[must_use]
    pub fn new(matrix: Matrix3<f64>) -> Self {
        Self {
            matrix: (matrix + matrix.transpose()) * 0.5,
            space: PhantomData,
        }
    }
}

/// A rigid transform that takes coordinates in `From` to coordinates in `To`.
///
/// Name values `to_from_from`, so that equal words touch: `base_from_optical * point_in_optical`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Transform<To: Space, From: Space> {
    /// Rotation and translation (metres).
    pub isometry: Isometry3<f64>,
    spaces: PhantomData<(To, From)>,
}

impl<To: Space, From: Space> Transform<To, From> {
    /// A transform from nalgebra's isometry (metres).
    #[must_use]
    pub const fn new(isometry: Isometry3<f64>) -> Self {
        Self {
            isometry,
            spaces: PhantomData,
        }
    }

    /// The transform that undoes this one.
    #[must_use]
    pub fn inverse(&self) -> Transform<From, To> {
        Transform::new(self.isometry.inverse())
    }

    /// The origin of `From`, seen from `To`.
    #[must_use]
    pub fn origin(&self) -> Point<To> {
        Point::from_coords(self.isometry.translation.vector.into())
    }

    /// Heading of the x axis of `From` about the z axis of `To`, counter-clockwise, radians in -pi..=pi.
    #[must_use]
    pub fn yaw_rad(&self) -> f64 {
        let forward = self.rotate(Vector3::x());
        forward.y.atan2(forward.x)
    }

    /// Turns a direction (no translation).
    #[must_use]
    pub fn rotate(&self, direction: Vector3<f64>) -> Vector3<f64> {
        self.isometry.rotation * direction
    }
}

impl<To: Space, From: Space> Mul<Point<From>> for Transform<To, From> {
    type Output = Point<To>;

    fn mul(self, point: Point<From>) -> Point<To> {
        Point::from_coords(self.isometry * point.coords)
    }
}

impl<To: Space, From: Space> Mul<Covariance<From>> for Transform<To, From> {
    type Output = Covariance<To>;

    fn mul(self, covariance: Covariance<From>) -> Covariance<To> {
        let rotation = self.isometry.rotation.to_rotation_matrix();
        Covariance::new(rotation * covariance.matrix * rotation.transpose())
    }
}

impl<To: Space, Between: Space, From: Space> Mul<Transform<Between, From>>
    for Transform<To, Between>
{
    type Output = Transform<To, From>;

    fn mul(self, other: Transform<Between, From>) -> Transform<To, From> {
        Transform::new(self.isometry * other.isometry)
    }
}

//! A simulated world for tests of the whole pipeline, without images.
//!
//! A [`Scenario`] says what moves where, past which rig. A [`World`] looks at it through the rig's cameras: it
//! knows what a perfect detector would box in every frame, and the truth behind it. [`Imperfections`] spoil
//! that by numbers. [`play`] runs the real pipeline with the real locators on it and keeps what was published;
//! [`score`] compares that with the truth, by the lab's matcher and scorer.
//!
//! The same scenario and the same imperfections give the same frames, boxes and labels: every random number
//! is drawn for its seed, purpose, camera, frame and object, in whatever order threads ask.

pub mod cameras;
pub mod dataset;
pub mod detector;
pub mod imperfections;
pub mod path;
pub mod playing;
pub mod random;
pub mod rigs;
pub mod scenario;
pub mod scenes;
pub mod stepping;
pub mod traffic;
pub mod view;
pub mod world;

pub use dataset::{score, write_dataset};
pub use imperfections::{Blind, Imperfections, MountError};
pub use path::Path;
pub use playing::{Played, play, play_tracked};
pub use scenario::{Actor, Scenario};
pub use stepping::Stepped;
pub use view::{Seen, View};
pub use world::World;

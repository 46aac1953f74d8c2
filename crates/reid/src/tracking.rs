//! Tracking: an extended Kalman filter for each object, in the steady frame; association by place, image and class.

mod association;
mod duplicates;
mod filter;
mod found;
mod heading;
mod lasting;
mod object;
mod options;
mod publish;
mod standing;
mod tracker;
mod view;

pub use options::TrackingOptions;
pub use tracker::Tracker;

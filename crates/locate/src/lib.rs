//! Distance and location of a detected box, with covariance.

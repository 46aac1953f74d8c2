//! Mounts from points and lines that a known camera sees.

use nalgebra::Vector2;
use roadwatch_calibrate::{
    GroundPoint, LineSegment, LinesError, PointsError, Solve, mount_from_lines, mount_from_points,
};
use roadwatch_core::{
    CameraModel, Distortion, ImageSize, Intrinsics, Mount,
    space::{BaseLink, Point},
};

fn model() -> CameraModel {
    CameraModel {
        size: ImageSize {
            width_px: 960,
            height_px: 540,
        },
        intrinsics: Intrinsics {
            fx: 600.0,
            fy: 600.0,
            cx: 480.0,
            cy: 270.0,
        },
        distortion: Distortion::BrownConrady([-0.1, 0.02, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]),
    }
}

fn truth() -> Mount {
    Mount {
        position_m: [1.2, 0.3, 1.8],
        yaw_rad: 0.05,
        pitch_rad: 0.07,
        roll_rad: -0.02,
    }
}

/// The mount that somebody believes in.
fn believed() -> Mount {
    Mount::ahead([1.2, 0.3, 1.5])
}

fn seen(place: Point<BaseLink>) -> Vector2<f64> {
    let pixel = model().project(truth().base_from_optical().inverse() * place);
    pixel.expect("in front of the camera")
}

/// Marks on the ground, each seen up to a pixel beside where it is.
fn marks() -> Vec<GroundPoint> {
    let places = [
        (5.0, -1.0),
        (5.0, 2.0),
        (8.0, 0.0),
        (12.0, 4.0),
        (12.0, -4.0),
        (20.0, 1.0),
    ];
    let noise = [
        (0.4, -0.3),
        (-0.5, 0.2),
        (0.1, 0.5),
        (-0.2, -0.4),
        (0.3, 0.1),
        (-0.1, -0.2),
    ];
    let marks = places.iter().zip(noise).zip(2..);
    marks
        .map(|((&(x, y), (du, dv)), line)| {
            let place = Point::new(x, y, 0.0);
            GroundPoint {
                line,
                pixel: seen(place) + Vector2::new(du, dv),
                place,
            }
        })
        .collect()
}

#[test]
fn points_give_the_mount_within_its_own_deviations() {
    for solve in [Solve::Height, Solve::Position] {
        let fit = mount_from_points(&model(), &believed(), &marks(), solve).expect("a mount");
        let (found, std) = (fit.estimate.mount, fit.estimate.std);
        let close = |found: f64, truth: f64, std: Option<f64>| {
            let std = std.expect("looked for");
            assert!((found - truth).abs() < 3.0 * std, "{found} {truth} {std}");
        };
        close(found.pitch_rad, truth().pitch_rad, std.pitch_rad);
        close(found.yaw_rad, truth().yaw_rad, std.yaw_rad);
        close(found.roll_rad, truth().roll_rad, std.roll_rad);
        close(found.position_m[2], 1.8, std.position_m[2]);
        assert_eq!(std.position_m[0].is_some(), solve == Solve::Position);
    }
}

#[test]
fn a_wrong_point_does_not_pull_the_mount_away() {
    let mut marks = marks();
    marks[2].pixel.x += 60.0;
    let fit = mount_from_points(&model(), &believed(), &marks, Solve::Height).expect("a mount");
    let off_deg = (fit.estimate.mount.pitch_rad - truth().pitch_rad).to_degrees();
    assert!(off_deg.abs() < 0.6, "{off_deg}");
    assert!(fit.residuals_px[2].norm() > 40.0);
}

#[test]
fn a_point_above_the_horizon_is_named_with_its_line() {
    let mut marks = marks();
    marks[4].pixel.y = 120.0;
    let refused = mount_from_points(&model(), &believed(), &marks, Solve::Height);
    let text = refused.expect_err("above the horizon").to_string();
    assert!(
        text.starts_with("line 6: row 120 lies above the horizon"),
        "{text}"
    );
}

#[test]
fn too_few_points_are_refused() {
    let refused = mount_from_points(&model(), &believed(), &marks()[..2], Solve::Height);
    assert!(matches!(
        refused,
        Err(PointsError::TooFew {
            found: 2,
            needed: 3
        })
    ));
}

/// Lane borders 3.5 m apart, beginning at the line of a file that is the index and two.
fn lanes() -> Vec<LineSegment> {
    let pieces = [
        (6.0, 12.0, 1.9),
        (14.0, 25.0, 1.9),
        (6.0, 12.0, -1.6),
        (14.0, 25.0, -1.6),
    ];
    let pieces = pieces.iter().zip(2..);
    pieces
        .map(|(&(from, to, y), line)| LineSegment {
            line,
            ends: [from, to].map(|x| seen(Point::new(x, y, 0.0))),
        })
        .collect()
}

#[test]
fn lanes_give_pitch_and_yaw_and_their_width_the_height() {
    let start = Mount {
        roll_rad: truth().roll_rad,
        ..believed()
    };
    let fit = mount_from_lines(&model(), &start, &lanes(), (Some(3.5), 0.0)).expect("a mount");
    let found = fit.estimate.mount;
    assert!((found.pitch_rad - truth().pitch_rad).abs().to_degrees() < 0.05);
    assert!((found.yaw_rad - truth().yaw_rad).abs().to_degrees() < 0.05);
    assert!(
        (found.position_m[2] - 1.8).abs() < 0.02,
        "{:?}",
        found.position_m
    );
    assert_eq!(fit.estimate.std.roll_rad, None);
    let meeting = fit.vanishing_point.expect("ahead");
    let far = seen(Point::new(1e6, 0.0, 0.0));
    assert!((meeting - far).norm() < 1.0, "{meeting} {far}");
}

#[test]
fn lines_that_determine_nothing_are_refused() {
    let refuse = |segments: &[LineSegment], width| {
        mount_from_lines(&model(), &believed(), segments, (width, 0.0)).expect_err("refused")
    };
    assert!(matches!(
        refuse(&lanes()[..1], None),
        LinesError::TooFew { found: 1 }
    ));
    assert!(matches!(
        refuse(&lanes()[..2], None),
        LinesError::Undetermined
    ));
    let mut short = lanes();
    short[1].ends[1] = short[1].ends[0] + Vector2::new(2.0, 1.0);
    assert!(matches!(
        refuse(&short, None),
        LinesError::TooShort { line: 3 }
    ));
}

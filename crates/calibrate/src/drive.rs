//! Which boxes of a drive may speak about the mount, and which of them are of one object.

use roadwatch_core::{BoxPx, ImageSize, ObjectClass};
use roadwatch_locate::{ClassSize, Standing};
use std::fmt;

/// Nearer than this to the image's border a box may be cut off, pixels.
const BORDER_PX: f32 = 3.0;
/// A nearer object that covers more than this share of a box's width, and its bottom edge, may hide the bottom.
const COVERING_SHARE: f32 = 0.1;
/// Boxes of consecutive frames that overlap by this are of one object: at 10 Hz a car's do by more, two cars
/// side by side do not.
const SAME_OBJECT_IOU: f32 = 0.4;

/// A box as it was detected or labelled, with the size that its object is believed to have.
#[derive(Clone, Debug, PartialEq)]
pub struct SeenBox {
    /// What it is.
    pub class: ObjectClass,
    /// Where it is, pixels.
    pub box_px: BoxPx,
    /// How large it is believed to be, with a spread.
    pub size: ClassSize,
}

/// A box that may speak.
#[derive(Clone, Debug, PartialEq)]
pub struct BoxSighting {
    /// What was seen.
    pub seen: SeenBox,
    /// Boxes of the same number are of one object.
    pub track: usize,
}

/// How many boxes were left out, and why.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct LeftOut {
    /// Too low in the image to measure.
    pub small: usize,
    /// At the image's border.
    pub cut: usize,
    /// With something nearer before their bottom edge.
    pub covered: usize,
    /// Of a class that does not stand on the ground.
    pub raised: usize,
}

impl fmt::Display for LeftOut {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            small,
            cut,
            covered,
            raised,
        } = self;
        write!(
            f,
            "left out {small} too small, {cut} at the image's border, {covered} covered below, {raised} not on the ground"
        )
    }
}

/// The boxes of one camera over a drive.
#[derive(Clone, Debug)]
pub struct Sightings {
    image: ImageSize,
    min_height_px: f32,
    all: Vec<BoxSighting>,
    last: Vec<(usize, BoxPx)>,
    tracks: usize,
    left_out: LeftOut,
}

impl Sightings {
    /// None yet. Boxes lower than `min_height_px` will be left out.
    #[must_use]
    pub fn new(image: ImageSize, min_height_px: f32) -> Self {
        Self {
            image,
            min_height_px,
            all: Vec::new(),
            last: Vec::new(),
            tracks: 0,
            left_out: LeftOut::default(),
        }
    }

    /// Adds the boxes of the next frame, all of them: those that may not speak still cover others.
    pub fn push_frame(&mut self, boxes: &[SeenBox]) {
        let mut now = Vec::with_capacity(boxes.len());
        for seen in boxes {
            let track = self.track_of(&seen.box_px);
            now.push((track, seen.box_px));
            match self.reason_against(seen, boxes) {
                Some(count) => *count += 1,
                None => self.all.push(BoxSighting {
                    seen: seen.clone(),
                    track,
                }),
            }
        }
        self.last = now;
    }

    /// The boxes that may speak.
    #[must_use]
    pub fn boxes(&self) -> &[BoxSighting] {
        &self.all
    }

    /// What was left out.
    #[must_use]
    pub fn left_out(&self) -> LeftOut {
        self.left_out
    }

    fn track_of(&mut self, box_px: &BoxPx) -> usize {
        let overlaps = self.last.iter().enumerate();
        let overlaps = overlaps.map(|(at, (_, before))| (box_px.iou(before), at));
        let best = overlaps.max_by(|a, b| a.0.total_cmp(&b.0));
        match best.filter(|(iou, _)| *iou >= SAME_OBJECT_IOU) {
            Some((_, at)) => self.last.swap_remove(at).0,
            None => {
                self.tracks += 1;
                self.tracks - 1
            }
        }
    }

    fn reason_against(&mut self, seen: &SeenBox, others: &[SeenBox]) -> Option<&mut usize> {
        let b = &seen.box_px;
        let (width, height) = (self.image.width_px as f32, self.image.height_px as f32);
        let is_cut = b.x_min < BORDER_PX
            || b.y_min < BORDER_PX
            || b.x_max > width - BORDER_PX
            || b.y_max > height - BORDER_PX;
        let left_out = &mut self.left_out;
        if seen.size.standing == Standing::Raised {
            Some(&mut left_out.raised)
        } else if b.height_px() < self.min_height_px {
            Some(&mut left_out.small)
        } else if is_cut {
            Some(&mut left_out.cut)
        } else if others.iter().any(|other| covers(&other.box_px, b)) {
            Some(&mut left_out.covered)
        } else {
            None
        }
    }
}

/// Whether something nearer (its bottom is lower in the image) stands before the bottom edge of a box.
fn covers(nearer: &BoxPx, b: &BoxPx) -> bool {
    let shared = nearer.x_max.min(b.x_max) - nearer.x_min.max(b.x_min);
    nearer.y_max > b.y_max && nearer.y_min < b.y_max && shared > COVERING_SHARE * b.width_px()
}

#[cfg(test)]
mod tests {
    use super::*;
    use roadwatch_locate::ClassSizes;

    fn seen(class: &str, [x0, y0, x1, y1]: [f32; 4]) -> SeenBox {
        let class = ObjectClass::new(class);
        SeenBox {
            size: *ClassSizes::default().get(&class).expect("a known class"),
            class,
            box_px: BoxPx::new(x0, y0, x1, y1).expect("a box"),
        }
    }

    fn sightings() -> Sightings {
        let image = ImageSize {
            width_px: 960,
            height_px: 540,
        };
        Sightings::new(image, 20.0)
    }

    #[test]
    fn an_object_keeps_its_number_while_its_boxes_overlap() {
        let mut all = sightings();
        all.push_frame(&[
            seen("car", [100.0, 250.0, 160.0, 290.0]),
            seen("car", [300.0, 250.0, 360.0, 290.0]),
        ]);
        all.push_frame(&[
            seen("car", [305.0, 250.0, 365.0, 291.0]),
            seen("car", [500.0, 250.0, 560.0, 290.0]),
        ]);
        let tracks: Vec<_> = all.boxes().iter().map(|sighting| sighting.track).collect();
        assert_eq!(tracks, [0, 1, 1, 2]);
    }

    #[test]
    fn what_cannot_speak_is_counted_with_its_reason() {
        let mut all = sightings();
        all.push_frame(&[
            seen("car", [100.0, 250.0, 160.0, 265.0]),
            seen("car", [0.0, 250.0, 60.0, 290.0]),
            seen("car", [300.0, 250.0, 360.0, 290.0]),
            seen("person", [340.0, 240.0, 370.0, 330.0]),
            seen("traffic light", [500.0, 50.0, 520.0, 90.0]),
        ]);
        let expected = LeftOut {
            small: 1,
            cut: 1,
            covered: 1,
            raised: 1,
        };
        assert_eq!(all.left_out(), expected);
        assert_eq!(all.boxes().len(), 1);
    }
}

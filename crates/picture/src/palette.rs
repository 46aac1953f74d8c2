//! Colours, blue green red. Classes are told apart by hues that stay apart for colour-blind eyes
//! (Okabe and Ito, "Color Universal Design", 2008).

use roadwatch_core::TrackId;

pub(crate) type Colour = [u8; 3];

pub(crate) const PAPER: Colour = [38, 30, 26];
pub(crate) const GRID: Colour = [74, 62, 56];
pub(crate) const TEXT: Colour = [232, 228, 224];
pub(crate) const FAINT_TEXT: Colour = [150, 140, 132];
pub(crate) const VEHICLE: Colour = [250, 250, 250];
pub(crate) const FIELD_OF_VIEW: Colour = [78, 66, 58];
/// What was measured, over an image.
pub(crate) const MARK: Colour = VERMILION;

const SKY_BLUE: Colour = [233, 180, 86];
const ORANGE: Colour = [0, 159, 230];
const GREEN: Colour = [115, 158, 0];
const YELLOW: Colour = [66, 228, 240];
const PURPLE: Colour = [167, 121, 204];
const VERMILION: Colour = [0, 94, 213];

/// The colour of an identity.
pub(crate) fn of_identity(id: TrackId) -> Colour {
    const COLOURS: [Colour; 6] = [SKY_BLUE, ORANGE, GREEN, YELLOW, PURPLE, VERMILION];
    COLOURS[(id.0 % COLOURS.len() as u64) as usize]
}

/// The colour of a class, by its COCO name.
pub(crate) fn of_class(class: &str) -> Colour {
    match class {
        "car" => SKY_BLUE,
        "truck" => ORANGE,
        "bus" => YELLOW,
        "person" => VERMILION,
        "bicycle" | "motorcycle" => PURPLE,
        _ => GREEN,
    }
}

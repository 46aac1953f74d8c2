//! OpenCV writing straight into the bytes that the pipeline shares: no copy after decoding.

use opencv::{
    boxed_ref::BoxedRefMut,
    core::{Mat, MatTraitConst, MatTraitConstManual, Vec3b},
};
use roadwatch_core::{DecodeError, ImageSize, Pixels};

const BYTES_PER_PIXEL: usize = 3;

/// Pixels that `fill` writes into a matrix of `expected` size, blue green red.
///
/// # Errors
/// When `fill` fails, leaves no image, or leaves one of another size.
pub(crate) fn fill_pixels(
    expected: ImageSize,
    fill: impl FnOnce(&mut BoxedRefMut<'_, Mat>) -> opencv::Result<()>,
) -> Result<Pixels, DecodeError> {
    let (Ok(rows), Ok(columns)) = (
        i32::try_from(expected.height_px),
        i32::try_from(expected.width_px),
    ) else {
        return Err(DecodeError::new(format!("a {expected} image is too large")));
    };
    let mut bgr =
        vec![0; expected.width_px as usize * expected.height_px as usize * BYTES_PER_PIXEL];
    let home = bgr.as_ptr();
    let moved = {
        let mut mat =
            Mat::new_rows_cols_with_bytes_mut::<Vec3b>(rows, columns, &mut bgr).map_err(refused)?;
        fill(&mut mat).map_err(refused)?;
        check_size(size_of(&mat), expected)?;
        moved_bytes(&mat, home).map_err(refused)?
    };
    Pixels::new(expected, moved.unwrap_or(bgr))
}

/// OpenCV reallocates a matrix that does not suit it; then the pixels are not where they should be.
fn moved_bytes(mat: &BoxedRefMut<'_, Mat>, home: *const u8) -> opencv::Result<Option<Vec<u8>>> {
    if std::ptr::eq(mat.data(), home) {
        return Ok(None);
    }
    mat.data_bytes().map(|bytes| Some(bytes.to_vec()))
}

fn size_of(mat: &BoxedRefMut<'_, Mat>) -> ImageSize {
    ImageSize {
        width_px: u32::try_from(mat.cols()).unwrap_or(0),
        height_px: u32::try_from(mat.rows()).unwrap_or(0),
    }
}

fn check_size(found: ImageSize, expected: ImageSize) -> Result<(), DecodeError> {
    if found.width_px == 0 || found.height_px == 0 {
        return Err(DecodeError::new(
            "the image is damaged: OpenCV cannot decode it",
        ));
    }
    if found != expected {
        return Err(DecodeError::new(format!(
            "image is {found}, the rig says {expected}"
        )));
    }
    Ok(())
}

/// What OpenCV says, on one line.
fn refused(error: opencv::Error) -> DecodeError {
    DecodeError::new(format!(
        "OpenCV refuses the image: {}",
        error.message.trim()
    ))
}

//! `roadwatch calibrate focal`.

use super::still;
use crate::{cli::CalibrateFocalArgs, commands::output::say, failure::Failure};
use anyhow::{Context as _, anyhow};
use roadwatch_calibrate::{FocalFit, KnownObject};
use roadwatch_core::{BoxPx, Pixels};
use roadwatch_picture::focal_view;
use serde_json::json;

/// Measures a focal value by eq. 1 and prints the keys to paste.
///
/// # Errors
/// When a number cannot be, the image cannot be read, or the picture not be written.
pub fn run(args: &CalibrateFocalArgs) -> Result<(), Failure> {
    let shown = args.image.as_deref().map(still::read).transpose()?;
    let boxed = shown
        .as_ref()
        .map(|image| measured(args, image))
        .transpose()?;
    let image_height_px = image_height_px(args, shown.as_ref())?;
    let known = args.measurement.iter().copied();
    let known: Vec<KnownObject> = known.chain(boxed.map(|(known, _)| known)).collect();
    let fit = FocalFit::new(&known, image_height_px).map_err(anyhow::Error::from)?;
    let focal = fit.focal.focal_px;
    if args.json {
        say!(
            "{:#}",
            json!({
                "measured_focal_px": focal,
                "measured_focal_image_height_px": image_height_px,
                "each_px": fit.each_px,
                "spread_px": fit.spread_px,
            })
        );
    } else {
        print(&known, &fit, &args.camera)?;
    }
    if let (Some(file), Some(image), Some((known, box_px))) = (&args.picture, &shown, boxed) {
        let text = format!(
            "P {:.1} px, D {} m, W {} m: F = P D / W = {:.1} px",
            known.height_px,
            known.distance_m,
            known.size_m,
            known.height_px * known.distance_m / known.size_m
        );
        let view = focal_view(image, &box_px, &text).map_err(anyhow::Error::from)?;
        view.write(file).map_err(anyhow::Error::from)?;
        eprintln!("written: {}", file.display());
    }
    Ok(())
}

fn print(known: &[KnownObject], fit: &FocalFit, camera: &str) -> Result<(), Failure> {
    for (known, each) in known.iter().zip(&fit.each_px) {
        say!(
            "P {:.1} px, D {} m, W {} m: F = {each:.2} px",
            known.height_px,
            known.distance_m,
            known.size_m
        );
    }
    if let Some(spread) = fit.spread_px {
        let share = 100.0 * spread / fit.focal.focal_px;
        say!(
            "mean {:.2} px, spread {spread:.2} px ({share:.1} %)",
            fit.focal.focal_px
        );
    }
    say!("\nto paste into the configuration:\n");
    say!("[[camera]]\nname = \"{camera}\"");
    say!("measured_focal_px = {:.2}", fit.focal.focal_px);
    say!(
        "measured_focal_image_height_px = {}",
        fit.focal.image_height_px
    );
    Ok(())
}

/// The known object of the image, and its box.
fn measured(
    args: &CalibrateFocalArgs,
    image: &Pixels,
) -> Result<(KnownObject, BoxPx), anyhow::Error> {
    let &[x_min, y_min, x_max, y_max] = args.box_px.as_slice() else {
        return Err(anyhow!(
            "--box: expected four numbers of pixels, like 470,260,560,330"
        ));
    };
    let box_px = BoxPx::new(x_min, y_min, x_max, y_max)
        .context("--box: expected corners with an area between them")?;
    let size = image.size();
    let is_inside = x_min >= 0.0
        && y_min >= 0.0
        && x_max <= size.width_px as f32
        && y_max <= size.height_px as f32;
    if !is_inside {
        return Err(anyhow!("--box: reaches outside the image, which is {size}"));
    }
    let known = KnownObject {
        height_px: f64::from(box_px.height_px()),
        distance_m: args.distance_m.context("--distance-m is missing")?,
        size_m: args.size_m.context("--size-m is missing")?,
    };
    Ok((known, box_px))
}

fn image_height_px(
    args: &CalibrateFocalArgs,
    shown: Option<&Pixels>,
) -> Result<u32, anyhow::Error> {
    let of_image = shown.map(|image| image.size().height_px);
    match (args.image_height_px, of_image) {
        (Some(said), Some(found)) if said != found => Err(anyhow!(
            "--image-height-px {said}: the image is {found} pixels high, and a focal value belongs to one size"
        )),
        (said, found) => said.or(found).context("--image-height-px is missing"),
    }
}

//! Renders part of a recorded game as a GIF file.
//!
//! All pictures share one palette, and each contains only the changes since the previous one.

use crate::game_args;
use crate::output_file;
use crate::plot::film::{Moment, Stage};
use crate::plot::pixels;
use crate::water_args::within;
use anyhow::{Context, Result, bail};
use command_line::explain::UsageError;
use command_line::number::whole;
use gif::{DisposalMethod, Encoder, Repeat};
use primitives::Ned;
use recording::{Damaged, Recording};
use std::borrow::Cow;
use std::collections::{BTreeMap, VecDeque};
use std::path::Path;

/// Pictures per second of playback.
const PICTURES_HZ: f64 = 10.0;
/// How long the last picture is shown before the loop restarts, hundredths of a second.
const END_CS: u16 = 200;
/// Maximum number of pictures in a film.
const PICTURES_MAX: f64 = 5000.0;
/// Length of the trails, s.
const TRAIL_S: f64 = 30.0;
/// The palette index of an unchanged pixel (transparent).
const UNCHANGED: u8 = 255;
/// Number of pictures from which the palette is computed.
const SAMPLES: usize = 6;

#[derive(clap::Args)]
pub(super) struct FilmArgs {
    /// With --gif: start time in the game, s [default: the beginning]
    #[arg(long, value_name = "S", requires = "gif", value_parser = within(0.0, 1e7, "s"))]
    from: Option<f64>,
    /// With --gif: end time in the game, s [default: the end]
    #[arg(long, value_name = "S", requires = "gif", value_parser = within(0.0, 1e7, "s"))]
    to: Option<f64>,
    /// With --gif: playback speed, as a multiple of real time
    #[arg(
        long,
        value_name = "FACTOR",
        requires = "gif",
        default_value = "10x",
        allow_hyphen_values = true
    )]
    #[arg(value_parser = game_args::speed)]
    speed: f64,
    /// With --gif: width of the animation, pixels
    #[arg(long, value_name = "PIXELS", requires = "gif", default_value_t = 800, value_parser = whole::<u32>(200, 2000))]
    width: u32,
}

/// Writes a film; returns the number of pictures and the damage in the recording.
pub(super) fn write(
    path: &Path,
    recording: &Recording,
    args: &FilmArgs,
) -> Result<(usize, Damaged)> {
    output_file::check(path, "the animation")?;
    let header = recording.header();
    let scenario = &header.info.scenario;
    let stage = Stage::new(header.game.replace('_', " "), scenario, args.width);
    let mut damaged = Damaged::default();
    // Nothing changes between two decisions.
    let step_s = f64::max(args.speed / PICTURES_HZ, scenario.decision().as_s());
    let delay_cs = (100.0 * step_s / args.speed).round() as u16;
    let moments = moments(recording, (args, step_s), &stage, &mut damaged)?;
    let [Some(first), Some(last)] = [moments.first(), moments.last()] else {
        bail!(
            "the recording has no frame after {} s",
            args.from.unwrap_or(0.0)
        )
    };
    let size = crate::plot::Drawing::size(first);
    // Widely spaced moments cover all colours between them; the last moment uses all of them at
    // once.
    let step = moments.len().div_ceil(SAMPLES);
    let samples = moments
        .iter()
        .step_by(step)
        .chain([last])
        .map(colours)
        .collect::<Result<Vec<_>>>()?;
    let mut palette = Palette::of(&samples);
    let file = primitives::output_file::create(path)
        .with_context(|| format!("cannot write the animation to {}", path.display()))?;
    let mut writer = std::io::BufWriter::new(file);
    let what = || format!("cannot write the animation to {}", path.display());
    let mut encoder = Encoder::new(&mut writer, size.0 as u16, size.1 as u16, &palette.bytes())
        .with_context(what)?;
    encoder.set_repeat(Repeat::Infinite).with_context(what)?;
    let mut before: Option<Vec<u8>> = None;
    for (i, moment) in moments.iter().enumerate() {
        let indices = palette.indices(&colours(moment)?);
        let mut picture = changes(
            &indices,
            before.as_deref(),
            (size.0 as usize, size.1 as usize),
        );
        // Hold the last picture before the loop restarts.
        picture.delay = if i + 1 == moments.len() {
            END_CS
        } else {
            delay_cs
        };
        encoder.write_frame(&picture).with_context(what)?;
        before = Some(indices);
    }
    drop(encoder);
    std::io::Write::flush(&mut writer).with_context(what)?;
    Ok((moments.len(), damaged))
}

/// Red, green and blue of each pixel in row order.
fn colours(moment: &Moment<'_>) -> Result<Vec<u8>> {
    let picture = pixels(moment)?;
    Ok(picture
        .pixels()
        .iter()
        .flat_map(|pixel| [pixel.red(), pixel.green(), pixel.blue()])
        .collect())
}

/// The moments of a film.
fn moments<'a>(
    recording: &Recording,
    (args, step_s): (&FilmArgs, f64),
    stage: &'a Stage<'a>,
    damaged: &mut Damaged,
) -> Result<Vec<Moment<'a>>> {
    let from_s = args.from.unwrap_or(0.0);
    let to_s = args.to.unwrap_or(f64::INFINITY);
    if to_s <= from_s {
        bail!(UsageError(format!(
            "--to is {to_s} s, expected more than --from, {from_s} s"
        )));
    }
    let mut moments = vec![];
    let mut trails: VecDeque<(f64, Vec<Ned>)> = VecDeque::new();
    for frame in recording.frames() {
        let Some(frame) = damaged.sound(frame) else {
            continue;
        };
        let t_s = frame.stamp.valid_ns.as_s();
        if t_s > to_s + 1e-6 {
            break;
        }
        if t_s < from_s - TRAIL_S {
            continue;
        }
        trails.push_back((
            t_s,
            frame.vehicles.iter().map(|boat| boat.nav.at()).collect(),
        ));
        while trails
            .front()
            .is_some_and(|(before_s, _)| *before_s < t_s - TRAIL_S)
        {
            trails.pop_front();
        }
        if t_s < from_s + moments.len() as f64 * step_s - 1e-6 {
            continue;
        }
        if moments.len() as f64 >= PICTURES_MAX {
            bail!(
                "the animation has more than {PICTURES_MAX} frames; increase --speed, or limit it with --from and --to"
            );
        }
        let trail = |i| {
            trails
                .iter()
                .filter_map(|(_, places)| places.get(i).copied())
                .collect()
        };
        let trails = (0..frame.vehicles.len()).map(trail).collect();
        moments.push(Moment {
            stage,
            frame,
            trails,
        });
    }
    Ok(moments)
}

/// The palette of a film: the most frequent colours.
struct Palette {
    colours: Vec<[u8; 3]>,
    /// The palette colour for each colour: itself, or the nearest.
    nearest: BTreeMap<[u8; 3], u8>,
}

impl Palette {
    fn of(samples: &[Vec<u8>]) -> Palette {
        let mut counts: BTreeMap<[u8; 3], u64> = BTreeMap::new();
        for pixel in samples.iter().flat_map(|sample| sample.chunks_exact(3)) {
            *counts.entry([pixel[0], pixel[1], pixel[2]]).or_default() += 1;
        }
        let mut counts: Vec<([u8; 3], u64)> = counts.into_iter().collect();
        counts.sort_by_key(|(_, count)| std::cmp::Reverse(*count));
        let colours: Vec<[u8; 3]> = counts
            .into_iter()
            .map(|(colour, _)| colour)
            .take(usize::from(UNCHANGED))
            .collect();
        let nearest = colours
            .iter()
            .enumerate()
            .map(|(i, colour)| (*colour, i as u8))
            .collect();
        Palette { colours, nearest }
    }

    /// The palette in its file format.
    fn bytes(&self) -> Vec<u8> {
        let mut bytes = self.colours.concat();
        bytes.resize(3 * 256, 0);
        bytes
    }

    /// The palette index of each pixel.
    fn indices(&mut self, pixels: &[u8]) -> Vec<u8> {
        let Palette { colours, nearest } = self;
        let mut index = |colour: [u8; 3]| {
            *nearest.entry(colour).or_insert_with(|| {
                let distance = |other: &[u8; 3]| -> u32 {
                    colour
                        .iter()
                        .zip(other)
                        .map(|(a, b)| u32::from(a.abs_diff(*b)).pow(2))
                        .sum()
                };
                let best = colours
                    .iter()
                    .enumerate()
                    .min_by_key(|(_, other)| distance(other));
                best.map_or(0, |(i, _)| i as u8)
            })
        };
        pixels
            .chunks_exact(3)
            .map(|pixel| index([pixel[0], pixel[1], pixel[2]]))
            .collect()
    }
}

/// The changed rectangle of a picture, with all unchanged pixels transparent.
fn changes(
    indices: &[u8],
    before: Option<&[u8]>,
    (wide, high): (usize, usize),
) -> gif::Frame<'static> {
    let is_changed = |i: usize| before.is_none_or(|before| before[i] != indices[i]);
    let changed = || (0..indices.len()).filter(|i| is_changed(*i));
    let bounds =
        changed()
            .map(|i| (i % wide, i / wide))
            .fold(None, |bounds: Option<[usize; 4]>, (x, y)| {
                let [left, top, right, bottom] = bounds.unwrap_or([x, y, x, y]);
                Some([left.min(x), top.min(y), right.max(x), bottom.max(y)])
            });
    // A picture has at least one pixel.
    let [left, top, right, bottom] = bounds.unwrap_or([0; 4]);
    let right = right.min(wide - 1);
    let bottom = bottom.min(high - 1);
    let of_row = |y: usize| (left..=right).map(move |x| y * wide + x);
    let pixel = |i: usize| if is_changed(i) { indices[i] } else { UNCHANGED };
    gif::Frame {
        left: left as u16,
        top: top as u16,
        width: (right - left + 1) as u16,
        height: (bottom - top + 1) as u16,
        transparent: Some(UNCHANGED),
        dispose: DisposalMethod::Keep,
        buffer: Cow::Owned((top..=bottom).flat_map(of_row).map(pixel).collect()),
        ..gif::Frame::default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_picture_has_what_changed_and_the_first_one_has_all() {
        let first = [0, 1, 2, 3, 4, 5];
        let whole = changes(&first, None, (3, 2));
        assert_eq!(
            (whole.width, whole.height, &whole.buffer[..]),
            (3, 2, &first[..])
        );
        let next = changes(&[0, 1, 9, 3, 7, 5], Some(&first), (3, 2));
        assert_eq!((next.left, next.top, next.width, next.height), (1, 0, 2, 2));
        assert_eq!(next.buffer[..], [UNCHANGED, 9, 7, UNCHANGED]);
        let same = changes(&first, Some(&first), (3, 2));
        assert_eq!(
            (same.width, same.height, &same.buffer[..]),
            (1, 1, &[UNCHANGED][..])
        );
    }

    #[test]
    fn of_many_colours_the_frequent_ones_stay_and_others_become_the_nearest() {
        let mut pixels: Vec<u8> = [[10, 10, 10]; 50].concat();
        pixels.extend((0..200).flat_map(|i| [[200, i, 0]; 2].concat()));
        pixels.extend((0..200).flat_map(|i| [90, 100, i]));
        let mut palette = Palette::of(&[pixels]);
        assert_eq!((palette.colours.len(), palette.bytes().len()), (255, 768));
        let got = palette.indices(&[10, 10, 10, 10, 11, 10, 200, 77, 0]);
        let colours: Vec<[u8; 3]> = got
            .iter()
            .map(|i| palette.colours[usize::from(*i)])
            .collect();
        assert_eq!(colours, [[10, 10, 10], [10, 10, 10], [200, 77, 0]]);
    }
}

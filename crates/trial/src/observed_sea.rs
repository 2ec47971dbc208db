//! The sea as observed by a boat: height, period and direction of the waves from the heights and
//! velocities of its receiver, and its drift.
//!
//! Start with [`ObservedSea::of`]. The boat acts as a wave buoy: it follows waves that are long
//! compared with its hull. Spectra are means over blocks and orthogonal sine tapers (Riedel and
//! Sidorenko 1995); intervals come from the delete-one jackknife over blocks. Waves move water
//! forward under crests, so the mean product of height and velocity points in their direction of
//! travel.

use crate::identify::student_975;
use primitives::angle::{compass_deg_from_rad, wrap_pi};
use primitives::{Ned, math};
use std::f64::consts::{PI, TAU};
use std::fmt::Write;
use std::ops::Range;
use thiserror::Error;

/// Times (s) and values.
type Series = [(f64, f64)];

/// A boat's measurements, ascending by time.
#[derive(Clone, Copy, Debug)]
pub struct Track<'a> {
    /// Heights, m.
    pub height: &'a Series,
    /// Velocity north over the ground, m/s.
    pub north: &'a Series,
    /// Velocity east over the ground, m/s.
    pub east: &'a Series,
    /// Commands of each thruster, in any unit; without them the boat counts as adrift.
    pub thrusts: [&'a Series; 2],
}

/// A value and half the width of its 95 % interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Half the width of the interval.
    pub plus_minus: f64,
}

/// Waves around one peak of the spectrum, as estimated from a log.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObservedWaves {
    /// Significant height, m: four standard deviations, without the receiver's noise.
    pub hs_m: Measured,
    /// Period at the peak, s.
    pub tp_s: Measured,
    /// Compass bearing from which they come, degrees; `None` if the log does not determine it.
    pub from_deg: Option<Measured>,
}

/// Drift over the ground due to current and wind together.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ObservedDrift {
    /// Speed, m/s.
    pub speed_m_s: Measured,
    /// Compass bearing towards which the boat drifts, degrees.
    pub toward_deg: f64,
}

/// What a log reveals about the sea.
#[derive(Clone, Debug, PartialEq)]
pub struct ObservedSea {
    /// The waves; none if the receiver's noise hides them. If wind sea and swell each have a peak,
    /// the higher one comes first.
    pub waves: Vec<ObservedWaves>,
    /// The boat's drift while its thrusters were off; `None` if it cannot be distinguished from
    /// zero.
    pub drift: Option<ObservedDrift>,
    /// Standard deviation of the receiver's noise in the heights, m; 0 if the log does not show it.
    pub noise_m: f64,
    /// Length of a block, s.
    pub block_s: f64,
    /// The numbers of blocks used for the waves, and of all blocks.
    pub blocks: [usize; 2],
    /// The spectrum of the heights: frequencies, Hz, and densities, m²/Hz.
    pub spectrum: Vec<(f64, f64)>,
}

/// Why a log reveals nothing about the sea.
#[derive(Clone, Debug, PartialEq, Error)]
pub enum NoSea {
    /// The log contains no heights.
    #[error("the log contains no heights from a satellite receiver")]
    Missing,
    /// There are too few heights, or they are too far apart.
    #[error(
        "{count} heights, one every {step_s:.1} s; expected heights from a receiver at least once per second for \
         {least_s:.0} s"
    )]
    Heights {
        /// The number of heights.
        count: usize,
        /// Typical time between heights, s.
        step_s: f64,
        /// Time needed, s.
        least_s: f64,
    },
    /// The boat was under way almost all the time.
    #[error(
        "the boat moves at {speed_m_s:.1} m/s; expected at least {BLOCKS_MIN} stretches of {block_s:.0} s below \
         {SLOW_M_S} m/s, adrift, moored or keeping station, because motion shifts the periods of waves"
    )]
    UnderWay {
        /// Its median speed, m/s.
        speed_m_s: f64,
        /// Length of a block, s.
        block_s: f64,
    },
}

/// Speed above which a block is not used, m/s: a third of the speed of waves with a period of 2 s.
const SLOW_M_S: f64 = 1.0;
/// Minimum number of blocks for an interval.
const BLOCKS_MIN: usize = 5;
/// Target number of blocks, and limits of their length, s: a trade-off of resolution against
/// independence.
const BLOCKS: f64 = 10.0;
const BLOCK_S: (f64, f64) = (45.0, 120.0);
/// Longest gap over which heights are interpolated, s; also the longest time between two heights.
const GAP_MAX_S: f64 = 1.0;
/// The frequency band, Hz: below it receivers wander; above it boats do not follow the waves.
const BAND_HZ: (f64, f64) = (0.05, 2.0);
/// The highest frequency used, as a fraction of half the sampling rate.
const OF_NYQUIST: f64 = 0.9;
/// Number of tapers per block.
const TAPERS: usize = 3;
/// Minimum ratio of the peak to the valley before it, and to the noise.
const CLEAR: f64 = 2.0;
/// Minimum motion of a boat along the waves, as a fraction of the water's: a boat that does not
/// move with them shows no direction.
const MOVES: f64 = 0.05;
/// Direction intervals wider than this are meaningless, degrees.
const VAGUE_DEG: f64 = 60.0;

/// Sums over the tapers of a block, or over several blocks.
#[derive(Clone, Debug)]
struct Block {
    /// Density of the heights by frequency, m²/Hz.
    density: Vec<f64>,
    /// Co-spectrum of heights and velocity north and east.
    toward: Vec<Ned>,
    /// Mean velocity, m/s.
    drift_m_s: Ned,
}

impl ObservedSea {
    /// What this track reveals about the sea.
    ///
    /// # Errors
    /// [`NoSea`] if there is nothing to estimate from.
    pub fn of(track: &Track<'_>) -> Result<ObservedSea, NoSea> {
        let least_s = BLOCK_S.0 * BLOCKS_MIN as f64;
        let mut steps: Vec<f64> = track.height.windows(2).map(|w| w[1].0 - w[0].0).collect();
        steps.sort_by(f64::total_cmp);
        let step_s = steps.get(steps.len() / 2).copied().unwrap_or(f64::NAN);
        if steps.is_empty() {
            return Err(NoSea::Missing);
        }
        let is_dense = step_s > 0.0 && step_s <= GAP_MAX_S;
        let span_s = match (track.height.first(), track.height.last()) {
            (Some(first), Some(last)) if is_dense && last.0 - first.0 >= least_s => {
                last.0 - first.0
            }
            _ => {
                return Err(NoSea::Heights {
                    count: track.height.len(),
                    step_s,
                    least_s,
                });
            }
        };
        let block_s = (span_s / BLOCKS).clamp(BLOCK_S.0, BLOCK_S.1);
        let length = (block_s / step_s).round() as usize;
        let hz: Vec<f64> = frequencies(step_s, length);
        let starts = starts(track.height, step_s, length);
        let blocks: Vec<Block> = starts
            .iter()
            .map(|start_s| Block::of(track, *start_s, step_s, length, &hz))
            .collect();
        let slow = |block: &&Block| block.drift_m_s.length() <= SLOW_M_S;
        let used: Vec<&Block> = blocks.iter().filter(slow).collect();
        if used.len() < BLOCKS_MIN {
            let mut speeds: Vec<f64> = blocks.iter().map(|b| b.drift_m_s.length()).collect();
            speeds.sort_by(f64::total_cmp);
            let speed_m_s = speeds.get(speeds.len() / 2).copied().unwrap_or(0.0);
            return Err(NoSea::UnderWay { speed_m_s, block_s });
        }
        let averages = Averages::of(&used);
        let noise = noise_density(&hz, &averages.all.density);
        let is_free = |start_s: &f64| {
            let until_s = start_s + block_s;
            let is_off = |thrust: &&Series| {
                let during = |(at_s, _): &&(f64, f64)| (*start_s..until_s).contains(at_s);
                thrust.iter().filter(during).all(|(_, value)| *value == 0.0)
                    && at(thrust, *start_s).is_none_or(|value| value == 0.0)
            };
            track.thrusts.iter().all(is_off)
        };
        let free: Vec<&Block> = starts
            .iter()
            .zip(&blocks)
            .filter(|(start_s, block)| is_free(start_s) && slow(block))
            .map(|(_, block)| block)
            .collect();
        Ok(ObservedSea {
            waves: waves(&hz, &averages, noise),
            drift: drift(&free),
            noise_m: (noise * 0.5 / step_s).sqrt(),
            block_s,
            blocks: [used.len(), blocks.len()],
            spectrum: hz.into_iter().zip(averages.all.density).collect(),
        })
    }

    /// The sea file: the waves, and the drift as a current, minus `by_waves_m_s`, the drift of such
    /// a boat in these waves alone. `log` is the log's name.
    pub fn written(&self, log: &str, by_waves_m_s: Ned) -> String {
        let mut text = format!(
            "# Estimated from {} by squall sea: value ± 95 %.\n",
            log.replace(['\n', '\r'], " ")
        );
        if let Some(waves) = self.waves.first() {
            let ObservedWaves { hs_m, tp_s, .. } = waves;
            let from_deg = waves.from_deg.map_or(
                "from_deg = 0 # not determined".to_owned(),
                |Measured { value, plus_minus }| {
                    format!("from_deg = {value:.0} # ± {plus_minus:.0}")
                },
            );
            let _ = write!(
                text,
                "\n[waves]\nhs_m = {:.3} # ± {:.3}\ntp_s = {:.2} # ± {:.2}\n{from_deg}\n",
                hs_m.value, hs_m.plus_minus, tp_s.value, tp_s.plus_minus
            );
        }
        if let Some(ObservedDrift {
            speed_m_s,
            toward_deg,
        }) = self.drift
        {
            let drift_m_s = Ned::toward_deg(toward_deg).scaled(speed_m_s.value);
            let current_m_s = drift_m_s - by_waves_m_s;
            let _ = write!(
                text,
                "\n# The boat's drift, minus the drift due to these waves. It includes the effect of the wind, \
                 which this file omits.\n[current]\nspeed_m_s = {:.3} # ± {:.3}\ntoward_deg = {:.0}\n",
                current_m_s.length(),
                speed_m_s.plus_minus,
                compass_deg_from_rad(current_m_s.direction_rad())
            );
        }
        text
    }
}

/// The frequencies of a block's spectrum.
fn frequencies(step_s: f64, length: usize) -> Vec<f64> {
    let most_hz = f64::min(BAND_HZ.1, OF_NYQUIST * 0.5 / step_s);
    let all = (1..length).map(|i| i as f64 / (length as f64 * step_s));
    all.filter(|hz| (BAND_HZ.0..=most_hz).contains(hz))
        .collect()
}

/// The starts of blocks of this many steps without a gap.
fn starts(height: &Series, step_s: f64, length: usize) -> Vec<f64> {
    let block_s = step_s * length as f64;
    let mut starts = vec![];
    let mut start_s = height[0].0;
    for pair in height.windows(2) {
        if pair[1].0 - pair[0].0 > GAP_MAX_S {
            start_s = pair[1].0;
        } else if pair[1].0 - start_s >= block_s {
            starts.push(start_s);
            start_s += block_s;
        }
    }
    starts
}

/// The value at a time by linear interpolation; `None` outside.
fn at(series: &Series, at_s: f64) -> Option<f64> {
    let next = series.partition_point(|(time_s, _)| *time_s <= at_s);
    let (before_s, before) = *series.get(next.checked_sub(1)?)?;
    let Some((after_s, after)) = series.get(next) else {
        return Some(before);
    };
    Some(before + (after - before) * (at_s - before_s) / (after_s - before_s))
}

/// The values of a block on a regular grid, without their linear trend, and their mean.
fn grid(series: &Series, start_s: f64, step_s: f64, length: usize) -> (Vec<f64>, f64) {
    let value = |i: usize| at(series, start_s + step_s * i as f64).unwrap_or(0.0);
    let mut values: Vec<f64> = (0..length).map(value).collect();
    let mean = values.iter().sum::<f64>() / length as f64;
    let middle = 0.5 * (length as f64 - 1.0);
    let off = |i: usize| i as f64 - middle;
    let slope: f64 = values.iter().enumerate().map(|(i, v)| off(i) * v).sum();
    let slope = slope / (0..length).map(|i| off(i) * off(i)).sum::<f64>();
    for (i, value) in values.iter_mut().enumerate() {
        *value -= mean + slope * off(i);
    }
    (values, mean)
}

impl Block {
    fn of(track: &Track<'_>, start_s: f64, step_s: f64, length: usize, hz: &[f64]) -> Block {
        let (height, _) = grid(track.height, start_s, step_s, length);
        let (north, north_m_s) = grid(track.north, start_s, step_s, length);
        let (east, east_m_s) = grid(track.east, start_s, step_s, length);
        let mut block = Block {
            density: vec![0.0; hz.len()],
            toward: vec![Ned::default(); hz.len()],
            drift_m_s: Ned {
                north: north_m_s,
                east: east_m_s,
            },
        };
        let scale = 2.0 * step_s / TAPERS as f64;
        for taper in 1..=TAPERS {
            let weight = |i: usize| {
                let turn = PI * (taper * (i + 1)) as f64 / (length as f64 + 1.0);
                (2.0 / (length as f64 + 1.0)).sqrt() * math::sin_cos(turn).0
            };
            let weights: Vec<f64> = (0..length).map(weight).collect();
            for (i, hz) in hz.iter().enumerate() {
                let [h, n, e] = [&height, &north, &east]
                    .map(|values| transform(values, &weights, TAU * hz * step_s));
                let product = |a: [f64; 2], b: [f64; 2]| scale * (a[0] * b[0] + a[1] * b[1]);
                block.density[i] += product(h, h);
                block.toward[i].north += product(h, n);
                block.toward[i].east += product(h, e);
            }
        }
        block
    }
}

/// Real and imaginary part of the Fourier sum at `turn_rad` per step.
fn transform(values: &[f64], weights: &[f64], turn_rad: f64) -> [f64; 2] {
    let (sin, cos) = math::sin_cos(turn_rad);
    let mut at = [1.0, 0.0];
    let mut sum = [0.0, 0.0];
    for (value, weight) in values.iter().zip(weights) {
        sum[0] += value * weight * at[0];
        sum[1] += value * weight * at[1];
        at = [at[0] * cos - at[1] * sin, at[0] * sin + at[1] * cos];
    }
    sum
}

/// The mean of blocks, if requested without one of them.
fn mean(blocks: &[&Block], without: Option<usize>) -> Block {
    let mut sum = Block {
        density: vec![0.0; blocks[0].density.len()],
        toward: vec![Ned::default(); blocks[0].density.len()],
        drift_m_s: Ned::default(),
    };
    let others = blocks
        .iter()
        .enumerate()
        .filter(|(i, _)| Some(*i) != without);
    let scale = 1.0 / (blocks.len() - usize::from(without.is_some())) as f64;
    for (_, block) in others {
        for (sum, density) in sum.density.iter_mut().zip(&block.density) {
            *sum += scale * density;
        }
        for (sum, toward) in sum.toward.iter_mut().zip(&block.toward) {
            *sum = *sum + toward.scaled(scale);
        }
        sum.drift_m_s = sum.drift_m_s + block.drift_m_s.scaled(scale);
    }
    sum
}

/// The mean of all blocks, and the means that leave out one block each.
struct Averages {
    all: Block,
    without: Vec<Block>,
}

impl Averages {
    fn of(blocks: &[&Block]) -> Averages {
        Averages {
            all: mean(blocks, None),
            without: (0..blocks.len()).map(|i| mean(blocks, Some(i))).collect(),
        }
    }
}

/// A value of all blocks, and half the width of its 95 % interval, from the values that leave out
/// one block each. `off` is the difference of two values.
fn jackknife(
    averages: &Averages,
    of: impl Fn(&Block) -> Option<f64>,
    off: impl Fn(f64, f64) -> f64,
) -> Option<Measured> {
    let value = of(&averages.all)?;
    let count = averages.without.len();
    let mut squares = 0.0;
    for block in &averages.without {
        let difference = off(of(block)?, value);
        squares += difference * difference;
    }
    let deviation = ((count as f64 - 1.0) / count as f64 * squares).sqrt();
    Some(Measured {
        value,
        plus_minus: student_975(count) * deviation,
    })
}

/// The density of white noise: that of the highest fifth of the band, if no waves are left there;
/// otherwise 0.
fn noise_density(hz: &[f64], density: &[f64]) -> f64 {
    let tail = hz.len() - hz.len() / 5;
    let peak = peak(density);
    if tail == hz.len() || peak.is_none_or(|peak| hz[tail] < 3.0 * hz[peak.at]) {
        return 0.0;
    }
    density[tail..].iter().sum::<f64>() / (hz.len() - tail) as f64
}

/// The highest density after the initial fall that slow errors of the receiver cause in the
/// spectrum.
#[derive(Clone, Copy)]
struct Peak {
    /// Its index.
    at: usize,
    /// The index of the foot of that initial fall.
    foot: usize,
}

fn peak(density: &[f64]) -> Option<Peak> {
    let foot = density.windows(2).position(|pair| pair[1] > pair[0])?;
    let later = (foot..density.len()).max_by(|a, b| density[*a].total_cmp(&density[*b]));
    later.map(|at| Peak { at, foot })
}

/// The frequency of a peak: the centroid of the part above half its height, weighted by the fourth
/// power of density, because a wave spectrum is wider above its peak (Young 1995).
fn centroid(hz: &[f64], density: &[f64], at: usize) -> f64 {
    let is_high = |i: &usize| density[*i] >= 0.5 * density[at];
    let low = (0..at).rev().take_while(is_high).last().unwrap_or(at);
    let high = (at..hz.len()).take_while(is_high).last().unwrap_or(at);
    let weight = |i: usize| {
        let square = density[i] * density[i] / (density[at] * density[at]);
        square * square
    };
    let sum: f64 = (low..=high).map(weight).sum();
    (low..=high).map(|i| hz[i] * weight(i)).sum::<f64>() / sum
}

fn waves(hz: &[f64], averages: &Averages, noise: f64) -> Vec<ObservedWaves> {
    let density = &averages.all.density;
    let Some(Peak { at, foot }) = peak(density) else {
        return vec![];
    };
    // A spectrum that rises from its first frequency on has no initial fall.
    let is_slope = foot > 0 && density[at] < CLEAR * density[foot];
    if is_slope || density[at] < CLEAR * noise {
        return vec![];
    }
    let whole = foot..hz.len();
    let parts = match second(density, at, foot) {
        None => vec![whole],
        Some(other) => {
            let lowest = |a: &usize, b: &usize| density[*a].total_cmp(&density[*b]);
            let valley = (at.min(other)..at.max(other)).min_by(lowest).unwrap_or(at);
            vec![foot..valley, valley..hz.len()]
        }
    };
    let part = |range: Range<usize>| part(hz, averages, range, noise);
    let mut waves: Vec<ObservedWaves> = parts.into_iter().filter_map(part).collect();
    waves.sort_by(|a, b| b.hs_m.value.total_cmp(&a.hs_m.value));
    waves
}

/// The waves in a range of the frequencies, with their peak.
fn part(hz: &[f64], averages: &Averages, range: Range<usize>, noise: f64) -> Option<ObservedWaves> {
    let width_hz = hz[1] - hz[0];
    let height = |block: &Block| {
        let above: f64 = block.density[range.clone()].iter().map(|d| d - noise).sum();
        Some(4.0 * (width_hz * above).max(0.0).sqrt())
    };
    let period = |block: &Block| {
        let [hz, density] = [hz, &block.density].map(|all| &all[range.clone()]);
        let highest = |a: &usize, b: &usize| density[*a].total_cmp(&density[*b]);
        let at = (0..density.len()).max_by(highest)?;
        Some(1.0 / centroid(hz, density, at))
    };
    let from = |block: &Block| {
        let toward = block.toward[range.clone()].iter();
        let toward = toward.fold(Ned::default(), |sum, toward| sum + *toward);
        // In deep water, the water moves forwards under a crest at the same peak speed as the
        // surface rises.
        let part = hz.iter().zip(&block.density).take(range.end);
        let part = part.skip(range.start);
        let rising: f64 = part.map(|(hz, density)| TAU * hz * density).sum();
        (toward.length() > MOVES * rising)
            .then(|| compass_deg_from_rad(toward.direction_rad() + PI))
    };
    let turned = |a: f64, b: f64| wrap_pi((a - b).to_radians()).to_degrees();
    let hs_m = jackknife(averages, height, |a, b| a - b)?;
    let from_deg = jackknife(averages, from, turned)
        .filter(|from| from.plus_minus.is_finite() && from.plus_minus < VAGUE_DEG);
    // The spectrum is wider above its peak, which shifts the estimate by up to half the resolution.
    let Measured { value, plus_minus } = jackknife(averages, period, |a, b| a - b)?;
    let resolution_s = 0.5 * width_hz * value * value;
    let tp_s = Measured {
        value,
        plus_minus: math::length(plus_minus, resolution_s),
    };
    (hs_m.value > hs_m.plus_minus).then_some(ObservedWaves {
        hs_m,
        tp_s,
        from_deg,
    })
}

/// The highest other peak, if it is more than a third as high and separated from the first by a
/// valley less than half its own height.
fn second(density: &[f64], first: usize, foot: usize) -> Option<usize> {
    let is_apart = |i: &usize| {
        let between = (first.min(*i)..=first.max(*i)).map(|j| density[j]);
        between.fold(f64::INFINITY, f64::min) < 0.5 * density[*i]
    };
    let others = (foot + 1..density.len()).filter(is_apart);
    let highest = others.max_by(|a, b| density[*a].total_cmp(&density[*b]))?;
    (density[highest] > density[first] / 3.0).then_some(highest)
}

fn drift(blocks: &[&Block]) -> Option<ObservedDrift> {
    if blocks.len() < BLOCKS_MIN {
        return None;
    }
    let averages = Averages::of(blocks);
    let toward = averages.all.drift_m_s;
    let unit = toward.scaled(1.0 / toward.length().max(f64::MIN_POSITIVE));
    let speed = |block: &Block| Some(block.drift_m_s.dot(unit));
    let speed_m_s = jackknife(&averages, speed, |a, b| a - b)?;
    (speed_m_s.value > speed_m_s.plus_minus).then_some(ObservedDrift {
        speed_m_s,
        toward_deg: compass_deg_from_rad(toward.direction_rad()),
    })
}

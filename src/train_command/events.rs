//! Curves for TensorBoard: a file of events, each a protobuf message in a record with checksums.
//!
//! The formats are TensorFlow's: `tensorflow/core/util/event.proto` and `tensorflow/core/lib/io/record_writer.h`.

use super::files::append;
use crate::output_file;
use anyhow::{Context, Result};
use learn::train::Progress;
use prost::Message;
use std::path::{Path, PathBuf};

/// What TensorBoard knows such files by is `tfevents`.
const NAME: &str = "events.out.tfevents.squall";
/// What the first event says.
const VERSION: &str = "brain.Event:2";
/// Added to a checksum, so that one of a text that contains checksums is not weak.
const MASK: u32 = 0xa282_ead8;

/// A point in time at which something was measured.
#[derive(Clone, PartialEq, Message)]
struct Event {
    /// Seconds since 1970.
    #[prost(double, tag = "1")]
    wall_time_s: f64,
    /// Samples learnt from.
    #[prost(int64, tag = "2")]
    step: i64,
    #[prost(string, optional, tag = "3")]
    file_version: Option<String>,
    #[prost(message, optional, tag = "5")]
    summary: Option<Summary>,
}

#[derive(Clone, PartialEq, Message)]
struct Summary {
    #[prost(message, repeated, tag = "1")]
    value: Vec<Value>,
}

#[derive(Clone, PartialEq, Message)]
struct Value {
    #[prost(string, tag = "1")]
    tag: String,
    #[prost(float, optional, tag = "2")]
    simple_value: Option<f32>,
}

/// The file of events of a training.
pub(super) struct Events {
    path: PathBuf,
}

impl Events {
    /// The file as it is before a training, or where one with so many samples is taken up again: later events are dropped.
    pub(super) fn open(folder: &Path, samples: u64) -> Result<Events> {
        let path = folder.join(NAME);
        let mut bytes =
            record(&Event { wall_time_s: unix_s(), step: 0, file_version: Some(VERSION.to_owned()), summary: None });
        if samples > 0 && path.exists() {
            let kept = std::fs::read(&path).with_context(|| format!("cannot read {}", path.display()))?;
            let is_kept = |event: &Event| u64::try_from(event.step).is_ok_and(|step| step <= samples);
            bytes = read(&kept).filter(is_kept).flat_map(|event| record(&event)).collect();
        }
        output_file::write(&path, "the curves", bytes)?;
        Ok(Events { path })
    }

    /// Notes an update.
    pub(super) fn update(&self, progress: &Progress) -> Result<()> {
        let mut event = Event { wall_time_s: unix_s(), step: i64::try_from(progress.samples)?, ..Event::default() };
        event.summary = Some(Summary { value: values(progress) });
        append(&self.path, record(&event))
    }
}

fn values(progress: &Progress) -> Vec<Value> {
    let of_all = [("stage", progress.stage as f64), ("reward", f64::from(progress.reward))];
    // What the algorithm does not have is no point of a curve.
    let learnt = progress.learnt.named().into_iter().filter_map(|(name, value)| Some((name, f64::from(value?))));
    let mut all: Vec<(String, f64)> =
        of_all.into_iter().chain(learnt).map(|(name, value)| (format!("learning/{name}"), value)).collect();
    if let Some(evaluated) = &progress.evaluated {
        all.push(("evaluation/won".to_owned(), evaluated.won()));
        for (name, played) in &evaluated.played {
            let [own, theirs] = played.points;
            all.push((format!("won/{name}"), played.won()));
            all.push((format!("points_ahead/{name}"), own - theirs));
            all.push((format!("left_field/{name}"), played.left_field));
        }
    }
    all.into_iter().map(|(tag, value)| Value { tag, simple_value: Some(value as f32) }).collect()
}

/// An event as it stands in a file: its length, a checksum of that, the event, a checksum of that.
fn record(event: &Event) -> Vec<u8> {
    let event = event.encode_to_vec();
    let length = (event.len() as u64).to_le_bytes();
    [&length[..], &masked(&length), &event, &masked(&event)].concat()
}

/// The events of a file, up to one that is cut off or damaged.
fn read(mut bytes: &[u8]) -> impl Iterator<Item = Event> {
    std::iter::from_fn(move || {
        let (length, rest) = bytes.split_first_chunk::<8>()?;
        let (sum, rest) = rest.split_first_chunk::<4>()?;
        let (event, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(*length)).ok()?)?;
        let (event_sum, rest) = rest.split_first_chunk::<4>()?;
        bytes = rest;
        (*sum == masked(length) && *event_sum == masked(event)).then(|| Event::decode(event).ok())?
    })
}

fn masked(bytes: &[u8]) -> [u8; 4] {
    crc32c::crc32c(bytes).rotate_right(15).wrapping_add(MASK).to_le_bytes()
}

fn unix_s() -> f64 {
    recording::utc::now_ns() as f64 * 1e-9
}

#[cfg(test)]
mod tests {
    use super::*;

    /// As TensorFlow writes the first event of a file: `tf.summary.create_file_writer`, at 1.5 s.
    #[test]
    fn a_record_is_tensorflows() {
        let event = Event { wall_time_s: 1.5, file_version: Some(VERSION.to_owned()), ..Event::default() };
        let bytes = record(&event);
        assert_eq!(bytes[..8], 24u64.to_le_bytes());
        // The masked checksum of the length 24, which begins all such files.
        assert_eq!(bytes[8..12], [0xa3, 0x7f, 0x4b, 0x22]);
        assert_eq!(bytes[12..36], *b"\x09\0\0\0\0\0\0\xf8\x3f\x1a\x0dbrain.Event:2");
    }

    #[test]
    fn what_is_cut_off_or_damaged_ends_the_file() {
        let events = [1, 2, 3].map(|step| Event { step, ..Event::default() });
        let bytes: Vec<u8> = events.iter().flat_map(record).collect();
        let whole: Vec<Event> = read(&bytes).collect();
        assert_eq!(whole, events);
        assert_eq!(read(&bytes[..bytes.len() - 1]).count(), 2);
        let mut damaged = bytes.clone();
        let middle = damaged.len() / 2;
        damaged[middle] ^= 1;
        assert_eq!(read(&damaged).count(), 1);
    }
}

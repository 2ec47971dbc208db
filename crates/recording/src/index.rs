//! Index of the messages in a file: runs of records, which are read again on demand.
//!
//! A recording of a whole day has ten million messages. Storing the position of each would take
//! hundreds of megabytes.

use crate::records::{self, Record};
use crate::source::Source;
use parking_lot::Mutex;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Maximum number of messages in a run of records.
const MESSAGES_MAX: usize = 256;

/// The position of a message in a file.
#[derive(Clone, Copy, Debug)]
pub(crate) struct IndexEntry {
    pub(crate) channel: u16,
    pub(crate) number: u32,
    /// Time by the recording's own clock, ns.
    pub(crate) log_ns: u64,
    pub(crate) utc_ns: u64,
    pub(crate) from: u64,
    pub(crate) length: u32,
}

impl IndexEntry {
    /// The entry of a message record with this byte range; `None` for other records.
    fn of(record: &Record<'_>, place: &Range<u64>) -> Option<IndexEntry> {
        let Record::Message { header, .. } = record else {
            return None;
        };
        Some(IndexEntry {
            channel: header.channel_id,
            number: header.sequence,
            log_ns: header.log_time,
            utc_ns: header.publish_time,
            from: place.start,
            // Records longer than this are not read.
            length: u32::try_from(place.end - place.start).unwrap_or(u32::MAX),
        })
    }
}

/// A run of records: consecutive messages in one chunk or outside chunks.
#[derive(Debug)]
struct Stretch {
    /// The number of messages before it.
    first: usize,
    /// Byte range from its first record to the end of its last.
    place: Range<u64>,
}

/// The index of the messages in a file.
#[derive(Debug, Default)]
pub(crate) struct Index {
    stretches: Vec<Stretch>,
    /// The number of messages.
    pub(crate) count: usize,
    /// The number of messages, by channel.
    pub(crate) counts: BTreeMap<u16, usize>,
    /// The first and the last wall-clock time, ns.
    span_utc_ns: Option<(u64, u64)>,
    /// Start of the chunk that contains the message added last.
    chunk: Option<u64>,
    /// The most recently used run of records, with its messages.
    recent: Mutex<Option<(usize, Arc<[IndexEntry]>)>>,
}

impl Index {
    /// Adds a record if it is a message: the next in the file, in the chunk that starts at `chunk`.
    pub(crate) fn add(&mut self, record: &Record<'_>, place: &Range<u64>, chunk: u64) {
        let Some(entry) = IndexEntry::of(record, place) else {
            return;
        };
        let is_full = self
            .stretches
            .last()
            .is_none_or(|last| self.count - last.first >= MESSAGES_MAX);
        if is_full || self.chunk != Some(chunk) {
            let from = place.start.saturating_sub(records::MESSAGE_PREFIX);
            self.stretches.push(Stretch {
                first: self.count,
                place: from..place.end,
            });
        }
        if let Some(last) = self.stretches.last_mut() {
            last.place.end = place.end;
        }
        self.chunk = Some(chunk);
        self.count += 1;
        *self.counts.entry(entry.channel).or_default() += 1;
        let (first, last) = self.span_utc_ns.unwrap_or((entry.utc_ns, entry.utc_ns));
        self.span_utc_ns = Some((first.min(entry.utc_ns), last.max(entry.utc_ns)));
    }

    /// Wall-clock time from the first to the last message, ns.
    pub(crate) fn span_utc_ns(&self) -> u64 {
        self.span_utc_ns.map_or(0, |(first, last)| last - first)
    }

    /// The message at a position among all messages; `None` if the file can no longer be read.
    ///
    /// # Panics
    /// If `place` is out of range.
    pub(crate) fn entry(&self, source: &Source, place: usize) -> Option<IndexEntry> {
        assert!(place < self.count, "message {place} of {}", self.count);
        let number = self
            .stretches
            .partition_point(|stretch| stretch.first <= place)
            - 1;
        let stretch = &self.stretches[number];
        let mut recent = self.recent.lock();
        let entries = match &*recent {
            Some((known, entries)) if *known == number => Arc::clone(entries),
            _ => {
                let entries: Arc<[IndexEntry]> = entries_in(source, stretch.place.clone()).into();
                *recent = Some((number, Arc::clone(&entries)));
                entries
            }
        };
        entries.get(place - stretch.first).copied()
    }
}

/// The messages in a run of records.
fn entries_in(source: &Source, place: Range<u64>) -> Vec<IndexEntry> {
    let mut entries = Vec::new();
    let read = records::records_in(source, place, &mut |record, place| {
        entries.extend(IndexEntry::of(&record, &place))
    });
    // The first read succeeded; if this one fails, the missing messages count as unreadable.
    drop(read);
    entries
}

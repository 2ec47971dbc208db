//! The recording of a gateway while it runs: in a thread of its own, so that a slow disk holds up nothing.

use crate::bridge::{Event, Input, Output, Plan};
use crate::record::{Moment, RecordError, Recorder};
use crate::utc;
use game::SimTime;
use std::fs::File;
use std::io::BufWriter;
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, sync_channel};
use std::thread::JoinHandle;

/// Turns that may wait to be written.
const QUEUE: usize = 8192;

enum Entry {
    Turn(Moment, Input, Output),
    Remark(Moment, Event),
}

/// The recording under way.
pub(super) struct Logbook {
    queue: Option<SyncSender<Box<Entry>>>,
    writer: Option<JoinHandle<()>>,
    lost: Arc<AtomicU64>,
}

impl Logbook {
    /// Begins a recording in a file.
    pub(super) fn open(path: &Path, plan: &Plan) -> Result<Logbook, RecordError> {
        let file = File::create(path).map_err(mcap::McapError::from)?;
        let recorder = Recorder::begin(BufWriter::new(file), plan)?;
        let (queue, entries) = sync_channel(QUEUE);
        let lost = Arc::new(AtomicU64::new(0));
        let counter = Arc::clone(&lost);
        let writer = std::thread::spawn(move || write(recorder, &entries, &counter));
        Ok(Logbook { queue: Some(queue), writer: Some(writer), lost })
    }

    pub(super) fn turn(&self, at: SimTime, input: Input, out: &Output) {
        self.put(Entry::Turn(Moment { at, utc_ns: utc::now_ns() }, input, out.clone()));
    }

    pub(super) fn remark(&self, at: SimTime, text: &str) {
        self.put(Entry::Remark(Moment { at, utc_ns: utc::now_ns() }, Event::Remark(text.to_owned())));
    }

    /// How much could not be recorded.
    pub(super) fn lost(&self) -> u64 {
        self.lost.load(Ordering::Relaxed)
    }

    fn put(&self, entry: Entry) {
        let Some(queue) = &self.queue else { return };
        // Full, or its writer is gone: either way this is not recorded.
        if queue.try_send(Box::new(entry)).is_err() {
            self.lost.fetch_add(1, Ordering::Relaxed);
        }
    }
}

impl Drop for Logbook {
    fn drop(&mut self) {
        self.queue = None;
        // A writer that failed has counted what it lost.
        self.writer.take().map(JoinHandle::join).into_iter().for_each(drop);
    }
}

fn write(mut recorder: Recorder<BufWriter<File>>, entries: &Receiver<Box<Entry>>, lost: &AtomicU64) {
    for entry in entries {
        let written = match entry.as_ref() {
            Entry::Turn(moment, input, out) => recorder.turn(*moment, input, out),
            Entry::Remark(moment, event) => recorder.remark(*moment, event),
        };
        lost.fetch_add(u64::from(written.is_err()), Ordering::Relaxed);
    }
    lost.fetch_add(u64::from(recorder.end().is_err()), Ordering::Relaxed);
}

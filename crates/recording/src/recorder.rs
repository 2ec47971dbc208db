//! The thread that writes a recording. The game never waits for it.

use crate::writer::{Entry, Opening, Writer};
use crate::{Facts, NewFile, RecordError, utc};
use messages::run_state::RecordingState;
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::sync::{Arc, OnceLock};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Period of flushes to the system. Each flush closes a chunk, whose index entry (about 500 bytes)
/// stays in memory until the file ends. With four flushes per second, that was several megabytes an
/// hour.
const FLUSH: Duration = Duration::from_secs(1);
/// Time for which entries accumulate: waking the thread for each one would cost the game more than
/// the writing itself.
const GATHER: Duration = Duration::from_millis(20);
/// Size of the write buffer, bytes.
const BUFFER: usize = 1 << 16;
/// Memory limit for entries waiting for the disk, bytes.
const WAITING_BYTES: usize = 128 << 20;
/// Maximum number of waiting entries.
const WAITING: usize = 1 << 14;

/// Writes a recording on its own thread. Dropping it completes the file without a result.
pub struct Recorder {
    path: PathBuf,
    jobs: SyncSender<Job>,
    /// Maximum size of waiting data, bytes.
    waiting_max: usize,
    shared: Arc<Shared>,
    /// `None` after the end.
    thread: Option<JoinHandle<()>>,
}

enum Job {
    Write(Entry, u64),
    End(Facts),
}

#[derive(Default)]
struct Shared {
    bytes: AtomicU64,
    dropped: AtomicU64,
    /// Size of waiting entries.
    waiting_bytes: AtomicUsize,
    failed: OnceLock<String>,
}

impl Recorder {
    /// Starts recording.
    ///
    /// # Errors
    /// [`RecordError`] if the opening cannot be written.
    ///
    /// # Panics
    /// Never: a new file is used once.
    pub fn begin(mut file: NewFile, opening: &Opening) -> Result<Recorder, RecordError> {
        let open = file
            .file
            .as_ref()
            .expect("a new file is there until it is used")
            .try_clone()?;
        let begun = Recorder::over(
            BufWriter::with_capacity(BUFFER, open),
            file.path().to_owned(),
            opening,
            WAITING_BYTES,
        )?;
        file.file = None;
        Ok(begun)
    }

    fn over<W: Write + Seek + Send + 'static>(
        file: W,
        path: PathBuf,
        opening: &Opening,
        waiting_max: usize,
    ) -> Result<Recorder, RecordError> {
        let writer = Writer::begin(file, opening)?;
        let (sender, jobs) = sync_channel(WAITING);
        let shared = Arc::<Shared>::default();
        let theirs = Arc::clone(&shared);
        let size_of = path.clone();
        let thread = std::thread::Builder::new().name("recorder".to_owned());
        // The recorder runs in the sim's process, not as an observer on the network: the sim would
        // have to wait for an observer, or the observer would miss messages. The game passes
        // copies; `benches/recording.rs` measures the cost.
        let thread = thread.spawn(move || write(writer, &jobs, &theirs, &size_of))?;
        Ok(Recorder {
            path,
            jobs: sender,
            waiting_max,
            shared,
            thread: Some(thread),
        })
    }

    /// Records an entry; drops and counts it if the disk is too slow.
    pub fn record(&self, entry: Entry) {
        let size = entry.size();
        let bytes = self.shared.waiting_bytes.fetch_add(size, Ordering::Relaxed) + size;
        // A slow disk must never delay a game. `--check` reports the gaps and does not mistake them
        // for divergence.
        let has_room = bytes <= self.waiting_max;
        let is_taken = has_room && self.jobs.try_send(Job::Write(entry, utc::now_ns())).is_ok();
        if !is_taken {
            self.shared.written(size);
            self.shared.dropped.fetch_add(1, Ordering::Relaxed);
        }
    }

    /// The state of the recording.
    pub fn state(&self) -> RecordingState {
        RecordingState {
            file: self.path.display().to_string(),
            bytes: self.shared.bytes.load(Ordering::Relaxed),
            dropped: self.shared.dropped.load(Ordering::Relaxed),
            failed: self.shared.failed.get().cloned(),
        }
    }

    /// Completes the file with this result, to which it adds the number of dropped messages.
    /// Returns the final state.
    pub fn end(mut self, mut result: Facts) -> RecordingState {
        result.insert(
            "dropped".to_owned(),
            self.shared.dropped.load(Ordering::Relaxed).to_string(),
        );
        self.complete(result);
        self.state()
    }

    /// Completes the file, once.
    fn complete(&mut self, result: Facts) {
        let Some(thread) = self.thread.take() else {
            return;
        };
        // If the thread has ended, it has already reported the reason.
        drop(self.jobs.send(Job::End(result)));
        if thread.join().is_err() {
            self.shared
                .failed
                .get_or_init(|| "the recorder's thread panicked".to_owned());
        }
    }
}

impl Drop for Recorder {
    fn drop(&mut self) {
        self.complete(Facts::new());
    }
}

impl Shared {
    /// Removes an entry of this size from the count of waiting data.
    fn written(&self, size: usize) {
        self.waiting_bytes.fetch_sub(size, Ordering::Relaxed);
    }
}

/// Writes entries until the end. On a write error, it drops entries and reports the reason.
fn write<W: Write + Seek>(
    mut writer: Writer<W>,
    jobs: &Receiver<Job>,
    shared: &Shared,
    path: &Path,
) {
    let mut flushed = now();
    let update_size = || {
        let size = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
        shared.bytes.store(size, Ordering::Relaxed);
    };
    let failed = |error: &RecordError| drop(shared.failed.set(error.to_string()));
    let is_broken = || shared.failed.get().is_some();
    let result = loop {
        let written = match jobs.try_recv() {
            Ok(Job::Write(entry, utc_ns)) => {
                let written = if is_broken() {
                    Ok(())
                } else {
                    writer.write(&entry, utc_ns)
                };
                shared
                    .dropped
                    .fetch_add(u64::from(is_broken()), Ordering::Relaxed);
                shared.written(entry.size());
                written
            }
            Ok(Job::End(result)) => break result,
            Err(TryRecvError::Empty) => {
                rest();
                Ok(())
            }
            Err(TryRecvError::Disconnected) => break Facts::new(),
        };
        let is_due = now().duration_since(flushed) >= FLUSH;
        let written = if is_due && !is_broken() {
            written.and_then(|()| writer.flush())
        } else {
            written
        };
        if is_due {
            flushed = now();
            update_size();
        }
        if let Err(error) = written {
            failed(&error);
        }
    };
    if let (false, Err(error)) = (is_broken(), writer.end(result)) {
        failed(&error);
    }
    update_size();
}

/// Lets entries accumulate, so that the game's threads need not wake this one for each.
#[expect(
    clippy::disallowed_methods,
    reason = "entries are written in batches, by the clock"
)]
fn rest() {
    std::thread::sleep(GATHER);
}

#[expect(
    clippy::disallowed_methods,
    reason = "writes are timed by the wall clock"
)]
fn now() -> Instant {
    Instant::now()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Bag, Decision, FRAME, INPUTS, Kind};
    use messages::{Frame, Message, Stamp};
    use primitives::SimTime;
    use std::io::{Cursor, ErrorKind, SeekFrom};
    use std::sync::Mutex;

    /// A disk with space for a limited number of bytes. It blocks while another thread holds the
    /// lock.
    #[derive(Clone)]
    struct Disk(Arc<Mutex<Cursor<Vec<u8>>>>, usize);

    impl Disk {
        fn of(room: usize) -> Disk {
            Disk(Arc::default(), room)
        }
    }

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            let mut written = self.0.lock().expect("nobody panics");
            let room = self.1.saturating_sub(written.get_ref().len());
            if room == 0 {
                Err(ErrorKind::StorageFull.into())
            } else {
                written.write(&bytes[..bytes.len().min(room)])
            }
        }
        fn flush(&mut self) -> std::io::Result<()> {
            Ok(())
        }
    }

    impl Seek for Disk {
        fn seek(&mut self, to: SeekFrom) -> std::io::Result<u64> {
            self.0.lock().expect("nobody panics").seek(to)
        }
    }

    fn opening() -> Opening {
        Opening {
            kind: Kind::Game,
            began_utc_ns: 0,
            facts: Facts::new(),
            more: vec![],
            teams: vec![],
        }
    }

    #[test]
    fn a_full_disk_is_told_and_everything_after_it_counted() {
        let full = |room| Recorder::over(Disk::of(room), PathBuf::new(), &opening(), WAITING_BYTES);
        assert!(
            full(4).is_err_and(|e| e.to_string().contains("no storage space")),
            "not even the beginning fits"
        );
        let recorder = full(20_000).expect("it begins");
        (0..2000).for_each(|_| recorder.record(Entry::Decision(Box::default())));
        let state = recorder.end(Facts::new());
        assert!(
            state
                .failed
                .is_some_and(|reason| reason.contains("no storage space")),
            "{:?}",
            state.dropped
        );
    }

    #[test]
    fn a_slow_disk_loses_the_newest_data_and_does_not_delay_the_game() {
        let disk = Disk::of(usize::MAX);
        let recorder =
            Recorder::over(disk.clone(), PathBuf::new(), &opening(), 100_000).expect("it begins");
        let stuck = disk.0.lock().expect("nobody panics");
        let mut recorded = 0;
        while recorder.state().dropped < 3 {
            let stamp = Stamp {
                valid_ns: SimTime(recorded),
                seq: recorded as u64,
                version: Frame::VERSION,
            };
            let frame = Frame {
                stamp,
                ..Frame::default()
            }
            .into();
            recorder.record(Entry::Decision(Box::new(Decision {
                frame,
                ..Decision::default()
            })));
            recorded += 1;
        }
        drop(stuck);
        let state = recorder.end(Facts::new());
        assert_eq!((state.dropped, state.failed), (3, None));
        let bag =
            Bag::of(disk.0.lock().expect("nobody panics").get_ref().clone()).expect("a recording");
        assert_eq!(
            bag.result.as_ref().map(|result| result["dropped"].as_str()),
            Some("3")
        );
        for topic in [FRAME, INPUTS] {
            assert_eq!(bag.on(topic).count() + 3, recorded as usize, "{topic}");
        }
    }
}

//! The thread that writes a recording while the game goes on, which never waits for it.

use super::clock;
use super::writer::{Note, Writer};
use super::{Ending, Header, RecordError};
use game::run_state::RecordingState;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, TrySendError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// What was recorded is handed to the system this often.
const FLUSH: Duration = Duration::from_millis(250);
/// So long the writer leaves notes to gather: to be woken for each would cost the game more than the writing does.
const GATHER: Duration = Duration::from_millis(20);
/// Memory that notes may take up that wait for the disk, bytes.
const WAITING_BYTES: usize = 128 << 20;

/// Records a game on a thread of its own.
pub struct Recorder {
    path: PathBuf,
    notes: SyncSender<Job>,
    shared: Arc<Shared>,
    thread: JoinHandle<()>,
}

enum Job {
    Note(Note, u64),
    End(Box<Ending>),
}

#[derive(Default)]
struct Shared {
    bytes: AtomicU64,
    dropped: AtomicU64,
    failed: Mutex<Option<String>>,
}

impl Recorder {
    /// Begins to record into a new file; an old one of this name is not touched.
    ///
    /// # Errors
    /// [`RecordError`] if the file cannot be made or does not take the beginning.
    pub fn begin(path: &Path, header: &Header) -> Result<Recorder, RecordError> {
        let file = File::create_new(path)?;
        let writer = Writer::begin(BufWriter::with_capacity(1 << 16, file), header)?;
        // What a boat takes up in a turn, with its picture and order.
        let turn_bytes = 2000 + 500 * header.notice.scenario.vehicles.len();
        let (notes, jobs) = sync_channel((WAITING_BYTES / turn_bytes).clamp(64, 16_384));
        let shared = Arc::new(Shared::default());
        let theirs = Arc::clone(&shared);
        let size_of = path.to_owned();
        let thread = std::thread::Builder::new().name("recorder".to_owned());
        let thread = thread.spawn(move || write(writer, &jobs, &theirs, &size_of))?;
        Ok(Recorder { path: path.to_owned(), notes, shared, thread })
    }

    /// Records something; drops it, and counts that, where the disk does not keep up.
    pub fn note(&self, note: Note) {
        match self.notes.try_send(Job::Note(note, clock::utc_ns())) {
            Ok(()) => {}
            Err(TrySendError::Full(_) | TrySendError::Disconnected(_)) => {
                self.shared.dropped.fetch_add(1, Ordering::Relaxed);
            }
        }
    }

    /// How it stands.
    #[must_use]
    pub fn state(&self) -> RecordingState {
        RecordingState {
            file: self.path.display().to_string(),
            bytes: self.shared.bytes.load(Ordering::Relaxed),
            dropped: self.shared.dropped.load(Ordering::Relaxed),
            failed: self.shared.failed.lock().unwrap_or_else(PoisonError::into_inner).clone(),
        }
    }

    /// Ends it well, once everything is written, and says how it stands then.
    pub fn end(self, ending: Ending) -> RecordingState {
        let dropped = self.shared.dropped.load(Ordering::Relaxed);
        // A thread that is gone has said why.
        drop(self.notes.send(Job::End(Box::new(Ending { dropped, ..ending }))));
        let mut state = self.state();
        if self.thread.join().is_err() {
            state.failed = Some("its thread broke down".to_owned());
        }
        let bytes = self.shared.bytes.load(Ordering::Relaxed);
        let failed = self.shared.failed.lock().unwrap_or_else(PoisonError::into_inner).clone();
        RecordingState { bytes, failed: state.failed.or(failed), ..state }
    }
}

/// Writes what comes until the end. What cannot be written is dropped, and why is told.
fn write(mut writer: Writer<BufWriter<File>>, jobs: &Receiver<Job>, shared: &Shared, path: &Path) {
    let mut flushed = clock::now();
    let tell_size = || {
        let size = std::fs::metadata(path).map_or(0, |metadata| metadata.len());
        shared.bytes.store(size, Ordering::Relaxed);
    };
    let failed = |error: &RecordError| {
        let mut failed = shared.failed.lock().unwrap_or_else(PoisonError::into_inner);
        failed.get_or_insert_with(|| error.to_string());
    };
    let mut is_broken = false;
    loop {
        let written = match jobs.try_recv() {
            Ok(Job::Note(..)) if is_broken => {
                shared.dropped.fetch_add(1, Ordering::Relaxed);
                Ok(())
            }
            Ok(Job::Note(note, utc_ns)) => writer.note(&note, utc_ns),
            Ok(Job::End(ending)) => {
                if let (false, Err(error)) = (is_broken, writer.end(&ending)) {
                    failed(&error);
                }
                return tell_size();
            }
            Err(TryRecvError::Empty) => {
                clock::rest(GATHER);
                Ok(())
            }
            Err(TryRecvError::Disconnected) => return drop(writer.flush()),
        };
        let now = clock::now();
        let flush = now.duration_since(flushed) >= FLUSH;
        let written = if flush && !is_broken { written.and_then(|()| writer.flush()) } else { written };
        if flush {
            flushed = now;
            tell_size();
        }
        if let Err(error) = written {
            failed(&error);
            is_broken = true;
        }
    }
}

//! The thread that writes a recording while the game goes on, which never waits for it.

use crate::clock;
use crate::writer::{Note, Writer};
use crate::{Ending, Header, RecordError};
use game::run_state::RecordingState;
use std::fs::File;
use std::io::{BufWriter, Seek, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, SyncSender, TryRecvError, sync_channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::thread::JoinHandle;
use std::time::Duration;

/// What was recorded is handed to the system this often.
const FLUSH: Duration = Duration::from_millis(250);
/// So long the writer leaves notes to gather: to be woken for each would cost the game more than the writing does.
const GATHER: Duration = Duration::from_millis(20);
/// Memory that notes may take up that wait for the disk, bytes.
const WAITING_BYTES: usize = 128 << 20;
/// How many they may be.
const WAITING: usize = 1 << 14;

/// Records a game on a thread of its own.
pub struct Recorder {
    path: PathBuf,
    notes: SyncSender<Job>,
    /// How much may wait for the disk, bytes.
    waiting_max: usize,
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
    /// Bytes that notes take up that wait.
    waiting: AtomicUsize,
    failed: Mutex<Option<String>>,
}

/// A new file that a recording is to go into. If none does, it is removed again.
#[derive(Debug)]
pub struct Blank {
    path: PathBuf,
    /// None once it is used.
    file: Option<File>,
}

impl Blank {
    /// Makes the file; an old one of this name is not touched.
    ///
    /// # Errors
    /// [`RecordError`] if it cannot be made.
    pub fn create(path: &Path) -> Result<Blank, RecordError> {
        Ok(Blank { path: path.to_owned(), file: Some(File::create_new(path)?) })
    }
}

impl Drop for Blank {
    fn drop(&mut self) {
        if self.file.is_some() {
            // Then it stays; it is empty.
            drop(std::fs::remove_file(&self.path));
        }
    }
}

impl Recorder {
    /// Begins to record.
    ///
    /// # Errors
    /// [`RecordError`] if the file does not take the beginning.
    ///
    /// # Panics
    /// Never: a blank is used once.
    pub fn begin(mut blank: Blank, header: &Header) -> Result<Recorder, RecordError> {
        let file = blank.file.take().expect("a blank is used once");
        Recorder::over(BufWriter::with_capacity(1 << 16, file), blank.path.clone(), header, WAITING_BYTES)
    }

    fn over<W: Write + Seek + Send + 'static>(
        file: W,
        path: PathBuf,
        header: &Header,
        waiting_max: usize,
    ) -> Result<Recorder, RecordError> {
        let writer = Writer::begin(file, header)?;
        let (notes, jobs) = sync_channel(WAITING);
        let shared = Arc::new(Shared::default());
        let (theirs, size_of) = (Arc::clone(&shared), path.clone());
        let thread = std::thread::Builder::new().name("recorder".to_owned());
        let thread = thread.spawn(move || write(writer, &jobs, &theirs, &size_of))?;
        Ok(Recorder { path, notes, waiting_max, shared, thread })
    }

    /// Records something; drops it, and counts that, where the disk does not keep up.
    pub fn note(&self, note: Note) {
        let size = note.size();
        let waiting = self.shared.waiting.fetch_add(size, Ordering::Relaxed);
        if waiting + size > self.waiting_max || self.notes.try_send(Job::Note(note, clock::utc_ns())).is_err() {
            self.shared.waiting.fetch_sub(size, Ordering::Relaxed);
            self.shared.dropped.fetch_add(1, Ordering::Relaxed);
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
fn write<W: Write + Seek>(mut writer: Writer<W>, jobs: &Receiver<Job>, shared: &Shared, path: &Path) {
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
            Ok(Job::Note(note, utc_ns)) => {
                let written = if is_broken { Ok(()) } else { writer.note(&note, utc_ns) };
                shared.dropped.fetch_add(u64::from(is_broken), Ordering::Relaxed);
                shared.waiting.fetch_sub(note.size(), Ordering::Relaxed);
                written
            }
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{INPUTS, Recording, Turn};
    use game::message::{Frame, GameInfo, Message, Stamp};
    use game::water::Water;
    use game::{Outcome, SimTime};
    use std::io::{Cursor, SeekFrom};

    /// A disk that takes nothing while somebody else has it.
    #[derive(Clone, Default)]
    struct Disk(Arc<Mutex<Cursor<Vec<u8>>>>);

    impl Write for Disk {
        fn write(&mut self, bytes: &[u8]) -> std::io::Result<usize> {
            self.0.lock().expect("nobody panics").write(bytes)
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

    fn header() -> Header {
        let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenarios/games/attack_1v1.toml");
        let scenario = game::scenario::load(&file).unwrap_or_else(|e| panic!("{e}"));
        let notice = GameInfo { version: game::VERSION.to_owned(), pace: String::new(), scenario };
        Header { commit: String::new(), game: String::new(), began_utc_ns: 0, notice, water: Water::default() }
    }

    #[test]
    fn a_disk_that_does_not_keep_up_costs_the_newest_and_the_game_does_not_wait() {
        let disk = Disk::default();
        let recorder = Recorder::over(disk.clone(), PathBuf::new(), &header(), 100_000).expect("it begins");
        let stuck = disk.0.lock().expect("nobody panics");
        let mut noted = 0;
        while recorder.state().dropped < 3 {
            let stamp = Stamp { valid_ns: SimTime(noted), seq: noted as u64, version: Frame::VERSION };
            let frame = Frame { stamp, ..Frame::default() };
            recorder.note(Note::Turn(Box::new(Turn { frame, ..Turn::default() })));
            noted += 1;
        }
        drop(stuck);
        let state = recorder.end(Ending { outcome: Outcome::default(), run: serde_json::Value::Null, dropped: 0 });
        assert_eq!((state.dropped, state.failed), (3, None));
        let recording = Recording::of(disk.0.lock().expect("nobody panics").get_ref().clone()).expect("a recording");
        assert_eq!(recording.ending().map(|ending| ending.dropped), Some(3));
        assert_eq!((recording.frame_count() + 3, recording.on(INPUTS).count() + 3), (noted as usize, noted as usize));
    }
}

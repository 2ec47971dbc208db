//! A thread that prints what a node reports: neither a game nor a gateway waits for a terminal that is held, or for a pipe that
//! nobody reads.

use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

/// Messages that may wait to be printed; more are left out.
const WAITING_MAX: usize = 1024;

/// Prints in a thread of its own.
pub struct Printer<M> {
    messages: SyncSender<M>,
    thread: JoinHandle<()>,
}

impl<M: Send + 'static> Printer<M> {
    /// Begins to print what comes, by `print`.
    pub fn start(mut print: impl FnMut(&M) + Send + 'static) -> Printer<M> {
        let (messages, waiting) = sync_channel::<M>(WAITING_MAX);
        let thread = std::thread::spawn(move || waiting.iter().for_each(|message| print(&message)));
        Printer { messages, thread }
    }

    /// Prints a message, if there is room for it.
    pub fn print(&self, message: M) {
        // All events are in the result of a game too, and in the recording of a gateway.
        drop(self.messages.try_send(message));
    }

    /// Prints the last message, after all that wait.
    pub fn end(self, message: M) {
        // The thread takes messages for as long as this is there; if it panics, it has said so.
        drop(self.messages.send(message));
        drop(self.messages);
        drop(self.thread.join());
    }
}

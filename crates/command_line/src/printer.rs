//! A thread that prints a node's messages, so that neither a game nor a gateway blocks on a
//! suspended terminal or an unread pipe.

use std::sync::mpsc::{SyncSender, sync_channel};
use std::thread::JoinHandle;

/// Maximum number of messages waiting to be printed; further ones are dropped.
const WAITING_MAX: usize = 1024;

/// Prints in a separate thread.
pub struct Printer<M> {
    messages: SyncSender<M>,
    thread: JoinHandle<()>,
}

impl<M: Send + 'static> Printer<M> {
    /// Starts printing messages with `print`.
    pub fn start(mut print: impl FnMut(&M) + Send + 'static) -> Printer<M> {
        let (messages, waiting) = sync_channel::<M>(WAITING_MAX);
        let thread = std::thread::spawn(move || waiting.iter().for_each(|message| print(&message)));
        Printer { messages, thread }
    }

    /// Prints a message, or drops it if too many are waiting.
    pub fn print(&self, message: M) {
        // The result of a game and the recording of a gateway also contain all events.
        drop(self.messages.try_send(message));
    }

    /// Prints the last message, after all waiting ones.
    pub fn end(self, message: M) {
        // The thread receives messages as long as the printer exists; a panic of the thread has
        // already been reported.
        drop(self.messages.send(message));
        drop(self.messages);
        drop(self.thread.join());
    }
}

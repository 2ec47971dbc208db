//! A thread that plays futures of the recorded game, for one page at a time, because each request
//! uses all cores.

use crate::page::message::PageMessage;
use crate::page::request::Question;
use crate::page::view::Changes;
use bus::Watched;
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Plays futures of a recorded game.
pub trait Futures: Send {
    /// What a question can contain: `strategies` and `seas`, by name.
    fn choices(&self) -> Value;

    /// Plays futures until `stop`. Calls `progress` with the number of those played. Returns the
    /// result for the page.
    ///
    /// # Errors
    /// The fault in the question, or the reason why futures cannot be played.
    fn play(
        &mut self,
        question: &Question,
        stop: &AtomicBool,
        progress: &mut dyn FnMut(u32),
    ) -> Result<Value, String>;
}

#[derive(Default)]
struct Queue {
    /// By viewer.
    questions: BTreeMap<u64, Question>,
    /// By viewer: the newest message.
    messages: BTreeMap<u64, String>,
    /// The viewer whose question is in progress, and the flag that stops it.
    current: Option<(u64, Arc<AtomicBool>)>,
    is_closed: bool,
}

impl Queue {
    /// Drops a viewer's question and its messages.
    fn remove(&mut self, viewer: u64) {
        self.questions.remove(&viewer);
        self.messages.remove(&viewer);
        if let Some((_, stop)) = self.current.take_if(|(of, _)| *of == viewer) {
            stop.store(true, Ordering::Relaxed);
        }
    }
}

pub(super) struct FuturesThread(Arc<Watched<Queue>>);

impl FuturesThread {
    pub(super) fn open(futures: Box<dyn Futures>, news: Changes) -> FuturesThread {
        let queue = Arc::new(Watched::<Queue>::default());
        let server = Arc::clone(&queue);
        let serve = move || serve(&server, futures, &news);
        // Without a thread no question is answered.
        drop(
            std::thread::Builder::new()
                .name("page-futures".to_owned())
                .spawn(serve),
        );
        FuturesThread(queue)
    }

    /// Stops a viewer's question, if there is one, and queues the new one, if any.
    pub(super) fn request(&self, viewer: u64, question: Option<Question>) {
        self.0.visit(|queue| {
            queue.remove(viewer);
            queue.questions.extend(question.map(|one| (viewer, one)));
        });
    }

    /// Takes the newest message for a viewer.
    pub(super) fn take(&self, viewer: u64) -> Option<String> {
        self.0.visit(|queue| queue.messages.remove(&viewer))
    }
}

impl Drop for FuturesThread {
    fn drop(&mut self) {
        self.0.visit(|queue| {
            queue.is_closed = true;
            let stop = queue.current.take();
            stop.inspect(|(_, stop)| stop.store(true, Ordering::Relaxed));
        });
    }
}

/// Answers questions one by one until the view closes.
fn serve(shared: &Watched<Queue>, mut futures: Box<dyn Futures>, news: &Changes) {
    const ROUND: Duration = Duration::from_secs(60);
    loop {
        shared.wait(ROUND, |queue| {
            queue.is_closed || !queue.questions.is_empty()
        });
        if shared.visit(|queue| queue.is_closed) {
            return;
        }
        let stop = Arc::new(AtomicBool::new(false));
        let next = shared.visit(|queue| {
            let (viewer, question) = queue.questions.pop_first()?;
            queue.current = Some((viewer, Arc::clone(&stop)));
            Some((viewer, question))
        });
        let Some((viewer, question)) = next else {
            continue;
        };
        let send = |done: u32, result: Option<&Value>, failed: Option<&str>| {
            let total = question.futures;
            let message = PageMessage::WhatIf {
                done,
                total,
                result,
                failed,
            };
            // If the viewer has left or asked again, nothing is sent.
            shared.visit(|queue| {
                if queue.current.as_ref().is_some_and(|(of, _)| *of == viewer) {
                    queue.messages.insert(viewer, message.json());
                }
            });
            news.send_replace(());
        };
        send(0, None, None);
        match futures.play(&question, &stop, &mut |done| send(done, None, None)) {
            Ok(result) => send(question.futures, Some(&result), None),
            Err(reason) => send(0, None, Some(&reason)),
        }
        shared.visit(|queue| queue.current = None);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::sync::mpsc::{Receiver, Sender, channel};

    /// Futures that signal their start and wait until they are stopped or may end.
    struct SlowFutures(Sender<u32>, Receiver<()>);

    impl Futures for SlowFutures {
        fn choices(&self) -> Value {
            Value::Null
        }

        fn play(
            &mut self,
            question: &Question,
            stop: &AtomicBool,
            progress: &mut dyn FnMut(u32),
        ) -> Result<Value, String> {
            progress(1);
            self.0.send(question.futures).expect("the test listens");
            while !stop.load(Ordering::Relaxed) {
                if self.1.try_recv().is_ok() {
                    return Ok("played".into());
                }
                std::thread::yield_now();
            }
            Err("stopped".to_owned())
        }
    }

    #[test]
    fn a_question_ends_when_its_page_leaves_or_asks_another() {
        let (began, begins) = channel();
        let (go, goes) = channel();
        let thread = FuturesThread::open(Box::new(SlowFutures(began, goes)), Changes::default());
        let question = |futures| {
            Some(Question {
                futures,
                ..Question::default()
            })
        };
        thread.request(1, question(10));
        assert_eq!(begins.recv(), Ok(10));
        assert!(thread.take(1).expect("a message").contains(r#""done":1"#));
        thread.request(1, question(11));
        assert_eq!(begins.recv(), Ok(11), "the first was stopped");
        thread.request(2, question(12));
        thread.request(1, None);
        assert_eq!(begins.recv(), Ok(12), "the second was stopped");
        assert_eq!(thread.take(1), None);
        go.send(()).unwrap();
        let is_whole = |text: String| text.contains(r#""result":"played""#);
        while !thread.take(2).is_some_and(is_whole) {
            std::thread::yield_now();
        }
    }
}

//! A delay line: what is sent arrives later, in the order in which it was sent.

use serde::{Deserialize, Serialize};
use std::collections::VecDeque;

/// Items under way, first the oldest. As bytes, only those.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub(crate) struct DelayLine<T>(VecDeque<T>);

impl<T> Default for DelayLine<T> {
    fn default() -> DelayLine<T> {
        DelayLine(VecDeque::new())
    }
}

impl<T> DelayLine<T> {
    /// An empty one with room for `count` items.
    pub(crate) fn with_room(count: usize) -> DelayLine<T> {
        DelayLine(VecDeque::with_capacity(count))
    }

    /// One that always holds `count` items, at first all the same: [`DelayLine::shift`] gives each back `count` calls later.
    pub(crate) fn of(item: T, count: usize) -> DelayLine<T>
    where
        T: Clone,
    {
        DelayLine(VecDeque::from(vec![item; count]))
    }

    /// How many items are under way.
    pub(crate) fn len(&self) -> usize {
        self.0.len()
    }

    /// The oldest item under way.
    pub(crate) fn first(&self) -> Option<&T> {
        self.0.front()
    }

    /// Sends `item` off, last of all.
    pub(crate) fn send(&mut self, item: T) {
        self.0.push_back(item);
    }

    /// Takes back the items sent last, as long as they are overtaken.
    pub(crate) fn drop_overtaken(&mut self, is_overtaken: impl Fn(&T) -> bool) {
        while self.0.back().is_some_and(&is_overtaken) {
            self.0.pop_back();
        }
    }

    /// The oldest item, if it has arrived.
    pub(crate) fn receive(&mut self, has_arrived: impl Fn(&T) -> bool) -> Option<T> {
        self.0.pop_front_if(|item| has_arrived(item))
    }

    /// Sends `item` off and gives the oldest, which may be itself.
    #[inline]
    pub(crate) fn shift(&mut self, item: T) -> T {
        match self.0.pop_front() {
            Some(oldest) => {
                self.0.push_back(item);
                oldest
            }
            None => item,
        }
    }

    /// Forgets all that is under way.
    pub(crate) fn clear(&mut self) {
        self.0.clear();
    }
}

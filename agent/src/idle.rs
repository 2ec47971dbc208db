//! The idle mind: lies still. A mark to tag, an empty seat to fill later.

use crate::Mind;
use game::{Order, Picture};

/// The mind that does nothing.
pub(crate) struct IdleMind;

impl Mind for IdleMind {
    fn decide(&mut self, _picture: &Picture) -> Order {
        Order::Hold
    }
}

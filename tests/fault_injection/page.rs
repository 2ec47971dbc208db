//! A page that shows the game and sometimes stops it. It uses the real page server, without a
//! browser or sockets.

use crate::operator::{PROMISED, RECOVERS};
use crate::plan::{Plan, SIM};
use crate::play::{name, net};
use crate::real_boat::Wire;
use bus::{Watched, clock};
use messages::Control;
use primitives::stream::Stream;
use shore::page::live::LiveView;
use shore::page::{Access, Budget, Outgoing, PageRequest, View, Viewer};
use std::time::{Duration, Instant};

/// When the page is opened.
pub(crate) const BEGINS: Duration = Duration::from_millis(400);
/// Interval at which the page is polled.
const LOOKS: Duration = Duration::from_millis(100);
/// Upper limit on the time from the button to the wire, and between frames.
const LATE: Duration = Duration::from_secs(3);

/// Polls the page until the game is over.
pub(crate) fn look(plan: &Plan, wire: &Wire, over: &Watched<bool>) {
    let began = clock::now();
    let stream = &mut Stream::new(plan.seed, "page");
    let view = LiveView::open(net(false).into(), Some(name()), Box::new(|_| ()), |_| {
        Err(String::new())
    })
    .expect("a thread");
    let mut viewer = view.open_viewer(Access::Control);
    let mut shown = Shown {
        at: clock::now(),
        frames: 0,
    };
    while !over.wait(LOOKS, |over| *over) {
        let since = clock::since(began) + BEGINS;
        let nodes = [SIM, plan.page()];
        let is_calm =
            plan.is_calm() && !plan.is_disturbed(&nodes, since.saturating_sub(RECOVERS), since);
        shown.take(&mut *viewer, is_calm);
        if stream.below(80) == 0 {
            stop(plan, wire, &mut *viewer, since);
        }
    }
}

/// The messages that the page has received.
struct Shown {
    at: Instant,
    frames: u64,
}

impl Shown {
    fn take(&mut self, viewer: &mut dyn Viewer, is_calm: bool) {
        let now = clock::now();
        let before = self.frames;
        while let Some(message) = viewer.next_message(now, Budget::All) {
            self.frames += u64::from(matches!(message, Outgoing::Now(_)));
        }
        // A game that has not begun has no frames.
        if self.frames > before || !is_calm || self.frames == 0 {
            self.at = now;
        }
        assert!(
            now < self.at + LATE,
            "a page has received {} frames, but no more now",
            self.frames
        );
    }
}

/// Presses the E-stop button. Without faults, the boat must rest from then on until the operator
/// releases it.
fn stop(plan: &Plan, wire: &Wire, viewer: &mut dyn Viewer, since: Duration) {
    let asked = clock::now();
    wire.visit(|state, _| state.page_stopped = Some(asked));
    let is_sent = viewer
        .ask(
            &PageRequest::Control {
                what: Control::EStop,
            },
            asked,
        )
        .is_ok();
    let nodes = [SIM, plan.gateway(), plan.page()];
    let is_disturbed = plan.is_disturbed(&nodes, since.saturating_sub(RECOVERS), since + LATE);
    if is_sent && plan.is_calm() && !is_disturbed {
        wire.visit(|state, _| {
            if !state.is_releasing && state.must_rest.is_none() {
                state.must_rest = Some(asked + PROMISED + plan.on_its_way());
            }
        });
    }
}

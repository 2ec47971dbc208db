//! The link of a leaf to its hub: it delays messages, keeps them in order, and closes if either
//! side is silent for the lease.

use crate::conditions::{Conditions, Damage};
use crate::event::{Event, nanos};
use crate::packet::{Link, Packet};
use crate::state::{SessionState, State};
use std::sync::Arc;
use std::time::Duration;

/// The maximum time from the end of a cut until the packets queued during it are retransmitted.
const SENT_AGAIN: Duration = Duration::from_millis(200);
/// The shortest time between two attempts to connect.
const RETRY_LEAST: Duration = Duration::from_millis(100);

impl State {
    /// Opens a link, and passes the leaf's declarations to the hub.
    pub(crate) fn connect(&mut self, leaf: usize, hub: usize) {
        let link = self.links.len();
        self.links.push(Link {
            leaf,
            hub,
            leaf_open: true,
            hub_open: true,
            ..Link::default()
        });
        self.sessions[leaf].link = Some(link);
        self.note("connects", self.sessions[leaf].node, "", &[]);
        let declared = &self.sessions[leaf].declared;
        let declares: Vec<Packet> = declared
            .iter()
            .map(|(id, declared)| declared.packet(*id))
            .collect();
        declares
            .into_iter()
            .for_each(|packet| self.send(link, true, packet));
    }

    /// The first hub that listens at one of these endpoints.
    pub(crate) fn hub_at(&self, endpoints: &[String]) -> Option<usize> {
        let listens = |session: &SessionState| {
            session
                .endpoints
                .iter()
                .any(|endpoint| endpoints.contains(endpoint))
        };
        self.sessions
            .iter()
            .position(|session| session.is_hub && session.is_open && listens(session))
    }

    /// The hub that a leaf can currently reach.
    pub(crate) fn reachable_hub(&self, leaf: usize) -> Option<usize> {
        let node = self.sessions[leaf].node;
        let hub = self.hub_at(&self.sessions[leaf].endpoints)?;
        let there = &self.nodes[self.sessions[hub].node];
        (!self.nodes[node].is_cut() && !there.is_cut() && !there.is_suspended()).then_some(hub)
    }

    pub(crate) fn send(&mut self, link: usize, up: bool, packet: Packet) {
        let is_open = if up {
            self.links[link].leaf_open
        } else {
            self.links[link].hub_open
        };
        let packet = match packet {
            _ if !is_open => return,
            Packet::Publish { key, bytes } => {
                // As with zenoh's links, published messages never wait; a cut link queues as many
                // as fit and loses the rest. Declarations and queries are kept.
                let is_full = self.is_stopped(link, up)
                    && self.links[link].direction(up).queue.len() >= self.conditions.queue;
                if is_full
                    || (self.conditions.loss > 0.0 && self.stream.unit() < self.conditions.loss)
                {
                    let node = self.sessions[self.links[link].leaf].node;
                    return self.note(if up { "loses ->" } else { "loses <-" }, node, &key, &bytes);
                }
                let bytes = self.damaged(bytes);
                Packet::Publish { key, bytes }
            }
            other => other,
        };
        self.put(link, up, packet);
    }

    /// Sends a packet, even if its sender has ended.
    fn put(&mut self, link: usize, up: bool, packet: Packet) {
        let Conditions { delay, jitter, .. } = self.conditions;
        let wait = delay + self.draw(jitter);
        let arrival_ns = self.now_ns + nanos(wait);
        let direction = self.links[link].direction(up);
        // TCP keeps packets in order; with jitter alone, a later packet could overtake.
        let arrival_ns = arrival_ns.max(direction.last_ns);
        direction.last_ns = arrival_ns;
        direction.queue.push_back((arrival_ns, packet));
        if !direction.is_due {
            self.expect(link, up, arrival_ns);
        }
    }

    fn damaged(&mut self, bytes: Arc<[u8]>) -> Arc<[u8]> {
        let (share, damage) = self.conditions.damaged;
        if bytes.is_empty() || share <= 0.0 || self.stream.unit() >= share {
            return bytes;
        }
        let mut bytes = bytes.to_vec();
        let place = self.stream.below(bytes.len() as u64) as usize;
        match damage {
            Damage::Truncated => bytes.truncate(place),
            Damage::BitFlip => bytes[place] ^= 1 << self.stream.below(8),
            Damage::Noise => bytes
                .iter_mut()
                .for_each(|byte| *byte = self.stream.below(256) as u8),
        }
        bytes.into()
    }

    fn expect(&mut self, link: usize, up: bool, at_ns: u64) {
        let direction = self.links[link].direction(up);
        direction.arrival += 1;
        direction.is_due = true;
        let arrival = direction.arrival;
        self.at(at_ns, Event::Arrive { link, up, arrival });
    }

    /// Whether this direction is currently blocked.
    fn is_stopped(&self, link: usize, up: bool) -> bool {
        let [leaf, hub] = [self.links[link].leaf, self.links[link].hub]
            .map(|end| &self.nodes[self.sessions[end].node]);
        let receiver = if up { hub } else { leaf };
        leaf.is_cut() || hub.is_cut() || receiver.is_suspended()
    }

    /// Delivers the packets that are due.
    pub(crate) fn arrive(&mut self, link: usize, up: bool, arrival: u64) {
        let is_stopped = self.is_stopped(link, up);
        let direction = self.links[link].direction(up);
        if direction.arrival != arrival {
            return;
        }
        direction.is_due = false;
        if is_stopped {
            return;
        }
        let Some((_, packet)) = direction.queue.pop_front() else {
            return;
        };
        if self.links[link].silent_since_ns[usize::from(up)].is_some() {
            // Packets in flight also count as signs of life.
            self.begin_lease(link, up, self.conditions.lease);
        }
        let direction = self.links[link].direction(up);
        if let Some((next_ns, _)) = direction.queue.front() {
            let next_ns = *next_ns;
            self.expect(link, up, next_ns);
        }
        if up {
            self.take_at_hub(link, packet)
        } else {
            self.take_at_leaf(link, packet)
        }
    }

    fn links_of(&self, node: usize) -> Vec<usize> {
        let touches = |link: &Link| {
            (link.leaf_open || link.hub_open)
                && [link.leaf, link.hub]
                    .iter()
                    .any(|end| self.sessions[*end].node == node)
        };
        (0..self.links.len())
            .filter(|i| touches(&self.links[*i]))
            .collect()
    }

    /// Starts the leases of this node's links, whose ends may receive nothing from now on.
    pub(crate) fn begin_silence(&mut self, node: usize) {
        for link in self.links_of(node) {
            for at_hub in [false, true] {
                if self.links[link].silent_since_ns[usize::from(at_hub)].is_none() {
                    // The last sign of life was up to a quarter of the lease ago.
                    let wait = self
                        .conditions
                        .lease
                        .mul_f64(1.0 - 0.25 * self.stream.unit());
                    self.begin_lease(link, at_hub, wait);
                }
            }
        }
    }

    /// Starts a lease: when it expires, this end of the link closes, unless it has received
    /// something.
    fn begin_lease(&mut self, link: usize, at_hub: bool, wait: Duration) {
        let since_ns = self.now_ns;
        self.links[link].silent_since_ns[usize::from(at_hub)] = Some(since_ns);
        self.after(
            wait,
            Event::LeaseOver {
                link,
                at_hub,
                since_ns,
            },
        );
    }

    pub(crate) fn lease_over(&mut self, link: usize, at_hub: bool, since_ns: u64) {
        let Link {
            leaf,
            hub,
            silent_since_ns,
            ..
        } = self.links[link];
        let own = self.sessions[if at_hub { hub } else { leaf }].node;
        if silent_since_ns[usize::from(at_hub)] == Some(since_ns) && !self.nodes[own].is_suspended()
        {
            self.close_end(link, at_hub);
        }
    }

    /// Both sides can receive again: packets in flight continue, and a closed end notifies the
    /// other.
    pub(crate) fn end_silence(&mut self, node: usize) {
        for link in self.links_of(node) {
            let Link {
                leaf,
                hub,
                leaf_open,
                hub_open,
                ..
            } = self.links[link];
            let is_silent = [leaf, hub].iter().any(|end| {
                let node = &self.nodes[self.sessions[*end].node];
                node.is_cut() || node.is_suspended()
            });
            if !is_silent {
                self.links[link].silent_since_ns = [None; 2];
            }
            for up in [false, true] {
                let (from, to) = if up {
                    (leaf_open, hub_open)
                } else {
                    (hub_open, leaf_open)
                };
                if !from && to && !is_silent {
                    self.put(link, up, Packet::Close);
                }
                // TCP retransmits at growing intervals: packets queued during a cut arrive some
                // time after the cable is plugged in again.
                let wait = self.draw(SENT_AGAIN);
                if !self.is_stopped(link, up) && !self.links[link].direction(up).queue.is_empty() {
                    self.expect(link, up, self.now_ns + nanos(wait));
                }
            }
        }
    }

    /// Closes one end of a link, and discards everything that this end learned over the link.
    pub(crate) fn close_end(&mut self, link: usize, at_hub: bool) {
        let leaf = self.links[link].leaf;
        if at_hub {
            if std::mem::replace(&mut self.links[link].hub_open, false) {
                self.note("is closed by the hub", self.sessions[leaf].node, "", &[]);
                self.forget(link);
            }
        } else if std::mem::replace(&mut self.links[link].leaf_open, false) {
            self.note("loses its link", self.sessions[leaf].node, "", &[]);
            self.sessions[leaf].link = None;
            if self.sessions[leaf].is_open {
                self.try_again(leaf);
            }
            self.forget_tokens(leaf);
        }
    }

    fn try_again(&mut self, session: usize) {
        let wait = RETRY_LEAST + self.draw(self.conditions.retry);
        self.after(wait, Event::Reconnect { session });
    }

    pub(crate) fn reconnect(&mut self, session: usize) {
        let SessionState {
            is_open,
            link,
            node,
            ..
        } = self.sessions[session];
        if is_open && link.is_none() {
            match self
                .reachable_hub(session)
                .filter(|_| !self.nodes[node].is_suspended())
            {
                Some(hub) => self.connect(session, hub),
                None => self.try_again(session),
            }
        }
    }

    /// Closes a session, for example because its process has died. The others learn of this after
    /// earlier packets have arrived.
    pub(crate) fn close(&mut self, session: usize) {
        if !std::mem::replace(&mut self.sessions[session].is_open, false) {
            return;
        }
        let declared = std::mem::take(&mut self.sessions[session].declared);
        self.to_drop.extend(declared.into_values());
        if let Some(link) = self.sessions[session].link.take() {
            self.links[link].leaf_open = false;
            self.put(link, true, Packet::Close);
        }
        if !self.sessions[session].is_hub {
            return;
        }
        for link in 0..self.links.len() {
            if self.links[link].hub == session && self.links[link].hub_open {
                self.links[link].hub_open = false;
                self.links[link].known.clear();
                self.put(link, false, Packet::Close);
            }
        }
    }
}

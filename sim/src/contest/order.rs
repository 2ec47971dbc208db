//! Orders: their arrival and expiry, and how the rules modify the order in force.

use super::Contest;
use super::state::OrderInForce;
use crate::external::Track;
use messages::Order;
use messages::input::Input;
use messages::order::BadOrder;
use primitives::{Ned, SimTime, VehicleId};
use rules::Directive;
use scenario::boat::Hold;

/// Radius within which a station-keeping boat rests, m.
// A radius below the noise of a satellite receiver would never let a boat rest.
const STATION_RADIUS_M: f64 = 2.0;
/// Ratio of a boat's return speed to its distance from the station, outside [`STATION_RADIUS_M`],
/// 1/s.
const STATION_RETURN_PER_S: f64 = 0.5;

impl Contest {
    /// Sends an order to a vehicle. The order is in force from its arrival until it expires or the
    /// next order arrives. A real boat receives it over a real link instead of the simulated one.
    /// `given_at` is the time of the picture that the order answers; a future time counts as the
    /// present.
    ///
    /// # Errors
    /// [`BadOrder`] for invalid numbers; the vehicle then holds.
    pub fn order(
        &mut self,
        vehicle: VehicleId,
        order: Order,
        given_at: SimTime,
    ) -> Result<(), BadOrder> {
        let checked = order.check();
        let order = checked.unwrap_or_default();
        let i = vehicle.index();
        let now = self.now();
        // Otherwise an agent could claim to answer a future picture, and the order would never
        // expire.
        let given_at = given_at.min(now);
        self.note(Input::Ordered {
            vehicle,
            order,
            given_at,
        });
        // The input is already recorded: a replay applies the fault again.
        if self.is_cut_off(vehicle) {
            return checked.map(drop);
        }
        // Even if a radio delays the order, its age counts from the picture, not from arrival.
        let in_force = &mut self.state.orders[i];
        in_force.given_at = given_at;
        match &mut self.radio {
            Some(radio) if self.state.tracks[i].is_none() => {
                radio.send_order(i, order, self.world.state().boats[i].pose.at, now);
            }
            _ => (in_force.order, in_force.arrived_at) = (order, now),
        }
        checked.map(drop)
    }

    /// A vehicle's order in force: the last one that arrived and has not expired.
    pub fn order_in_force(&self, vehicle: VehicleId) -> Order {
        self.state.orders[vehicle.index()].order
    }

    /// The time of the picture that a vehicle's newest order answers.
    pub fn given_at(&self, vehicle: VehicleId) -> SimTime {
        self.state.orders[vehicle.index()].given_at
    }

    /// Positions of the other real boats: north and east of each, m.
    pub fn other_real_boats_m(&self, vehicle: VehicleId) -> Vec<f64> {
        let others = self.scenario.externals().filter(|v| *v != vehicle);
        let places = others.map(|v| self.world.state().boats[v.index()].pose.at);
        places.flat_map(|at| [at.north, at.east]).collect()
    }

    /// A vehicle's effective command: its order in force, as modified by rules and operators. A
    /// boat driven home gets a course home at the speed allowed by the rules; a speed limit of the
    /// rules also scales ordered thrust. A real boat holds while its position or its agent is lost,
    /// after its order has expired, and after the end of the game: it must be supervised, whatever
    /// the rules require.
    pub fn effective_command(&self, vehicle: VehicleId) -> Order {
        let i = vehicle.index();
        if self.is_stopped(i) {
            return Order::Hold;
        }
        let at = self.world.state().boats[i].pose.at;
        let speed_max_m_s = self.scenario.boat_of(vehicle).speed_max_m_s();
        match (self.wanted_command(vehicle), self.state.stations[i]) {
            (Order::Hold, Some(station)) => keeping_station(at, station, speed_max_m_s),
            (command, _) => command,
        }
    }

    /// Whether a vehicle holds regardless of its order and the rules.
    fn is_stopped(&self, i: usize) -> bool {
        // A real boat moves only under supervision.
        let is_unsupervised = |track: &Track| {
            track.is_lost(self.now())
                || self.state.agent_lost[i]
                || self.is_over()
                || self.is_expired(i)
        };
        self.state.e_stopped
            || self.state.halted
            || self.state.tracks[i].as_ref().is_some_and(is_unsupervised)
    }

    /// A vehicle's order in force, as modified by the rules.
    fn wanted_command(&self, vehicle: VehicleId) -> Order {
        let i = vehicle.index();
        let at = self.world.state().boats[i].pose.at;
        let speed_max_m_s = self.scenario.boat_of(vehicle).speed_max_m_s();
        match self.referee.directive(&self.state.standing, vehicle, at) {
            Directive::Hold => Order::Hold,
            Directive::DrivenHome { to, speed_factor } => Order::Steer {
                heading_rad: at.bearing_rad(to),
                speed_m_s: speed_factor * speed_max_m_s,
            },
            Directive::Free { speed_factor } => match self.state.orders[i].order {
                Order::Hold => Order::Hold,
                Order::Steer {
                    heading_rad,
                    speed_m_s,
                } => Order::Steer {
                    heading_rad,
                    speed_m_s: speed_m_s.min(speed_factor * speed_max_m_s),
                },
                Order::Turn { by_rad, speed_m_s } => Order::Turn {
                    by_rad,
                    speed_m_s: speed_m_s.min(speed_factor * speed_max_m_s),
                },
                Order::Thrust { port, starboard } => Order::Thrust {
                    port: speed_factor * port,
                    starboard: speed_factor * starboard,
                },
            },
        }
    }

    /// Sets the station of each simulated station-keeping boat when it starts to hold, and clears
    /// it when the boat stops holding.
    pub(super) fn update_stations(&mut self) {
        for i in 0..self.state.stations.len() {
            let vehicle = VehicleId::at(i);
            let keeps = self.scenario.boat_of(vehicle).hold == Hold::KeepsStation;
            if keeps
                && self.state.tracks[i].is_none()
                && self.wanted_command(vehicle) == Order::Hold
            {
                self.state.stations[i].get_or_insert(self.world.state().boats[i].pose.at);
            } else {
                self.state.stations[i] = None;
            }
        }
    }

    /// Makes a vehicle hold at once. Bypasses the radio, and cancels orders in transit.
    pub fn hold(&mut self, vehicle: VehicleId) {
        self.note(Input::Held(vehicle));
        self.hold_now(vehicle.index());
    }

    pub(super) fn hold_now(&mut self, i: usize) {
        self.state.orders[i].order = Order::Hold;
        self.recall_orders(i);
    }

    /// Cancels orders in transit to a vehicle.
    pub(super) fn recall_orders(&mut self, i: usize) {
        if let Some(radio) = &mut self.radio {
            radio.recall_orders(i);
        }
    }

    /// Expires orders: a vehicle holds if its newest order answers a picture older than the
    /// scenario's time to live.
    pub(super) fn expire_orders(&mut self) {
        for i in 0..self.state.orders.len() {
            if self.is_expired(i) {
                self.hold_now(i);
            }
        }
    }

    fn is_expired(&self, i: usize) -> bool {
        (self.now() - self.state.orders[i].given_at).as_s() > self.scenario.order_ttl_s
    }

    /// Delivers orders, and stops the thrusters of boats whose own watchdogs have expired.
    pub(super) fn deliver_orders(&mut self) {
        let now = self.now();
        for (i, in_force) in self.state.orders.iter_mut().enumerate() {
            if let Some(order) = self.radio.as_mut().and_then(|radio| radio.order(i, now))
                && !self.state.agent_lost[i]
            {
                *in_force = OrderInForce {
                    order,
                    arrived_at: now,
                    ..*in_force
                };
            }
            // As in firmware, the boat's watchdog counts from the last order that arrived; the time
            // to live counts from the picture.
            if self.watchdogs[i].is_some_and(|limit| now > in_force.arrived_at + limit) {
                in_force.order = Order::Hold;
            }
        }
    }
}

/// The order that keeps a boat at its station: hold if near it, otherwise return.
fn keeping_station(at: Ned, station: Ned, speed_max_m_s: f64) -> Order {
    let off_m = at.distance(station);
    if off_m <= STATION_RADIUS_M {
        return Order::Hold;
    }
    let speed_m_s = (STATION_RETURN_PER_S * off_m).min(speed_max_m_s);
    Order::Steer {
        heading_rad: at.bearing_rad(station),
        speed_m_s,
    }
}

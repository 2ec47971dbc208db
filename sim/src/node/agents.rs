//! Accepts or refuses agents' orders, without a network or clock.

use super::membership::Membership;
use super::settings::Pace;
use messages::refusal::{Refusal, Refusals};
use messages::{Order, Orders};
use primitives::VehicleId;

/// The accepted part of an agent's orders.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Accepted {
    /// The orders to put in force.
    pub orders: Vec<(VehicleId, Order)>,
    /// Vehicles whose agent was lost and is back.
    pub back: Vec<VehicleId>,
}

/// Handles an agent's orders while `tick` is open. Lockstep accepts orders for the open decision;
/// real time also accepts those for an earlier one, if none newer has arrived.
pub fn accept(
    agents: &mut Membership,
    message: &Orders,
    (tick, pace): (u64, Pace),
    refusals: &mut Refusals,
) -> Accepted {
    let mut accepted = Accepted::default();
    let own: Vec<VehicleId> = agents.vehicles_of(message.ticket).collect();
    if own.is_empty() {
        refusals.count(Refusal::Ticket);
        return accepted;
    }
    // A valid ticket shows that the agent is present, whether in time or not.
    accepted.back = agents.welcome_back(message.ticket);
    let seq = message.stamp.seq;
    // A duplicate: instead of acknowledging messages, the sim repeats pictures and agents repeat
    // replies.
    if own.iter().any(|vehicle| agents.has_taken(*vehicle, seq)) {
        return accepted;
    }
    // In real time, an agent that is a decision late is still useful: its order counts until its
    // time to live ends.
    if seq > tick || (seq < tick && pace == Pace::Lockstep) {
        refusals.count(Refusal::WrongTick);
        return accepted;
    }
    own.iter()
        .for_each(|vehicle| agents.note_taken(*vehicle, seq));
    accepted.orders = orders_for(&own, message, refusals);
    accepted
}

/// One order for each vehicle of the agent; hold for vehicles without a valid order.
fn orders_for(
    own: &[VehicleId],
    message: &Orders,
    refusals: &mut Refusals,
) -> Vec<(VehicleId, Order)> {
    let mut orders = Vec::with_capacity(own.len());
    for item in &message.orders {
        if !own.contains(&item.vehicle) {
            refusals.count(Refusal::NotYours);
            continue;
        }
        let order = item.order();
        refusals.add(Refusal::BadNumber, u64::from(order.is_none()));
        orders.push((item.vehicle, order.unwrap_or_default()));
    }
    for vehicle in own {
        if !orders.iter().any(|(given, _)| given == vehicle) {
            // The boat holds instead of continuing its previous order: a mind that forgets a boat
            // has a bug, and the result reports it.
            refusals.count(Refusal::Missing);
            orders.push((*vehicle, Order::Hold));
        }
    }
    orders
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::node::membership::tests::{NOW, granted, membership, request};
    use messages::{Message, Role, Stamp, VehicleOrder};

    const REALTIME: Pace = Pace::Realtime { factor: 1.0 };
    const PUSH: Order = Order::Thrust {
        port: 1.0,
        starboard: 1.0,
    };

    /// Agents of a game with these vehicles, and tickets from 1 on.
    fn agents(all: &[&[&str]]) -> Membership {
        let mut agents = membership(Role::Agent, false);
        for (i, vehicles) in all.iter().enumerate() {
            agents.join(
                &request(Role::Agent, &format!("agent {i}"), vehicles),
                i as u64 + 1,
                NOW,
            );
        }
        agents
    }

    fn orders(ticket: u64, seq: u64, vehicles: &[u16]) -> Orders {
        let order = |v: &u16| VehicleOrder::new(VehicleId(*v), PUSH);
        let stamp = Stamp {
            seq,
            version: Orders::VERSION,
            ..Stamp::default()
        };
        Orders {
            stamp,
            ticket,
            orders: vehicles.iter().map(order).collect(),
        }
    }

    #[test]
    fn a_tick_is_complete_when_everybody_who_is_there_has_answered() {
        let mut agents = agents(&[&["blue_one", "blue_two"], &["red_one"]]);
        let mut refusals = Refusals::default();
        let mut take = |agents: &mut Membership, message: &Orders| {
            accept(agents, message, (0, Pace::Lockstep), &mut refusals)
                .orders
                .len()
        };
        assert!(!agents.all_answered(0));
        assert_eq!(take(&mut agents, &orders(1, 0, &[0, 1])), 2);
        assert!(!agents.all_answered(0));
        take(&mut agents, &orders(2, 0, &[2]));
        assert!(agents.all_answered(0) && !agents.all_answered(1));
        assert_eq!(
            take(&mut agents, &orders(2, 0, &[2])),
            0,
            "a duplicate counts once"
        );
        assert_eq!(refusals.total(), 0, "a duplicate is not refused");
    }

    #[test]
    fn old_orders_are_for_real_time_only_and_orders_to_come_for_nobody() {
        for (pace, seq, accepted, refused) in [
            (Pace::Lockstep, 4, 0, 1),
            (REALTIME, 4, 1, 0),
            (Pace::Lockstep, 6, 0, 1),
            (REALTIME, 6, 0, 1),
            (Pace::Lockstep, 5, 1, 0),
        ] {
            let mut agents = agents(&[&["blue_one"]]);
            let mut refusals = Refusals::default();
            let taken = accept(&mut agents, &orders(1, seq, &[0]), (5, pace), &mut refusals);
            assert_eq!(taken.orders.len(), accepted, "{pace} {seq}");
            assert_eq!(
                refusals,
                Refusals::from([(Refusal::WrongTick, refused)]),
                "{pace} {seq}"
            );
        }
    }

    #[test]
    fn what_an_agent_gets_wrong_is_counted_and_its_boat_holds() {
        // The contest refuses invalid numbers; an unknown kind is refused before that.
        let unknown = VehicleOrder {
            kind: 9,
            ..VehicleOrder::new(VehicleId(0), PUSH)
        };
        for (message, refusal, order) in [
            (orders(1, 0, &[0]), None, PUSH),
            (
                Orders {
                    orders: vec![unknown],
                    ..orders(1, 0, &[])
                },
                Some(Refusal::BadNumber),
                Order::Hold,
            ),
            (orders(1, 0, &[]), Some(Refusal::Missing), Order::Hold),
            (orders(1, 0, &[0, 1]), Some(Refusal::NotYours), PUSH),
            (orders(1, 0, &[999, 0]), Some(Refusal::NotYours), PUSH),
        ] {
            let mut agents = agents(&[&["blue_one"], &["blue_two"]]);
            let mut refusals = Refusals::default();
            let taken = accept(&mut agents, &message, (0, Pace::Lockstep), &mut refusals);
            assert_eq!(taken.orders, [(VehicleId(0), order)], "{message:?}");
            let want: Vec<(Refusal, u64)> =
                refusal.map(|refusal| (refusal, 1)).into_iter().collect();
            assert_eq!(
                refusals,
                want.into_iter()
                    .collect::<std::collections::BTreeMap<_, _>>()
                    .into()
            );
        }
    }

    #[test]
    fn who_was_lost_and_speaks_again_is_back_unless_another_has_its_vehicle() {
        let mut agents = agents(&[&["blue_one"]]);
        let mut refusals = Refusals::default();
        let mut take = |agents: &mut Membership, message: &Orders, tick| {
            accept(agents, message, (tick, Pace::Lockstep), &mut refusals)
        };
        assert_eq!(agents.gone("agent 0"), [VehicleId(0)]);
        assert!(agents.all_answered(9), "no agent is awaited");
        let late = take(&mut agents, &orders(1, 0, &[0]), 9);
        assert_eq!((late.back, late.orders.len()), (vec![VehicleId(0)], 0));
        assert!(!agents.all_answered(9), "the agent is awaited again");
        agents.give_up(9);
        assert_eq!(
            agents.join(&request(Role::Agent, "b", &["blue_one"]), 2, NOW),
            granted(2, &[0])
        );
        assert_eq!(
            take(&mut agents, &orders(1, 9, &[0]), 9),
            Accepted::default(),
            "the vehicle belongs to b"
        );
        assert!(!agents.all_answered(9), "only b is awaited");
        take(&mut agents, &orders(2, 9, &[0]), 9);
        assert!(agents.all_answered(9));
        assert_eq!(
            refusals,
            Refusals::from([(Refusal::WrongTick, 1), (Refusal::Ticket, 1)])
        );
    }
}

//! A mind that follows requests from ROS 2 for its boat.

use super::Incoming;
use super::graph::Graph;
use crate::message::Twist;
use crate::name::Node;
use crate::set_point::{Follower, Numbered, SetPoint};
use agent::Mind;
use bus::{BusError, Latest, Watched, clock};
use messages::refusal::{Refusal, Refusals};
use messages::{Order, Picture, VehicleOrder};
use primitives::VehicleId;
use std::sync::Arc;
use std::time::{Duration, Instant};

/// Maximum age of a request in wall-clock time, whatever the game time: a paused game must not
/// resume with a request from a program that has ended.
const WALL_MAX: Duration = Duration::from_secs(5);

/// The newest request for a boat.
#[derive(Default)]
pub(super) struct RequestCell(Watched<Option<(Numbered, Instant)>>);

impl RequestCell {
    fn put(&self, set_point: SetPoint) {
        self.0.visit(|newest| {
            let number = newest.map_or(0, |(newest, _)| newest.number) + 1;
            *newest = Some((Numbered { number, set_point }, clock::now()));
        });
    }

    fn newest(&self) -> Option<Numbered> {
        let newest = self.0.visit(|newest| *newest);
        newest
            .filter(|(_, at)| clock::since(*at) < WALL_MAX)
            .map(|(newest, _)| newest)
    }
}

/// Subscribes to the requests for a boat.
pub(super) fn subscribe(
    graph: &mut Graph,
    node: &Node,
    boat: VehicleId,
    cell: &Arc<RequestCell>,
    refusals: &Arc<Watched<Refusals>>,
) -> Result<(), BusError> {
    let take = |cell: &Arc<RequestCell>, refusals: &Arc<Watched<Refusals>>| {
        let (cell, refusals) = (Arc::clone(cell), Arc::clone(refusals));
        move |asked: Option<Result<SetPoint, Refusal>>| match asked {
            Some(Ok(set_point)) => cell.put(set_point),
            // An invalid request ends the previous one: the boat holds.
            Some(Err(refusal @ Refusal::BadNumber)) => {
                refusals.visit(|refusals| refusals.count(refusal));
                cell.put(SetPoint::Order(Order::Hold));
            }
            Some(Err(refusal)) => refusals.visit(|refusals| refusals.count(refusal)),
            None => refusals.visit(|refusals| refusals.count(Refusal::Garbage)),
        }
    };
    let name = &node.name;
    let asked = take(cell, refusals);
    graph.subscribe(
        node,
        &format!("/{name}/cmd_vel"),
        move |twist: Option<Twist>| {
            asked(twist.as_ref().map(SetPoint::of_twist));
        },
    )?;
    let asked = take(cell, refusals);
    graph.subscribe(
        node,
        &format!("/{name}/order"),
        move |order: Option<VehicleOrder>| {
            asked(order.as_ref().map(|order| SetPoint::of_order(boat, order)));
        },
    )
}

/// The mind of a boat driven from ROS 2.
pub(super) struct Driver {
    pub(super) boat: VehicleId,
    pub(super) cell: Arc<RequestCell>,
    pub(super) follower: Follower,
    /// Passes pictures on to ROS 2.
    pub(super) incoming: Arc<Latest<Incoming>>,
}

impl Mind for Driver {
    fn decide(&mut self, picture: &Picture) -> Order {
        self.incoming.put(
            1 + usize::from(picture.team),
            Incoming::Picture(Box::new(picture.clone())),
        );
        let Some(own) = picture.own(self.boat) else {
            return Order::Hold;
        };
        self.follower
            .order(picture.stamp.valid_ns, &own.nav, self.cell.newest())
    }
}

//! The operator's commands as services.

use super::graph::Graph;
use crate::message::Done;
use crate::name::{self, Node};
use bus::{Bus, BusError, Inbox, NodeThread, Parcel, PendingQuery, Watched, clock, inbox};
use messages::Control;
use messages::refusal::{Refusal, Refusals};
use messages::topic::GameName;
use primitives::codec;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Duration;

/// Interval at which an idle worker checks whether the bridge has ended.
const LOOK_AGAIN: Duration = Duration::from_millis(100);
/// Maximum number of queued requests; further requests are dropped.
const REQUESTS: usize = 16;

const SET_BOOL: &str = "std_srvs/srv/SetBool";
const TRIGGER: &str = "std_srvs/srv/Trigger";
const RESET: &str = "squall_msgs/srv/Reset";
/// The services: name, type, and the commands for `true` and `false`. Types without a flag use only
/// the first command.
const SERVICES: [(&str, &str, [Control; 2]); 6] = [
    (
        "/squall/e_stop",
        SET_BOOL,
        [Control::EStop, Control::Release],
    ),
    ("/squall/halt", SET_BOOL, [Control::Halt, Control::GoOn]),
    ("/squall/pause", SET_BOOL, [Control::Pause, Control::Resume]),
    ("/squall/step", TRIGGER, [Control::Step, Control::Step]),
    ("/squall/end", TRIGGER, [Control::Stop, Control::Stop]),
    (
        "/squall/reset",
        RESET,
        [Control::Reset(0), Control::Reset(0)],
    ),
];

/// The command in a request to a service with this type and these commands; `None` if the request
/// is malformed.
fn command(type_name: &str, [on, off]: [Control; 2], request: &[u8]) -> Option<Control> {
    if type_name == RESET {
        return codec::decode_plain(request).map(Control::Reset);
    }
    // The byte of a `Trigger` request is ignored.
    match codec::decode_plain::<u8>(request)? {
        0 if type_name == SET_BOOL => Some(off),
        1 => Some(on),
        _ => (type_name == TRIGGER).then_some(on),
    }
}

/// A request in a queue.
struct Asked {
    control: Control,
    attachment: Vec<u8>,
    client: Box<dyn PendingQuery>,
}

/// The game to command, and which commands ROS 2 may send.
pub(super) struct Operator {
    pub(super) bus: Bus,
    pub(super) game: GameName,
    /// Whether ROS 2 may send commands other than stops.
    pub(super) may_all: bool,
}

/// Offers the services until `stop` is set.
pub(super) fn open(
    graph: &mut Graph,
    node: &Node,
    operator: Operator,
    refusals: &Arc<Watched<Refusals>>,
    stop: &Arc<AtomicBool>,
) -> Result<[NodeThread; 2], BusError> {
    // Stops have their own queue, so that they need not wait for other commands.
    let (stops, stops_asked) = inbox::<Asked>(REQUESTS);
    let (others, others_asked) = inbox::<Asked>(REQUESTS);
    for (service, type_name, commands) in SERVICES {
        let (stops, others, refusals) = (stops.clone(), others.clone(), Arc::clone(refusals));
        graph.serve(
            node,
            (service, type_name),
            move |request: Parcel, client| {
                let asked = command(type_name, commands, &request.bytes);
                let Some(control) =
                    asked.filter(|_| name::answer_attachment(&request.attachment, 0).is_some())
                else {
                    return refusals.visit(|refusals| refusals.count(Refusal::Garbage));
                };
                let queue = if control.stops() { &stops } else { &others };
                if !queue.offer(Asked {
                    control,
                    attachment: request.attachment,
                    client,
                }) {
                    refusals.visit(|refusals| refusals.count(Refusal::Flood));
                }
            },
        )?;
    }
    let operator = Arc::new(operator);
    let worker = |requests: Inbox<Asked>| {
        let (operator, stop) = (Arc::clone(&operator), Arc::clone(stop));
        NodeThread::start(move || {
            while !stop.load(Ordering::Relaxed) {
                if let Some(asked) = requests.take(LOOK_AGAIN) {
                    operator.answer(asked);
                }
            }
        })
        .map_err(|e| BusError::Open {
            what: "start the services".to_owned(),
            reason: e.to_string(),
        })
    };
    Ok([worker(stops_asked)?, worker(others_asked)?])
}

impl Operator {
    fn answer(
        &self,
        Asked {
            control,
            attachment,
            client,
        }: Asked,
    ) {
        let done = match self.command(control) {
            Ok(()) => Done {
                success: true,
                message: String::new(),
            },
            Err(message) => Done {
                success: false,
                message,
            },
        };
        let attachment = name::answer_attachment(&attachment, clock::unix_ns()).unwrap_or_default();
        client.answer(Parcel {
            bytes: codec::encode_plain(&done),
            attachment,
        });
    }

    fn command(&self, control: Control) -> Result<(), String> {
        if !control.stops() && !self.may_all {
            return Err(
                "the bridge accepts only stop commands; start it with --operator to allow all commands".to_owned(),
            );
        }
        bus::control(&self.bus, &self.game, control).map_err(|e| e.to_string())
    }
}

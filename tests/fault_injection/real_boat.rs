//! A gateway with its boat: the core of the real gateway and the emulated boat of its own tests, joined to the game.
//!
//! The oracle of those tests judges every sentence to the boat, and panics where one must not be sent.

use crate::play::{WAIT, name, net};
use crate::rig::Rig;
use bus::game_search::{self, GameSearch};
use bus::{Patience, Priority, SimState, SimWatch, Watched, clock};
use game::external::{ExternalOrder, NavReport, OperatorCommand};
use game::message::{GameInfo, Message, Role, Stamp};
use game::topic::{self, Part};
use game::{SimTime, VehicleId, codec};
use gateway::bridge::{Input, NavOut, Plan};
use std::path::Path;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use std::time::Duration;

/// How often the boat moves on, and orders are looked at.
const STEP: Duration = Duration::from_millis(50);
/// How often somebody arms a boat that is not armed.
const ARM_EVERY_S: f64 = 2.0;

/// Brings the real boat of the game into it, until the sim is gone.
pub(crate) fn bring() {
    let stop = AtomicBool::new(false);
    let search = &mut GameSearch::new(WAIT, &stop);
    let quiet: &mut dyn FnMut(&str) = &mut |_| {};
    let Ok((bus, game, info)) = search.game(quiet, &net(false), Some(&name())) else { return };
    let vehicle = info.scenario.externals().next().expect("there is a real boat");
    let boat = [info.scenario.vehicles[vehicle.index()].name.clone()];
    let order = Arc::new(Watched::new(None));
    let newest = Arc::clone(&order);
    let take = move |bytes: &[u8]| {
        let came = codec::decode::<ExternalOrder>(bytes).ok();
        newest.visit(|newest| *newest = came.or(newest.take()));
    };
    let opened = (
        bus.show_alive(topic::alive(&game, Part::Gateway, &bus.id())),
        bus.subscribe(topic::external_order(&game, &info.scenario, vehicle), take),
        bus.publisher(topic::nav(&game, &info.scenario, vehicle), Priority::Normal),
        SimWatch::open(&bus, &game, Patience::of_player(Duration::from_secs(10))),
    );
    let (Ok(_alive), Ok(_orders), Ok(nav), Ok(sim)) = opened else { return };
    let Ok((ticket, _)) = search.until(quiet, || game_search::join(&bus, &game, Role::Gateway, &boat)) else { return };
    let mut rig = Rig::of(plan(&info, vehicle), Some(2.0), false);
    let (start, mut reports, mut armed_at) = (clock::now(), 0, SimTime::ZERO);
    while sim.state_by_token() == SimState::Alive {
        clock::rest(STEP);
        rig.run(clock::since(start).as_secs_f64() - rig.now.as_s());
        if let Some(ExternalOrder { given_ns, order, .. }) = order.visit(Option::take)
            && let Some(order) = order.order()
        {
            rig.put(&Input::Order(order, given_ns));
        }
        if rig.bridge.state().to_string() != "armed" && (rig.now - armed_at).as_s() > ARM_EVERY_S {
            rig.put(&Input::Operator(OperatorCommand::Arm));
            armed_at = rig.now;
        }
        for (_, out) in std::mem::take(&mut rig.navs) {
            reports += 1;
            // A session that is closed shows by the token of the sim.
            nav.send(&report(&out, ticket, vehicle, reports)).unwrap_or_default();
        }
        (rig.turns, rig.sent, rig.events) = (vec![], vec![], vec![]);
    }
    bus.close();
}

fn plan(info: &GameInfo, vehicle: VehicleId) -> Plan {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("scenarios/gateways/surveyor.toml");
    Plan {
        vehicle: info.scenario.vehicles[vehicle.index()].name.clone(),
        gateway: game::scenario::load_gateway(&file).unwrap_or_else(|e| panic!("{e}")),
        length_m: info.scenario.boat_of(vehicle).length_m,
        field: info.scenario.field.clone(),
        declination_rad: (-12.5_f64).to_radians(),
        arms_itself: false,
    }
}

fn report(out: &NavOut, ticket: u64, vehicle: VehicleId, seq: u64) -> NavReport {
    let stamp = Stamp { seq, version: NavReport::VERSION, ..Stamp::default() };
    let age_ns = SimTime::from_s(out.age_s).0;
    NavReport { stamp, ticket, vehicle, valid: out.valid, age_ns, nav: out.nav }
}

//! Game variables that both the boats' communities and the shoreside publish: flags, zones and
//! scores.

use crate::community::{Community, Value};
use analysis::alog;
use gateway::geodesy::LocalFrame;
use messages::picture::{FlagView, Nav};
use primitives::math::decimal;
use primitives::{Ned, SimTime, TeamId, VehicleId};
use scenario::Scenario;

/// Colours that viewers know. A team with the name of a colour is drawn in that colour; all others
/// are drawn in white.
const COLOURS: [&str; 6] = ["red", "blue", "green", "orange", "yellow", "white"];

/// A node report, with latitude, longitude and colour.
pub(crate) fn node_report(
    scenario: &Scenario,
    frame: &LocalFrame,
    (vehicle, nav, mode): (VehicleId, &Nav, &str),
    time_s: f64,
) -> Value {
    let at = frame.lat_lon(nav.at());
    let report = alog::node_report(scenario, (vehicle.index(), nav), time_s, mode);
    Value::Text(format!(
        "{report},LAT={},LON={},COLOR={}",
        decimal(at.lat_deg, 7),
        decimal(at.lon_deg, 7),
        colour(scenario, scenario.team_of(vehicle)),
    ))
}

/// `true` or `false` as text, because missions compare text.
pub(crate) fn flag_of(is_so: bool) -> Value {
    Value::Text(is_so.to_string())
}

pub(crate) fn colour(scenario: &Scenario, team: TeamId) -> &str {
    let name = scenario.teams[team.index()].name.as_str();
    COLOURS
        .iter()
        .find(|colour| **colour == name)
        .map_or("white", |_| name)
}

/// The marker of flag number `i` at this position.
pub(crate) fn marker(scenario: &Scenario, i: usize, at: Ned) -> String {
    let flag = &scenario.field.flags[i];
    format!(
        "x={},y={},width=3,range={},primary_color={},secondary_color=black,type=circle,label={}",
        decimal(at.east, 2),
        decimal(at.north, 2),
        decimal(scenario.rules.radii_of(flag).grab_m, 2),
        colour(scenario, flag.team),
        flag_label(scenario, i),
    )
}

/// The label of a flag: the name of its team, plus a number for the team's second and later flags.
pub(crate) fn flag_label(scenario: &Scenario, i: usize) -> String {
    let flags = &scenario.field.flags;
    let team = &scenario.teams[flags[i].team.index()].name;
    match flags[..i]
        .iter()
        .filter(|flag| flag.team == flags[i].team)
        .count()
    {
        0 => team.clone(),
        earlier => format!("{team}_{}", earlier + 1),
    }
}

/// Publishes changes in scores, tagged boats and flags. `tagged` lists the boats known to be
/// tagged.
pub(crate) fn publish(
    community: &mut Community,
    scenario: &Scenario,
    now: SimTime,
    (flags, score, tagged): (&[FlagView], &[u32], &[VehicleId]),
    out: &mut dyn FnMut(crate::wire::Msg),
) {
    let name = |vehicle: VehicleId| scenario.vehicles[vehicle.index()].name.as_str();
    let mut publish = |key: &str, value: Value| {
        community
            .publish_change(key, value)
            .into_iter()
            .for_each(&mut *out)
    };
    for (team, points) in scenario.teams.iter().zip(score) {
        publish(
            &format!("{}_SCORES", team.name.to_uppercase()),
            Value::Number(f64::from(*points)),
        );
    }
    let tagged: Vec<&str> = tagged.iter().map(|vehicle| name(*vehicle)).collect();
    publish("TAGGED_VEHICLES", Value::Text(tagged.join(",")));
    let mut summary = Vec::new();
    for (i, (flag, view)) in scenario.field.flags.iter().zip(flags).enumerate() {
        let carrier = usize::try_from(view.carrier)
            .ok()
            .filter(|carrier| *carrier < scenario.vehicles.len());
        let owner = carrier.map_or_else(String::new, |carrier| {
            format!(",owner={}", name(VehicleId::at(carrier)))
        });
        summary.push(format!("{}{owner}", marker(scenario, i, flag.home(now))));
        let label = flag_label(scenario, i).to_uppercase();
        publish(&format!("{label}_FLAG_GRABBED"), flag_of(carrier.is_some()));
    }
    publish("FLAG_SUMMARY", Value::Text(summary.join("#")));
    for (team, key) in ["UTM_ZONE_ONE", "UTM_ZONE_TWO"].into_iter().enumerate() {
        publish(key, Value::Text(zone(scenario, TeamId(team as u8))));
    }
}

/// A team's side of the field as a polygon to draw.
pub(crate) fn zone(scenario: &Scenario, team: TeamId) -> String {
    let fill = if scenario.teams[team.index()].name == "red" {
        "pink"
    } else {
        "light_blue"
    };
    let Some(zone) = scenario.field.zones.get(team.index()) else {
        return String::new();
    };
    format!(
        "{},label={},edge_color=gray50,vertex_color=gray50,fill_color={fill},vertex_size=1,edge_size=1,\
         fill_transparency=0.1",
        points(&zone.corners),
        scenario.teams[team.index()].name,
    )
}

/// The corners of a polygon in the syntax of MOOS.
pub(crate) fn points(corners: &[Ned]) -> String {
    let point = |at: &Ned| format!("{},{}", decimal(at.east, 2), decimal(at.north, 2));
    format!(
        "pts={{{}}}",
        corners.iter().map(point).collect::<Vec<_>>().join(":")
    )
}

//! The columns of each kind of message.

use super::row::Row;
use super::{SheetError, begin, time};
use crate::sentence::{Line, Lines};
use game::external::{ExternalOrder, LinkBytes, NavReport};
use game::input::{Input, InputRecord, Inputs};
use game::message::{Frame, PolicyProposal, Say, SeaView, VehicleTruth, Word};
use game::outcome::EventOutcome;
use game::picture::{Contact, FlagView, Imu, Nav, OwnBoat};
use game::{Order, Picture, Scenario, SimTime, VehicleId};
use recording::{Recording, Said};

/// A message that makes rows.
pub(super) trait Table {
    fn write(&self, scenario: &Scenario, said: &Said<'_>, row: &mut Row<'_>) -> Result<(), SheetError>;
}

impl Table for Frame {
    fn write(&self, scenario: &Scenario, said: &Said<'_>, row: &mut Row<'_>) -> Result<(), SheetError> {
        let Frame { stamp, vehicles, sea, flags, score, events: _, stopped, over } = self;
        begin(row, said);
        row.put("seq", stamp.seq);
        for (vehicle, truth) in scenario.vehicles.iter().zip(vehicles) {
            put_truth(row, scenario, &vehicle.name, truth);
        }
        let SeaView { wind_north_m_s, wind_east_m_s, current_north_m_s, current_east_m_s, elevation_m } = sea;
        row.put_of("sea", "wind_north_m_s", wind_north_m_s);
        row.put_of("sea", "wind_east_m_s", wind_east_m_s);
        row.put_of("sea", "current_north_m_s", current_north_m_s);
        row.put_of("sea", "current_east_m_s", current_east_m_s);
        row.put_of("sea", "elevation_m", elevation_m);
        put_flags(row, scenario, flags);
        put_score(row, scenario, score);
        let sentences: Vec<String> = events_of(scenario, self).iter().map(EventOutcome::sentence).collect();
        row.put("events", sentences.join("; "));
        row.put("stopped", stopped);
        row.put("over", over);
        Ok(row.end()?)
    }
}

/// What happened in a frame, with names; what names something that is not in the scenario is left out.
pub(super) fn events_of(scenario: &Scenario, frame: &Frame) -> Vec<EventOutcome> {
    frame.logged(scenario).map(|logged| EventOutcome::new(scenario, &logged)).collect()
}

impl Table for Picture {
    fn write(&self, scenario: &Scenario, said: &Said<'_>, row: &mut Row<'_>) -> Result<(), SheetError> {
        let Picture { stamp, team: _, own, contacts, flags, score, events: _, over } = self;
        let ends = |row: &mut Row<'_>| {
            put_flags(row, scenario, flags);
            put_score(row, scenario, score);
            row.put("over", over);
            row.end()
        };
        for boat in own {
            begin(row, said);
            row.put("seq", stamp.seq);
            row.put("seen", "own");
            put_own(row, scenario, boat);
            ends(row)?;
        }
        for contact in contacts {
            begin(row, said);
            row.put("seq", stamp.seq);
            row.put("seen", "contact");
            put_contact(row, scenario, contact);
            ends(row)?;
        }
        Ok(())
    }
}

impl Table for Inputs {
    fn write(&self, scenario: &Scenario, said: &Said<'_>, row: &mut Row<'_>) -> Result<(), SheetError> {
        for record in &self.inputs {
            begin(row, said);
            row.put("seq", self.stamp.seq);
            put_input(row, scenario, record);
            row.end()?;
        }
        Ok(())
    }
}

impl Table for Say {
    fn write(&self, scenario: &Scenario, said: &Said<'_>, row: &mut Row<'_>) -> Result<(), SheetError> {
        for Word { vehicle, key, value } in &self.words {
            begin(row, said);
            row.put("seq", self.stamp.seq);
            row.put("vehicle", name(scenario, *vehicle));
            row.put("key", format_args!("{key:016x}"));
            row.put("value", value);
            row.end()?;
        }
        Ok(())
    }
}

impl Table for PolicyProposal {
    fn write(&self, scenario: &Scenario, said: &Said<'_>, row: &mut Row<'_>) -> Result<(), SheetError> {
        let PolicyProposal { stamp, vehicle, course_rad, speed_m_s } = self;
        begin(row, said);
        row.put("seq", stamp.seq);
        row.put("vehicle", name(scenario, *vehicle));
        row.put("course_rad", course_rad);
        row.put("speed_m_s", speed_m_s);
        Ok(row.end()?)
    }
}

impl Table for NavReport {
    fn write(&self, scenario: &Scenario, said: &Said<'_>, row: &mut Row<'_>) -> Result<(), SheetError> {
        // The ticket is between the gateway and the sim.
        let NavReport { stamp, ticket: _, vehicle, valid, age_ns, nav } = self;
        begin(row, said);
        row.put("seq", stamp.seq);
        row.put("vehicle", name(scenario, *vehicle));
        row.put("valid", valid);
        row.put("age_s", time(SimTime(*age_ns)));
        put_nav(row, None, nav);
        Ok(row.end()?)
    }
}

impl Table for ExternalOrder {
    fn write(&self, scenario: &Scenario, said: &Said<'_>, row: &mut Row<'_>) -> Result<(), SheetError> {
        let ExternalOrder { stamp, given_ns, order } = self;
        begin(row, said);
        row.put("seq", stamp.seq);
        row.put("given_s", time(*given_ns));
        row.put("vehicle", name(scenario, order.vehicle));
        let known = order.order();
        row.put("order", known.map_or("", order_word));
        put_order(row, known);
        Ok(row.end()?)
    }
}

/// A row for each line on a link.
pub(super) fn link(recording: &Recording, topic: &str, row: &mut Row<'_>) -> Result<(), SheetError> {
    let mut lines = Lines::default();
    let mut last = SimTime::ZERO;
    for said in recording.on(topic) {
        last = said.at;
        for line in lines.take(&said.read::<LinkBytes>()?) {
            put_line(row, last, &line)?;
        }
    }
    for line in lines.rest() {
        put_line(row, last, &line)?;
    }
    Ok(row.otherwise(&["t_s", "direction", "text"])?)
}

fn put_line(row: &mut Row<'_>, at: SimTime, line: &Line) -> Result<(), SheetError> {
    row.put("t_s", time(at));
    row.put("direction", if line.outward { "to_boat" } else { "from_boat" });
    row.put("text", &line.text);
    Ok(row.end()?)
}

fn put_truth(row: &mut Row<'_>, scenario: &Scenario, of: &str, truth: &VehicleTruth) {
    let VehicleTruth {
        nav,
        heave_m,
        roll_rad,
        pitch_rad,
        port_newton,
        starboard_newton,
        tagged,
        carrying,
        disabled,
        outside,
        agent_lost,
        quarantined,
        nav_lost,
    } = truth;
    put_nav(row, Some(of), nav);
    row.put_of(of, "heave_m", heave_m);
    row.put_of(of, "roll_rad", roll_rad);
    row.put_of(of, "pitch_rad", pitch_rad);
    row.put_of(of, "port_newton", port_newton);
    row.put_of(of, "starboard_newton", starboard_newton);
    row.put_of(of, "tagged", tagged);
    row.put_of(of, "carrying", flag_name(scenario, *carrying));
    row.put_of(of, "disabled", disabled);
    row.put_of(of, "outside", outside);
    row.put_of(of, "agent_lost", agent_lost);
    row.put_of(of, "quarantined", quarantined);
    row.put_of(of, "nav_lost", nav_lost);
}

fn put_nav(row: &mut Row<'_>, of: Option<&str>, nav: &Nav) {
    let Nav { north_m, east_m, psi_rad, surge_m_s, sway_m_s, yaw_rate_rad_s } = nav;
    let mut put = |name: &str, value: &f64| match of {
        Some(of) => row.put_of(of, name, value),
        None => row.put(name, value),
    };
    put("north_m", north_m);
    put("east_m", east_m);
    put("psi_rad", psi_rad);
    put("surge_m_s", surge_m_s);
    put("sway_m_s", sway_m_s);
    put("yaw_rate_rad_s", yaw_rate_rad_s);
}

/// Own boats and contacts share their columns; what is known only of one kind is empty for the other.
fn put_own(row: &mut Row<'_>, scenario: &Scenario, boat: &OwnBoat) {
    let OwnBoat { vehicle, nav, fix_ns, imu, tagged, carrying, disabled, outside, tag_ready_ns } = boat;
    row.put("vehicle", name(scenario, *vehicle));
    row.put("seen_s", time(*fix_ns));
    put_nav(row, None, nav);
    row.put("velocity_north_m_s", "");
    row.put("velocity_east_m_s", "");
    row.put("tagged", tagged);
    row.put("carrying", flag_name(scenario, *carrying));
    row.put("disabled", disabled);
    row.put("outside", outside);
    row.put("tag_ready_s", time(*tag_ready_ns));
    let Imu { roll_rate_rad_s, pitch_rate_rad_s, yaw_rate_rad_s, ahead_m_s2, starboard_m_s2, down_m_s2 } = imu;
    row.put_of("imu", "roll_rate_rad_s", roll_rate_rad_s);
    row.put_of("imu", "pitch_rate_rad_s", pitch_rate_rad_s);
    row.put_of("imu", "yaw_rate_rad_s", yaw_rate_rad_s);
    row.put_of("imu", "ahead_m_s2", ahead_m_s2);
    row.put_of("imu", "starboard_m_s2", starboard_m_s2);
    row.put_of("imu", "down_m_s2", down_m_s2);
}

fn put_contact(row: &mut Row<'_>, scenario: &Scenario, contact: &Contact) {
    let Contact { vehicle, team: _, seen_ns, north_m, east_m, psi_rad, tagged, carrying, .. } = contact;
    row.put("vehicle", name(scenario, *vehicle));
    row.put("seen_s", time(*seen_ns));
    row.put("north_m", north_m);
    row.put("east_m", east_m);
    row.put("psi_rad", psi_rad);
    for unknown in ["surge_m_s", "sway_m_s", "yaw_rate_rad_s"] {
        row.put(unknown, "");
    }
    row.put("velocity_north_m_s", contact.velocity_north_m_s);
    row.put("velocity_east_m_s", contact.velocity_east_m_s);
    row.put("tagged", tagged);
    row.put("carrying", flag_name(scenario, *carrying));
    for unknown in ["disabled", "outside", "tag_ready_s"] {
        row.put(unknown, "");
    }
    for unknown in
        ["roll_rate_rad_s", "pitch_rate_rad_s", "yaw_rate_rad_s", "ahead_m_s2", "starboard_m_s2", "down_m_s2"]
    {
        row.put_of("imu", unknown, "");
    }
}

/// Who carries each flag; at its home, nobody.
fn put_flags(row: &mut Row<'_>, scenario: &Scenario, flags: &[FlagView]) {
    for (i, flag) in flags.iter().enumerate() {
        let carrier = u16::try_from(flag.carrier).ok().map_or("", |carrier| name(scenario, VehicleId(carrier)));
        row.put_of("flag", &format!("{}.carrier", flag_word(scenario, i)), carrier);
    }
}

fn put_score(row: &mut Row<'_>, scenario: &Scenario, score: &[u32]) {
    for (team, points) in scenario.teams.iter().zip(score) {
        row.put_of("score", &team.name, points);
    }
}

fn put_input(row: &mut Row<'_>, scenario: &Scenario, record: &InputRecord) {
    let input = record.input();
    let word = match input {
        Some(Input::Pictured) => "pictured",
        Some(Input::Ordered { order, .. }) => order_word(order),
        Some(Input::Held { .. }) => "held",
        Some(Input::AgentLost { .. }) => "agent_lost",
        Some(Input::AgentBack { .. }) => "agent_back",
        Some(Input::Reported { valid: true, .. }) => "reported",
        Some(Input::Reported { valid: false, .. }) => "reported_invalid",
        Some(Input::EStopped(true)) => "e_stopped",
        Some(Input::EStopped(false)) => "released",
        Some(Input::Halted(true)) => "halted",
        Some(Input::Halted(false)) => "went_on",
        Some(Input::Played) => "played",
        None => "",
    };
    row.put("input", word);
    row.put("vehicle", u16::try_from(record.vehicle).ok().map_or("", |vehicle| name(scenario, VehicleId(vehicle))));
    put_order(row, if let Some(Input::Ordered { order, .. }) = input { Some(order) } else { None });
    if let Some(Input::Reported { nav, fix_at, .. }) = input {
        row.put("fix_s", time(fix_at));
        return put_nav(row, None, &nav);
    }
    for unknown in ["fix_s", "north_m", "east_m", "psi_rad", "surge_m_s", "sway_m_s", "yaw_rate_rad_s"] {
        row.put(unknown, "");
    }
}

fn order_word(order: Order) -> &'static str {
    match order {
        Order::Hold => "hold",
        Order::Steer { .. } => "steer",
        Order::Thrust { .. } => "thrust",
    }
}

fn put_order(row: &mut Row<'_>, order: Option<Order>) {
    let numbers = match order {
        Some(Order::Steer { heading_rad, speed_m_s }) => [Some(heading_rad), Some(speed_m_s), None, None],
        Some(Order::Thrust { port, starboard }) => [None, None, Some(port), Some(starboard)],
        Some(Order::Hold) | None => [None; 4],
    };
    for (name, number) in ["heading_rad", "speed_m_s", "port", "starboard"].into_iter().zip(numbers) {
        row.put(name, number.map_or(String::new(), |number| number.to_string()));
    }
}

fn name(scenario: &Scenario, vehicle: VehicleId) -> &str {
    scenario.vehicles.get(vehicle.index()).map_or("", |vehicle| &vehicle.name)
}

/// The flag with this number, or nothing for none.
fn flag_name(scenario: &Scenario, flag: i16) -> String {
    usize::try_from(flag).map_or(String::new(), |flag| flag_word(scenario, flag))
}

/// A flag by its team, and with its number where it is not the team's first.
fn flag_word(scenario: &Scenario, flag: usize) -> String {
    let flags = &scenario.field.flags;
    let Some(team) = flags.get(flag).map(|flag| flag.team) else { return flag.to_string() };
    let team_name = scenario.teams.get(team.index()).map_or("", |team| &team.name);
    match flags[..flag].iter().filter(|other| other.team == team).count() {
        0 => team_name.to_owned(),
        more => format!("{team_name}_{}", more + 1),
    }
}

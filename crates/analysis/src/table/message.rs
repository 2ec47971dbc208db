//! The columns and rows of each kind of message. Columns are the fields of its ROS 2 definition,
//! with a few changes for tables: names instead of numbers, seconds instead of nanoseconds, a row
//! for each list item.

use super::cells::{Cells, flat, text, time};
use messages::external::{ExternalOrder, NavReport};
use messages::input::{Input, InputRecord, Inputs};
use messages::picture::FlagView;
use messages::{Frame, Message, Order, Picture, PolicyProposal, Say, ros};
use primitives::SimTime;
use recording::{RecordedMessage, RecordingError};
use scenario::Scenario;
use scenario::outcome::EventOutcome;
use serde::Serialize;
use serde_json::Value;

/// Columns shared by own boats and contacts; a value known for only one kind is empty for the
/// other.
const SEEN: &str = "\
    seq seen vehicle seen_s north_m east_m psi_rad surge_m_s sway_m_s yaw_rate_rad_s \
    velocity_north_m_s velocity_east_m_s tagged carrying disabled outside tag_ready_s \
    imu.roll_rate_rad_s imu.pitch_rate_rad_s imu.yaw_rate_rad_s imu.ahead_m_s2 \
    imu.starboard_m_s2 imu.down_m_s2";
/// The columns of an order.
const ORDER: &str = "heading_rad speed_m_s port starboard by_rad";

/// The columns for messages of a schema, without the time; `None` for an unsupported schema.
pub(super) fn columns(schema: &str, scenario: &Scenario) -> Option<Vec<String>> {
    let named = |names: &str| names.split(' ').map(str::to_owned).collect::<Vec<String>>();
    let mut columns = named("seq");
    let flags = (0..scenario.field.flags.len())
        .map(|flag| format!("flag.{}.carrier", flag_word(scenario, flag)));
    let score = scenario
        .teams
        .iter()
        .map(|team| format!("score.{}", team.name));
    match schema {
        Frame::SCHEMA => {
            for vehicle in &scenario.vehicles {
                columns.extend(
                    fields("VehicleTruth")
                        .iter()
                        .map(|field| format!("{}.{field}", vehicle.name)),
                );
            }
            columns.extend(fields("SeaView").iter().map(|field| format!("sea.{field}")));
            columns.extend(flags.chain(score).chain(named("events stopped over")));
        }
        Picture::SCHEMA => {
            columns = named(SEEN);
            columns.extend(flags.chain(score).chain(named("over")));
        }
        Inputs::SCHEMA => {
            columns.extend(named(&format!("input vehicle {ORDER} fix_s")));
            columns.extend(fields("Nav"));
        }
        Say::SCHEMA => columns.extend(fields("Word")),
        PolicyProposal::SCHEMA => columns = fields("PolicyProposal"),
        NavReport::SCHEMA => columns = fields("NavReport"),
        ExternalOrder::SCHEMA => {
            columns.extend(named(&format!("given_s vehicle order {ORDER}")));
        }
        _ => return None,
    }
    Some(columns)
}

/// The columns for the fields of a definition, including nested ones.
fn fields(definition: &str) -> Vec<String> {
    let text = ros::DEFINITIONS
        .iter()
        .find(|(name, _)| *name == definition)
        .map_or("", |(_, text)| text);
    let field = |line: &str| {
        let mut words = line
            .split('#')
            .next()
            .unwrap_or_default()
            .split_whitespace();
        let kind = words.next()?.to_owned();
        let name = words.next()?.to_owned();
        (!name.contains('=')).then_some((kind, name))
    };
    let columns_of = |(kind, name): (String, String)| match kind.rsplit_once('/') {
        Some((_, "Stamp")) => column("stamp.seq").into_iter().collect(),
        Some((_, part)) => fields(part)
            .iter()
            .filter_map(|field| column(&format!("{name}.{field}")))
            .collect(),
        None => column(&name).into_iter().collect::<Vec<String>>(),
    };
    text.lines()
        .filter_map(field)
        .flat_map(columns_of)
        .collect()
}

/// The column of a field: times are in s; fields internal to gateway and sim are omitted.
fn column(path: &str) -> Option<String> {
    let path = path.strip_prefix("nav.").unwrap_or(path);
    match path.strip_suffix("_ns") {
        _ if path == "ticket" => None,
        _ if path == "stamp.seq" => Some("seq".to_owned()),
        Some("fix" | "seen") => Some("seen_s".to_owned()),
        Some(time) => Some(format!("{time}_s")),
        None => Some(path.to_owned()),
    }
}

/// The rows of a message, without their time.
pub(super) fn rows(
    message: &RecordedMessage<'_>,
    scenario: &Scenario,
) -> Result<Vec<Cells>, RecordingError> {
    Ok(match message.schema.unwrap_or_default() {
        Frame::SCHEMA => vec![frame(&message.read()?, scenario)],
        Picture::SCHEMA => seen(&message.read()?, scenario),
        Inputs::SCHEMA => {
            let Inputs { stamp, inputs } = message.read()?;
            inputs
                .iter()
                .map(|record| with_seq(stamp.seq, input(record, scenario)))
                .collect()
        }
        Say::SCHEMA => {
            let Say { stamp, words, .. } = message.read()?;
            words
                .iter()
                .map(|word| with_seq(stamp.seq, cells_of(word, scenario)))
                .collect()
        }
        PolicyProposal::SCHEMA => vec![cells_of(&message.read::<PolicyProposal>()?, scenario)],
        NavReport::SCHEMA => vec![cells_of(&message.read::<NavReport>()?, scenario)],
        ExternalOrder::SCHEMA => {
            let ExternalOrder {
                stamp,
                given_ns,
                order: of_vehicle,
                ..
            } = message.read()?;
            let mut cells = of_vehicle.order().map(order).unwrap_or_default();
            put(&mut cells, "given_s", time(given_ns));
            put(
                &mut cells,
                "vehicle",
                name(scenario, i32::from(of_vehicle.vehicle.0)),
            );
            vec![with_seq(stamp.seq, cells)]
        }
        _ => vec![],
    })
}

fn put(cells: &mut Cells, column: &str, cell: impl ToString) {
    cells.insert(column.to_owned(), cell.to_string());
}

fn with_seq(seq: u64, mut cells: Cells) -> Cells {
    put(&mut cells, "seq", seq);
    cells
}

/// The fields of a message or of a nested part.
fn cells_of(part: &impl Serialize, scenario: &Scenario) -> Cells {
    let fields = flat(&serde_json::to_value(part).expect("a message is JSON"));
    fields
        .iter()
        .filter_map(|(path, value)| Some((column(path)?, cell(path, value, scenario))))
        .collect()
}

fn cell(path: &str, value: &Value, scenario: &Scenario) -> String {
    let number = || value.as_i64().unwrap_or(-1);
    match path {
        "vehicle" => name(scenario, number()).to_owned(),
        "carrying" => {
            usize::try_from(number()).map_or(String::new(), |flag| flag_word(scenario, flag))
        }
        "key" => format!("{:016x}", value.as_u64().unwrap_or_default()),
        _ if path.ends_with("_ns") => time(SimTime(number())),
        _ => match value.as_f64().filter(|_| value.is_f64()) {
            Some(number) => number.to_string(),
            None => text(value),
        },
    }
}

fn frame(frame: &Frame, scenario: &Scenario) -> Cells {
    let mut cells = ends(&frame.flags, &frame.score, frame.over, scenario);
    let mut put_all = |of: &str, part: Cells| {
        cells.extend(
            part.into_iter()
                .map(|(name, cell)| (format!("{of}.{name}"), cell)),
        )
    };
    for (vehicle, truth) in scenario.vehicles.iter().zip(&frame.vehicles) {
        put_all(&vehicle.name, cells_of(truth, scenario));
    }
    put_all("sea", cells_of(&frame.sea, scenario));
    let sentences = frame
        .logged(scenario)
        .map(|logged| EventOutcome::new(scenario, &logged).sentence());
    put(
        &mut cells,
        "events",
        sentences.collect::<Vec<String>>().join("; "),
    );
    put(&mut cells, "stopped", frame.stopped);
    with_seq(frame.stamp.seq, cells)
}

/// A row for each boat in a picture.
fn seen(picture: &Picture, scenario: &Scenario) -> Vec<Cells> {
    let own = picture
        .own
        .iter()
        .map(|boat| ("own", cells_of(boat, scenario)));
    let contacts = picture
        .contacts
        .iter()
        .map(|contact| ("contact", cells_of(contact, scenario)));
    let row = |(kind, mut cells): (&str, Cells)| {
        put(&mut cells, "seen", kind);
        cells.extend(ends(&picture.flags, &picture.score, picture.over, scenario));
        with_seq(picture.stamp.seq, cells)
    };
    own.chain(contacts).map(row).collect()
}

/// The carrier of each flag (empty at home), the score, and whether the game is over.
fn ends(flags: &[FlagView], score: &[u32], over: bool, scenario: &Scenario) -> Cells {
    let mut cells = Cells::new();
    for (i, flag) in flags.iter().enumerate() {
        put(
            &mut cells,
            &format!("flag.{}.carrier", flag_word(scenario, i)),
            name(scenario, flag.carrier),
        );
    }
    for (team, points) in scenario.teams.iter().zip(score) {
        put(&mut cells, &format!("score.{}", team.name), points);
    }
    put(&mut cells, "over", over);
    cells
}

fn input(record: &InputRecord, scenario: &Scenario) -> Cells {
    let input = record.input();
    let mut cells = match input {
        Some(Input::Ordered { order: given, .. }) => order(given),
        Some(Input::Reported { nav, .. }) => cells_of(&nav, scenario),
        _ => Cells::new(),
    };
    let word = match input {
        // For an order, the kind of input is the name of the order.
        Some(Input::Ordered { .. }) => cells.remove("order").unwrap_or_default(),
        Some(Input::Pictured) => "pictured".to_owned(),
        Some(Input::Held(_)) => "held".to_owned(),
        Some(Input::AgentLost(_)) => "agent_lost".to_owned(),
        Some(Input::AgentBack(_)) => "agent_back".to_owned(),
        Some(Input::Reported { valid, .. }) => if valid {
            "reported"
        } else {
            "reported_invalid"
        }
        .to_owned(),
        Some(Input::EStopped(on)) => if on { "e_stopped" } else { "released" }.to_owned(),
        Some(Input::Halted(on)) => if on { "halted" } else { "went_on" }.to_owned(),
        Some(Input::Played) => "played".to_owned(),
        None => String::new(),
    };
    put(&mut cells, "input", word);
    put(&mut cells, "vehicle", name(scenario, record.vehicle));
    if let Some(Input::Reported { fix_at, .. }) = input {
        put(&mut cells, "fix_s", time(fix_at));
    }
    cells
}

fn order(order: Order) -> Cells {
    let (word, numbers) = match order {
        Order::Hold => ("hold", vec![]),
        Order::Steer {
            heading_rad,
            speed_m_s,
        } => (
            "steer",
            vec![("heading_rad", heading_rad), ("speed_m_s", speed_m_s)],
        ),
        Order::Turn { by_rad, speed_m_s } => {
            ("turn", vec![("by_rad", by_rad), ("speed_m_s", speed_m_s)])
        }
        Order::Thrust { port, starboard } => {
            ("thrust", vec![("port", port), ("starboard", starboard)])
        }
    };
    let mut cells = Cells::new();
    put(&mut cells, "order", word);
    numbers
        .into_iter()
        .for_each(|(name, number)| put(&mut cells, name, number));
    cells
}

/// The name of the boat with this number; empty if there is none.
fn name(scenario: &Scenario, vehicle: impl TryInto<usize>) -> &str {
    let vehicle = vehicle
        .try_into()
        .ok()
        .and_then(|vehicle| scenario.vehicles.get(vehicle));
    vehicle.map_or("", |vehicle| &vehicle.name)
}

/// The name of a flag's team, with the flag's number if it is not the team's first.
fn flag_word(scenario: &Scenario, flag: usize) -> String {
    let flags = &scenario.field.flags;
    let Some(team) = flags.get(flag).map(|flag| flag.team) else {
        return flag.to_string();
    };
    let team_name = scenario
        .teams
        .get(team.index())
        .map_or("", |team| &team.name);
    match flags[..flag]
        .iter()
        .filter(|other| other.team == team)
        .count()
    {
        0 => team_name.to_owned(),
        more => format!("{team_name}_{}", more + 1),
    }
}

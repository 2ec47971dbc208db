//! Tests of the database: registration, types, clients that leave, and the messages that each
//! client receives.

use super::*;
use crate::mail::MAIL_MAX;
use crate::wire::Framer;

const NOW_S: f64 = 1_000.0;

fn notify(key: &str, number: f64) -> Msg {
    Msg::number(Kind::NOTIFY, key, number, -1.0)
}

/// A database with one client for each of these names, and the clients' mail.
fn database(names: &[&str]) -> (Database, Vec<Arc<Watched<Mail>>>) {
    let mut database = Database::new(
        "blue_one",
        BTreeSet::from(["DESIRED_SPEED".to_owned()]),
        NOW_S,
    );
    let mut admit = |name: &&str| {
        database
            .admit(&Msg::text(Kind::DATA, "", name, NOW_S), NOW_S)
            .expect("a name that is free")
            .1
    };
    let mail = names.iter().map(&mut admit).collect();
    (database, mail)
}

fn read(mail: &Watched<Mail>) -> Vec<(String, f64)> {
    let Some(packet) = mail.visit(|mail| mail.take_packet(None)) else {
        return vec![];
    };
    let mut framer = Framer::default();
    framer.push(&packet);
    let messages = framer.next_packet().expect("sound").expect("whole");
    messages
        .into_iter()
        .map(|msg| (msg.key.clone(), msg.as_number().unwrap_or(f64::NAN)))
        .collect()
}

fn pairs(expected: &[(&str, f64)]) -> Vec<(String, f64)> {
    expected
        .iter()
        .map(|(key, number)| ((*key).to_owned(), *number))
        .collect()
}

#[test]
fn subscribers_get_the_last_value_and_then_each_new_one_at_their_interval() {
    let (mut database, mail) = database(&["pA", "pB"]);
    database.receive(
        "pA",
        vec![notify("NAV_X", 1.0), notify("NAV_X", 2.0)],
        NOW_S,
    );
    let register = Msg::number(Kind::REGISTER, "NAV_X", 0.0, NOW_S);
    database.receive("pA", vec![register.clone()], NOW_S);
    database.receive(
        "pB",
        vec![Msg {
            number: 10.0,
            ..register.clone()
        }],
        NOW_S,
    );
    assert_eq!(
        [read(&mail[0]), read(&mail[1])],
        [pairs(&[("NAV_X", 2.0)]), pairs(&[("NAV_X", 2.0)])]
    );
    for (passed_s, number) in [(4.0, 3.0), (10.0, 4.0), (12.0, 5.0)] {
        database.receive("pB", vec![notify("NAV_X", number)], NOW_S + passed_s);
    }
    assert_eq!(
        read(&mail[0]),
        pairs(&[("NAV_X", 3.0), ("NAV_X", 4.0), ("NAV_X", 5.0)])
    );
    assert_eq!(
        read(&mail[1]),
        pairs(&[("NAV_X", 4.0)]),
        "at most every 10 s"
    );
    database.receive(
        "pA",
        vec![
            Msg {
                kind: Kind::UNREGISTER,
                ..register
            },
            notify("NAV_X", 6.0),
        ],
        NOW_S + 30.0,
    );
    assert_eq!(read(&mail[0]), []);
}

#[test]
fn patterns_choose_source_and_variable_and_include_variables_to_come() {
    let (mut database, mail) = database(&["uXMS", "pA"]);
    database.receive(
        "pA",
        vec![notify("NAV_X", 1.0), notify("DEPTH", 1.0)],
        NOW_S,
    );
    // Patterns as written by MOOS clients and by `pymoos2`.
    for (spec, want) in [
        (
            "AppPattern=p?,VarPattern=NAV_*,Interval=0",
            &[("NAV_X", 1.0), ("NAV_X", 2.0), ("NAV_Y", 3.0)][..],
        ),
        (
            "AppPattern=* VarPattern=NAV_Y Interval=0.0",
            &[("NAV_Y", 3.0), ("NAV_Y", 3.0)],
        ),
        ("AppPattern=q*,VarPattern=*,Interval=0", &[]),
    ] {
        let wildcard = Msg::text(Kind::WILDCARD, "uXMS", spec, NOW_S);
        database.receive("uXMS", vec![wildcard.clone()], NOW_S);
        database.receive(
            "pA",
            vec![notify("NAV_X", 2.0), notify("NAV_Y", 3.0)],
            NOW_S,
        );
        assert_eq!(read(&mail[0]), pairs(want), "{spec}");
        database.receive(
            "uXMS",
            vec![Msg {
                kind: Kind::WILDCARD_END,
                ..wildcard
            }],
            NOW_S,
        );
        database.receive("pA", vec![notify("NAV_X", 1.0)], NOW_S);
        assert_eq!(read(&mail[0]), [], "{spec}");
    }
}

#[test]
fn the_first_writer_fixes_the_type_and_only_chosen_variables_reach_the_bridge() {
    let (mut database, mail) = database(&["pHelmIvP"]);
    database.receive(
        "pHelmIvP",
        vec![Msg::number(Kind::REGISTER, "DESIRED_SPEED", 0.0, NOW_S)],
        NOW_S,
    );
    database.receive(
        "pHelmIvP",
        vec![notify("DESIRED_SPEED", 1.0), notify("OTHER", 1.0)],
        NOW_S,
    );
    let text = Msg::text(Kind::NOTIFY, "DESIRED_SPEED", "fast", NOW_S);
    database.notify(text, NOW_S);
    assert_eq!(read(&mail[0]), pairs(&[("DESIRED_SPEED", 1.0)]));
    assert_eq!(
        database.dropped,
        Dropped {
            wrong_type: 1,
            ..Dropped::default()
        }
    );
    let (heard, notes) = database.take_heard();
    let heard: Vec<(&str, &str)> = heard
        .iter()
        .map(|msg| (msg.key.as_str(), msg.source.as_str()))
        .collect();
    assert_eq!(
        (heard, notes.len()),
        (vec![("DESIRED_SPEED", "pHelmIvP")], 0)
    );
}

#[test]
fn a_name_is_used_once_and_clocks_of_another_warp_are_reported() {
    let (mut database, _mail) = database(&["pHelmIvP"]);
    for (name, want) in [
        ("pHelmIvP", "in use"),
        (BRIDGE, "in use"),
        ("", "1 to 128"),
        (&"x".repeat(200), "1 to 128"),
    ] {
        let refusal = database
            .admit(&Msg::text(Kind::DATA, "", name, NOW_S), NOW_S)
            .map(|_| ())
            .unwrap_err();
        assert!(refusal.contains(want), "{refusal}");
    }
    database.remove("pHelmIvP", NOW_S);
    let (welcome, _) = database
        .admit(&Msg::text(Kind::DATA, "", "pHelmIvP", NOW_S / 4.0), NOW_S)
        .expect("a name that is free again");
    assert_eq!(
        (welcome.number, welcome.as_text()),
        (750.0, Some(wire::ASYNCHRONOUS))
    );
    assert!(database.take_heard().1[0].contains("differs by 750 s"));
    assert_eq!(database.dropped.refused, 4);
}

#[test]
fn clients_cannot_fill_the_memory() {
    let (mut database, mail) = database(&["pA"]);
    let big = |key: &str| Msg {
        bytes: vec![b'x'; 200_000],
        ..Msg::text(Kind::NOTIFY, key, "", NOW_S)
    };
    database.receive(
        "pA",
        vec![Msg::number(Kind::REGISTER, "IMAGE", 0.0, NOW_S)],
        NOW_S,
    );
    (0..100).for_each(|_| database.notify(big("IMAGE"), NOW_S));
    let unread = mail[0].visit(|mail| mail.bytes);
    assert!(
        unread <= MAIL_MAX && database.dropped.unread > 50,
        "{unread} {:?}",
        database.dropped
    );
    (0..500).for_each(|i| database.notify(big(&format!("IMAGE_{i}")), NOW_S));
    assert!(
        database.stored <= STORED_MAX && database.dropped.over_limit > 100,
        "{:?}",
        database.dropped
    );
    (0..VARIABLES_MAX).for_each(|i| database.notify(notify(&format!("X{i}"), 0.0), NOW_S));
    assert_eq!(database.variables.len(), VARIABLES_MAX);
    let flood: Vec<Msg> = (0..9000)
        .map(|i| notify("DESIRED_SPEED", f64::from(i)))
        .collect();
    database.receive("pA", flood, NOW_S);
    let heard: Vec<f64> = database
        .take_heard()
        .0
        .iter()
        .map(|msg| msg.number)
        .collect();
    assert_eq!(heard, [8999.0], "the newest value alone");
}

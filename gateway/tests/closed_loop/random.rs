//! Runs random scenarios with any events in any order; the oracle checks every sentence.

use crate::script::{play, played};
use proptest::prelude::*;
use proptest::sample::select;

fn lines() -> impl Strategy<Value = Vec<String>> {
    let of = |lines: &[&str]| {
        select(
            lines
                .iter()
                .map(|line| (*line).to_owned())
                .collect::<Vec<_>>(),
        )
    };
    let orders = [
        "none",
        "hold",
        "steer NaN 1",
        "thrust -0.5 0.7",
        "steer 200 2",
    ]
    .map(|order| format!("order {order}"));
    let heading = "mode {\"heading\":{\"heading_deg\":200,\"thrust_pct\":30}}";
    let commands = [
        "disarm",
        "e_stop",
        "release",
        "station_keep",
        "go_to_erp",
        heading,
        "mode \"river_nav\"",
        "arm",
        "arm",
    ];
    let one = prop_oneof![
        4 => (1..40_u8).prop_map(|tenths| format!("run {}", 0.1 * f64::from(tenths))),
        2 => select([&orders[..], &["agent-hangs".to_owned()]].concat()),
        4 => select(commands.map(|command| format!("operator {command}")).to_vec()),
        1 => of(&["link up", "link down"]),
        1 => of(&["open both", "open to-boat", "open from-boat", "open neither"]),
        1 => of(&["tamper none", "tamper all-lost", "tamper second-half-lost", "tamper xor 8"]),
        1 => any::<u8>().prop_map(|far_m| format!("jump {far_m} 0")),
        1 => of(&["fixes live", "fixes frozen"]),
        1 => of(&["control Secondary", "control Secondary", "control Primary", "control Rc"]),
        1 => of(&["volts 20", "volts 25"]),
        1 => of(&["other 0 0", "other none"]),
        1 => of(&["fleet e_stop", "fleet release"]),
    ];
    proptest::collection::vec(one, 1..60)
}

/// After all disturbances, the boat can be armed.
const QUIET: &str = "open both\ntamper none\nother none\nfixes live\nvolts 25\ncontrol Secondary\nlink up\norder hold
appear 60 40\noperator release\nfleet release\nrun 12\noperator arm\nexpect refused =\nexpect state = armed";

/// The only sentence of a dry run.
const STANDBY: &str = "$PSEAC,L,0,0,0,*14\r\n";

/// In a dry run, orders and tasks are processed as usual.
const DRIVEN: &str = "order steer 90 2\nrun 60\nexpect state = armed\nexpect would-send ^ $PSEAC,T,0,\nexpect mode = L
operator mission 80,60\nexpect refused ~ a dry run\noperator station_keep\nrun 20\nexpect state = delegated: station keeping
expect would-send ^ $PSEAC,R\nfleet e_stop\nrun 1\nexpect state = e-stopped";

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, failure_persistence: None, ..ProptestConfig::default() })]

    #[test]
    fn whatever_happens_nothing_forbidden_is_sent(watchdog in any::<bool>(), lines in lines()) {
        let mut rig = played(if watchdog { "under-way watchdog 2" } else { "under-way" });
        lines.iter().map(String::as_str).chain(QUIET.lines()).for_each(|line| play(&mut rig, line));
    }

    #[test]
    fn in_a_dry_run_every_byte_is_of_a_standby_sentence(lines in lines()) {
        let mut rig = played("boat dry-run yes");
        for line in lines.iter().map(String::as_str).chain(QUIET.lines()).chain(DRIVEN.lines()) {
            play(&mut rig, line);
        }
        let outs = rig.turns.iter().map(|(_, _, out)| out.bytes.as_slice());
        let bytes = outs.chain([rig.bridge.shutdown_message().as_slice()]).collect::<Vec<_>>().concat();
        prop_assert!(!bytes.is_empty() && bytes.len() % STANDBY.len() == 0, "{} bytes", bytes.len());
        for sentence in bytes.chunks(STANDBY.len()) {
            prop_assert_eq!(String::from_utf8_lossy(sentence), STANDBY);
        }
    }
}

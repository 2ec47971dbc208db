//! Link addresses as users type them, listed in `addresses.txt`.

use gateway::link::LinkAddress::{self, Pty, Serial, Tcp, Udp, UdpListen};
use gateway::link::Side::{self, Connects, Listens};

#[test]
fn addresses_are_read_printed_and_refused_as_they_are_listed() {
    let list = std::fs::read_to_string(concat!(
        env!("CARGO_MANIFEST_DIR"),
        "/tests/link/addresses.txt"
    ))
    .unwrap();
    let rows = list
        .lines()
        .filter(|line| line.contains('|') && !line.starts_with('#'));
    let mut count = 0;
    for row in rows {
        let cells: Vec<&str> = row.split('|').map(str::trim).collect();
        check(
            cells[0],
            Connects,
            LinkAddress::to_connect(cells[0]).map_err(|e| e.to_string()),
            cells[1],
        );
        check(
            cells[0],
            Listens,
            LinkAddress::to_listen(cells[0]).map_err(|e| e.to_string()),
            cells[2],
        );
        count += 1;
    }
    assert!(count > 40, "only {count} addresses are listed");
}

fn check(text: &str, side: Side, got: Result<LinkAddress, String>, want: &str) {
    match (got, want.strip_prefix("refused: ")) {
        (_, None) if want == "-" => {}
        (Ok(address), None) => {
            assert_eq!(in_words(&address, side), want, "{text}");
            let is_whole = text.contains("baud") || !text.starts_with("serial");
            assert!(
                !is_whole || address.to_string() == text,
                "{text} is printed as {address}"
            );
        }
        (Err(error), Some(parts)) => {
            assert!(error.contains(&format!("{text:?}")), "{text}: {error}");
            parts.split(" … ").for_each(|part| {
                assert!(
                    error.contains(part),
                    "the error for {text} should contain {part}: {error}"
                )
            });
        }
        (got, _) => panic!("{text} for the side that {side:?}: {got:?}, not {want}"),
    }
}

fn in_words(address: &LinkAddress, side: Side) -> String {
    match address {
        Tcp(of, at) if *of == side => format!("tcp {} {}", at.host, at.port),
        Udp(of, at) if *of == side => format!("udp {} {}", at.host, at.port),
        UdpListen(at) => format!("udp-listen {} {}", at.host, at.port),
        Serial { path, baud } => format!("serial {} {baud}", path.display()),
        Pty { link: None } => "pty".to_owned(),
        Pty { link: Some(link) } => format!("pty {}", link.display()),
        other => format!("{other:?}"),
    }
}

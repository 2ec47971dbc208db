//! One-line inputs from users and nodes: link addresses, game names, tokens, node keys.

use super::{Target, check_shown, mutations};
use bus::Token;
use gateway::link::LinkAddress;
use messages::topic::{self, GameName};

pub(super) const TARGET: Target = Target {
    name: "address",
    seeds,
    change: mutations,
    check,
    allocated_max: (100_000, 200),
};

fn seeds() -> Vec<Vec<u8>> {
    let list = include_str!("../../../../gateway/tests/link/addresses.txt");
    let addresses = list
        .lines()
        .filter(|line| line.contains('|') && !line.starts_with('#'));
    let addresses = addresses
        .filter_map(|line| line.split('|').next())
        .map(|address| address.trim().to_owned());
    let token = "0123456789abcdef".repeat(4);
    let game = GameName::new("pav01-3f").expect("a name");
    let key = topic::alive(&game, "a7");
    addresses
        .chain([game.as_str().to_owned(), token, key])
        .map(String::into_bytes)
        .collect()
}

fn check(bytes: &[u8]) {
    let text = String::from_utf8_lossy(bytes);
    for read in [LinkAddress::to_connect, LinkAddress::to_listen] {
        match read(&text) {
            Ok(address) => assert_eq!(
                read(&address.to_string()),
                Ok(address),
                "printed and read again"
            ),
            Err(error) => check_shown(&error),
        }
    }
    match GameName::new(&text) {
        // The name becomes part of key expressions, in which these characters have a meaning.
        Ok(name) => assert!(
            name.as_str() == text && !text.contains(['/', '*', '$', '#', '?']) && !text.is_empty()
        ),
        Err(error) => check_shown(&error),
    }
    match text.parse::<Token>() {
        Ok(token) => assert_eq!(token.hex(), text.trim().to_lowercase()),
        Err(error) => {
            check_shown(&error);
            assert!(
                text.len() < 20 || !error.to_string().contains(&*text),
                "an error must not contain the token"
            );
        }
    }
    if let Some((game, sim)) = topic::parse_alive(&text) {
        assert_eq!(
            topic::parse_alive(&topic::alive(&game, &sim)),
            Some((game, sim))
        );
    }
}

//! Parsers of link addresses on the command line.

use gateway::link::{LinkAddress, LinkAddressError};

/// Parses the address of a boat to connect to.
///
/// # Errors
/// The fault and the addresses allowed.
pub fn to_connect(text: &str) -> Result<LinkAddress, String> {
    LinkAddress::to_connect(text).map_err(without_address)
}

/// Parses an address to listen on.
///
/// # Errors
/// The fault and the addresses allowed.
pub fn to_listen(text: &str) -> Result<LinkAddress, String> {
    LinkAddress::to_listen(text).map_err(without_address)
}

/// The fault without the address, because the argument parser prints the address.
fn without_address(LinkAddressError { found, allowed, .. }: LinkAddressError) -> String {
    format!("{found}, expected {allowed}")
}

//! pShare datagrams: each carries one message, without acknowledgement.

use crate::wire::{self, Msg};
use std::io;
use std::net::{SocketAddr, UdpSocket};

/// Maximum length of a pShare datagram, bytes.
const DATAGRAM_MAX: usize = 48 << 10;
/// Maximum number of datagrams per call of [`Share::receive`].
const READ_MAX: usize = 256;

/// A socket that sends to and receives from instances of pShare.
pub struct Share {
    socket: UdpSocket,
    to: Vec<SocketAddr>,
    /// Number of datagrams that could not be decoded.
    pub malformed: u64,
}

impl Share {
    /// Opens a socket that sends to these addresses and listens at `listen`.
    ///
    /// # Errors
    /// If the port is in use or the system refuses.
    pub fn open(listen: SocketAddr, to: Vec<SocketAddr>) -> io::Result<Share> {
        let socket = UdpSocket::bind(listen)?;
        socket.set_nonblocking(true)?;
        Ok(Share {
            socket,
            to,
            malformed: 0,
        })
    }

    /// The address on which the socket listens.
    ///
    /// # Errors
    /// If the system does not know it.
    pub fn address(&self) -> io::Result<SocketAddr> {
        self.socket.local_addr()
    }

    /// Sends a message unless it is too long. If the network does not accept it at once, it is
    /// lost.
    pub fn send(&self, msg: &Msg) {
        let mut datagram = Vec::new();
        wire::encode(msg, &mut datagram);
        if datagram.len() <= DATAGRAM_MAX {
            self.to
                .iter()
                .for_each(|to| drop(self.socket.send_to(&datagram, to)));
        }
    }

    /// The messages that have arrived. Malformed datagrams are counted.
    pub fn receive(&mut self) -> Vec<Msg> {
        let mut bytes = vec![0; DATAGRAM_MAX + 1];
        let mut received = Vec::new();
        for _ in 0..READ_MAX {
            let Ok((length, _)) = self.socket.recv_from(&mut bytes) else {
                break;
            };
            match wire::decode(&bytes[..length]) {
                Ok(msg) => received.push(msg),
                Err(_) => self.malformed += 1,
            }
        }
        received
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wire::Kind;
    use std::time::Duration;

    #[test]
    fn a_message_arrives_and_garbage_is_counted() {
        let local: SocketAddr = "127.0.0.1:0".parse().unwrap();
        let mut shore = Share::open(local, vec![]).unwrap();
        let boat = Share::open(local, vec![shore.address().unwrap()]).unwrap();
        let msg = Msg::text(Kind::NOTIFY, "DEPLOY_ALL", "true", 1.0);
        boat.send(&msg);
        boat.send(&Msg {
            bytes: vec![0; DATAGRAM_MAX],
            ..msg.clone()
        });
        boat.socket
            .send_to(b"no message", shore.address().unwrap())
            .unwrap();
        let mut received = Vec::new();
        let start = bus::clock::now();
        while shore.malformed == 0 && bus::clock::since(start) < Duration::from_secs(5) {
            received.extend(shore.receive());
        }
        assert_eq!(
            (received, shore.malformed),
            (vec![msg], 1),
            "the message that is too long is not sent"
        );
    }
}

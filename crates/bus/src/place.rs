//! The place of a game and its token. Both are looked up before every attempt to connect: the sim
//! may start later than the searching node, and the next sim may have a different place and token.

use crate::game_search::{Missing, Refusal};
use crate::token::CurrentToken;
use crate::{Bus, Net};
use messages::topic::GameName;
use std::sync::Arc;

/// Finds the place of a game: the named game, or the only one running.
type Find = dyn Fn(Option<&GameName>) -> Result<Net, String> + Send + Sync;

/// The place of a game, looked up on demand.
#[derive(Clone)]
pub struct Place {
    find: Arc<Find>,
    /// The last known token.
    pub token: CurrentToken,
}

/// A session, and the place it leads to.
pub type PlacedSession = Option<(Net, Bus)>;

impl Place {
    /// A place that `find` looks up; its errors are permanent.
    pub fn new(
        find: impl Fn(Option<&GameName>) -> Result<Net, String> + Send + Sync + 'static,
    ) -> Place {
        Place {
            find: Arc::new(find),
            token: CurrentToken::default(),
        }
    }

    /// The current place of the game, and its token if known.
    ///
    /// # Errors
    /// [`Missing`] if the lookup fails.
    pub fn net(&self, game: Option<&GameName>) -> Result<Net, Missing> {
        let net = (self.find)(game).map_err(|reason| Missing::Forever(Refusal::Refused(reason)))?;
        // If no game is found, the last known token stays until a new game appears.
        if net.token.is_some() {
            self.token.set(net.token.clone());
        }
        Ok(net)
    }

    /// A session at the place of a game; reuses the previous session if it leads there.
    pub(crate) fn session(
        &self,
        game: Option<&GameName>,
        session: &mut PlacedSession,
    ) -> Result<Bus, Missing> {
        let net = self.net(game)?;
        match session {
            // Opening a session costs five round trips, so keep it while it leads to the same
            // place.
            Some((there, bus)) if *there == net => return Ok(bus.clone()),
            Some((_, bus)) => bus.close(),
            None => {}
        }
        *session = None;
        let bus = Bus::leaf(&net)?;
        *session = Some((net, bus.clone()));
        Ok(bus)
    }
}

impl From<Net> for Place {
    /// A fixed place.
    fn from(net: Net) -> Place {
        Place::new(move |_| Ok(net.clone()))
    }
}

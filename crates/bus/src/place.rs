//! Where a game is, and what its token is: asked anew before each attempt to reach it, since the sim may begin later than the node
//! that looks for it, and the next sim may be elsewhere and has another token.

use crate::missing::{Missing, Refusal};
use crate::token::CurrentToken;
use crate::{Bus, Net};
use messages::topic::GameName;
use std::sync::Arc;

/// Says where a game is: this one, or the only one there.
type Find = dyn Fn(Option<&GameName>) -> Result<Net, String> + Send + Sync;

/// The place of a game.
#[derive(Clone)]
pub struct Place {
    find: Arc<Find>,
    token: CurrentToken,
}

/// A session, and where it leads to.
pub type PlacedSession = Option<(Net, Bus)>;

impl Place {
    /// A place that is looked up by `find`; an error is one that looking again does not mend.
    #[must_use]
    pub fn new(find: impl Fn(Option<&GameName>) -> Result<Net, String> + Send + Sync + 'static) -> Place {
        Place { find: Arc::new(find), token: CurrentToken::default() }
    }

    /// Where the game is now, and its token if that is known.
    ///
    /// # Errors
    /// [`Missing`] if that cannot be told.
    pub fn net(&self, game: Option<&GameName>) -> Result<Net, Missing> {
        let net = (self.find)(game).map_err(|reason| Missing::Forever(Refusal::Refused(reason)))?;
        // The token of a game that is gone is that of whoever was in it, until there is another.
        if net.token.is_some() {
            self.token.set(net.token.clone());
        }
        Ok(net)
    }

    /// The token that was known last.
    #[must_use]
    pub fn token(&self) -> &CurrentToken {
        &self.token
    }

    /// A session at the place of a game: that of the attempt before, if it leads there.
    pub(crate) fn session(&self, game: Option<&GameName>, session: &mut PlacedSession) -> Result<Bus, Missing> {
        let net = self.net(game)?;
        match session {
            // Opening a session costs five round trips, so it is kept as long as it leads to
            // the same place.
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
    /// A place that never changes.
    fn from(net: Net) -> Place {
        Place::new(move |_| Ok(net.clone()))
    }
}

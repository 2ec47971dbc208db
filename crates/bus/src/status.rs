//! The status of a boat's gateway, as the sim publishes it.

use crate::{Bus, BusError, Declaration};
use messages::external::GatewayStatus;
use messages::topic::{self, GameName};

impl Bus {
    /// Calls `take` with every status of this boat's gateway; drops unreadable statuses and those
    /// of other boats.
    ///
    /// # Errors
    /// [`BusError`] if the session is closed.
    pub fn subscribe_status(
        &self,
        game: &GameName,
        vehicle: &str,
        take: impl Fn(GatewayStatus) + Send + Sync + 'static,
    ) -> Result<Declaration, BusError> {
        let name = vehicle.to_owned();
        self.subscribe(topic::status(game, vehicle), move |bytes| {
            let status = serde_json::from_slice::<GatewayStatus>(bytes).ok();
            // Operators read the name in the status; a status whose name does not match its key is
            // invalid.
            status.filter(|status| status.vehicle == name).into_iter().for_each(&take);
        })
    }
}

//! Channels: kinds of sample that share one noise model.

use crate::observe::measured::Quantity;

/// A kind of sample that shares its noise.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Channel {
    /// Normal force.
    Force,
    /// Force across.
    Tangential,
    /// Contact area.
    Area,
    /// Sensels.
    Pressure,
    /// Scanned points.
    Scan,
}

impl Channel {
    /// Of a quantity.
    pub fn of(quantity: Quantity) -> Channel {
        match quantity {
            Quantity::Force => Channel::Force,
            Quantity::TangentialForce => Channel::Tangential,
            Quantity::Area => Channel::Area,
            Quantity::Pressure(_) => Channel::Pressure,
            Quantity::Scan(_) => Channel::Scan,
        }
    }
}

/// All channels.
pub const CHANNELS: [Channel; 5] = [
    Channel::Force,
    Channel::Tangential,
    Channel::Area,
    Channel::Pressure,
    Channel::Scan,
];

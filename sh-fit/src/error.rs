//! What can go wrong when lobes are fitted.

/// Why a fit could not be made. Every message names the item and the cause.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An option has a value that cannot be used.
    #[error("{0}")]
    Option(String),
    /// A coefficient of the one vector that was to be fitted is infinite or not a number.
    #[error("coefficient {index} of channel {channel} is {value}; only finite numbers can be fitted")]
    NotFinite {
        /// The channel.
        channel: usize,
        /// The index `i` of the coefficient.
        index: usize,
        /// The coefficient.
        value: f64,
    },
    /// A triangle names a point that does not exist.
    #[error("triangle {triangle} names point {point}; there are {point_count}")]
    Triangle {
        /// Number of the triangle.
        triangle: usize,
        /// The point it names.
        point: u32,
        /// How many points there are.
        point_count: usize,
    },
    /// The neighbourhood was made for another number of points.
    #[error("the neighbourhood has {neighbours} points; {points} are to be fitted")]
    Neighbours {
        /// Points of the neighbourhood.
        neighbours: usize,
        /// Points that are to be fitted.
        points: usize,
    },
}

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
    /// A number of a model is out of its range.
    #[error("{what} is {given}; it must be {accepted}")]
    Parameter {
        /// Which number.
        what: &'static str,
        /// Its value.
        given: f64,
        /// The values that have a meaning.
        accepted: &'static str,
    },
    /// The same for one of many.
    #[error("{what} {item} is {given}; it must be {accepted}")]
    Item {
        /// What the number is.
        what: &'static str,
        /// Which one of them.
        item: usize,
        /// Its value.
        given: f64,
        /// The values that have a meaning.
        accepted: &'static str,
    },
    /// A table of a reflectance has another number of values than its maps have pairs of texels.
    #[error("the table has {given} values; maps of {0}×{0} views and {1}×{1} lights need as many as they have pairs", .sizes[0], .sizes[1])]
    TableSize {
        /// Texels along a side of the maps of views and lights.
        sizes: [usize; 2],
        /// The number of values.
        given: usize,
    },
    /// A reflectance is infinite or not a number.
    #[error("the reflectance seen from {view:?} is not finite")]
    Reflectance {
        /// The direction of the view.
        view: [f64; 3],
    },
}

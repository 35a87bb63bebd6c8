/// What can go wrong in this crate.
///
/// Messages name the item, what was given and what would have been accepted, in lower case without a full stop.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[non_exhaustive]
pub enum Error {
    /// An array of a surface or a light has the wrong length.
    #[error("{what} has {given} {unit}; {because} needs {needed}")]
    Length {
        /// The array, as in "albedo".
        what: &'static str,
        /// Its length.
        given: usize,
        /// What is counted, as in "entries".
        unit: &'static str,
        /// What fixes the length, as in "a surface of 12 vertices".
        because: String,
        /// The length that fits.
        needed: usize,
    },
    /// A triangle names a vertex that does not exist.
    #[error("triangle {triangle} uses vertex {vertex}; the surface has {vertex_count} vertices")]
    VertexIndex {
        /// Which triangle.
        triangle: usize,
        /// The vertex it names.
        vertex: u32,
        /// The number of vertices.
        vertex_count: usize,
    },
    /// Transfer has neither one nor three channels.
    #[error("transfer has {given} channels; 1 (grey) and 3 (red, green, blue) are accepted")]
    Channels {
        /// The number given.
        given: usize,
    },
    /// A number of a surface, a light or a view is NaN or infinite.
    #[error("{what} {item} is not finite")]
    NotFinite {
        /// The array, as in "transfer of vertex".
        what: &'static str,
        /// The entry.
        item: usize,
    },
    /// More bands were asked for than are stored.
    #[error("order {given} was asked for; the transfer is stored to order {stored}")]
    OrderAboveStored {
        /// The order asked for.
        given: usize,
        /// The order stored.
        stored: usize,
    },
    /// Lobes, or how they are evaluated, make no sense; the text says what is accepted.
    #[error("{0}")]
    Lobes(String),
    /// An image has no pixels, too many, or an unsupported number of samples.
    #[error("{0}")]
    View(String),
    /// No adapter can run the passes; the text is the account of what was found.
    #[error("no usable GPU adapter: {0}")]
    NoAdapter(String),
    /// Something does not fit the limits of the adapter.
    #[error("{what} needs {needed} {unit}; the adapter {adapter} allows {limit}")]
    Limit {
        /// What is too large, as in "radiance of 9000000 vertices".
        what: String,
        /// The size needed.
        needed: u64,
        /// The unit of both sizes, as in "bytes in one binding".
        unit: &'static str,
        /// The largest size allowed.
        limit: u64,
        /// The adapter's name.
        adapter: String,
    },
    /// The driver reported an error, or the device was lost.
    #[error("GPU error while {step}: {message}")]
    Device {
        /// What was being done.
        step: &'static str,
        /// The report, shortened to its first lines.
        message: String,
    },
}

//! Reading and writing of orders with [`serde`](https://docs.rs/serde); options and map sizes derive theirs.

use ::serde::de::Error as _;
use ::serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::Order;

/// Written as the number of bands.
impl Serialize for Order {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_u64(self.get() as u64)
    }
}

/// Read from the number of bands, which is checked.
impl<'de> Deserialize<'de> for Order {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let given = u64::deserialize(deserializer)?;
        let given = usize::try_from(given).unwrap_or(usize::MAX);
        Self::new(given).map_err(D::Error::custom)
    }
}

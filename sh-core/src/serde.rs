//! Reading and writing of orders and expansions with [`serde`](https://docs.rs/serde); options and map sizes derive theirs.

use core::fmt;
use core::marker::PhantomData;

use ::serde::de::{Error as _, IgnoredAny, SeqAccess, Visitor};
use ::serde::{Deserialize, Deserializer, Serialize, Serializer};

use crate::{Order, Real, Sh};

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

/// Written as the sequence of coefficients.
impl<T: Real + Serialize, const LEN: usize> Serialize for Sh<T, LEN> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        self[..].serialize(serializer)
    }
}

/// Read from a sequence of `LEN` coefficients: no more and no less.
impl<'de, T: Real + Deserialize<'de>, const LEN: usize> Deserialize<'de> for Sh<T, LEN> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(Coefficients(PhantomData))
    }
}

/// Takes the coefficients of an [`Sh`].
struct Coefficients<T, const LEN: usize>(PhantomData<T>);

impl<'de, T: Real + Deserialize<'de>, const LEN: usize> Visitor<'de> for Coefficients<T, LEN> {
    type Value = Sh<T, LEN>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{LEN} coefficients")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut sequence: A) -> Result<Self::Value, A::Error> {
        let mut sh = Sh::ZERO;
        for (i, coeff) in sh.iter_mut().enumerate() {
            *coeff = sequence.next_element()?.ok_or_else(|| A::Error::invalid_length(i, &self))?;
        }
        match sequence.next_element::<IgnoredAny>()? {
            None => Ok(sh),
            Some(_) => Err(A::Error::invalid_length(LEN + 1, &self)),
        }
    }
}

//! A share of a bake, for a machine of its own.

use std::ops::Range;
use std::str::FromStr;

use crate::Error;

/// Part `number` of `count` equal shares of the vertices, or of the texels, numbered from 1.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Part {
    number: u32,
    count: u32,
}

impl Part {
    /// Most parts of one bake.
    pub const MAX_COUNT: u32 = 65_536;

    /// # Errors
    /// If `count` is 0 or above [`Part::MAX_COUNT`], or `number` is not in 1 to `count`.
    pub fn new(number: u32, count: u32) -> Result<Self, Error> {
        if (1..=Self::MAX_COUNT).contains(&count) && (1..=count).contains(&number) {
            return Ok(Self { number, count });
        }
        Err(Error::Option(format!(
            "part {number} of {count}; 1 to {} parts are possible, numbered from 1",
            Self::MAX_COUNT
        )))
    }

    /// All of a bake.
    pub(crate) fn whole() -> Self {
        Self { number: 1, count: 1 }
    }

    /// Number of this part, from 1.
    #[must_use]
    pub fn number(self) -> u32 {
        self.number
    }

    /// Number of parts.
    #[must_use]
    pub fn count(self) -> u32 {
        self.count
    }

    /// The blocks of this part out of `block_count`. All parts together have each block once.
    pub(crate) fn blocks(self, block_count: u32) -> Range<u32> {
        let first = |number: u32| (u64::from(block_count) * u64::from(number) / u64::from(self.count)) as u32;
        first(self.number - 1)..first(self.number)
    }
}

impl FromStr for Part {
    type Err = Error;

    /// Reads `2/8`.
    fn from_str(text: &str) -> Result<Self, Error> {
        let numbers =
            text.split_once('/').and_then(|(number, count)| Some((number.parse().ok()?, count.parse().ok()?)));
        let (number, count) = numbers
            .ok_or_else(|| Error::Option(format!("part \"{text}\"; it is written as 2/8, the second of eight")))?;
        Self::new(number, count)
    }
}

impl std::fmt::Display for Part {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}/{}", self.number, self.count)
    }
}

#[cfg(test)]
mod tests {
    #![expect(clippy::unwrap_used, reason = "tests")]

    use super::*;

    #[test]
    fn parts_share_all_blocks_evenly() {
        for (block_count, count) in [(0, 3), (1, 4), (10, 3), (1000, 7), (u32::MAX, 65_536)] {
            let mut next = 0;
            for number in 1..=count {
                let blocks = Part::new(number, count).unwrap().blocks(block_count);
                assert_eq!(blocks.start, next);
                assert!(blocks.len() <= block_count as usize / count as usize + 1);
                next = blocks.end;
            }
            assert_eq!(next, block_count);
        }
    }

    #[test]
    fn parts_are_written_as_fractions() {
        assert_eq!("2/8".parse::<Part>().unwrap(), Part::new(2, 8).unwrap());
        assert_eq!(Part::new(2, 8).unwrap().to_string(), "2/8");
        for wrong in ["", "2", "0/8", "9/8", "1/0", "1/65537", "-1/8", "a/b", "1/2/3"] {
            assert!(wrong.parse::<Part>().is_err(), "{wrong}");
        }
    }
}

//! A part of a campaign, so that several machines or processes share it.

use std::fmt::{self, Display, Formatter};
use std::ops::Range;
use std::str::FromStr;

use serde::{Deserialize, Serialize};

/// One of several blocks of neighbouring fields, as equal as can be. As shards are blocks, the rows of the whole are
/// those of its shards one after the other. Fields are drawn independently, so no block is harder than another but by
/// chance.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Shard {
    /// Its number, from 1.
    pub number: u64,
    /// How many shards there are.
    pub of: u64,
}

impl Shard {
    /// All in one.
    pub const WHOLE: Self = Self { number: 1, of: 1 };

    /// Its fields, if there are `of_all`.
    ///
    /// # Panics
    /// Never: no shard ends after the last field.
    pub fn fields(self, of_all: u64) -> Range<u64> {
        let until = |shards: u64| {
            let fields = u128::from(of_all) * u128::from(shards) / u128::from(self.of);
            u64::try_from(fields).expect("not more than all")
        };
        until(self.number - 1)..until(self.number)
    }
}

impl Display for Shard {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        write!(f, "{}/{}", self.number, self.of)
    }
}

impl FromStr for Shard {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let parts = text.split_once('/').map(|(number, of)| (number.parse(), of.parse()));
        match parts {
            Some((Ok(number), Ok(of))) if (1..=of).contains(&number) => Ok(Self { number, of }),
            _ => Err(format!("found {text}, expected a shard and how many there are, such as 2/4")),
        }
    }
}

impl TryFrom<String> for Shard {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        text.parse()
    }
}

impl From<Shard> for String {
    fn from(shard: Shard) -> Self {
        shard.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_share_all_fields_evenly() {
        for (fields, of) in [(1, 1), (10, 4), (1_000, 7), (3, 3), (u64::MAX, 11)] {
            let mut next = 0;
            for number in 1..=of {
                let block = Shard { number, of }.fields(fields);
                assert_eq!(block.start, next, "{number}/{of} of {fields}");
                let size = block.end - block.start;
                assert!((fields / of..=fields / of + 1).contains(&size));
                next = block.end;
            }
            assert_eq!(next, fields);
        }
    }

    #[test]
    fn what_is_no_shard_is_refused() {
        for text in ["", "2", "0/4", "5/4", "1/0", "-1/4", "1/4/2", "a/b", "1.0/4"] {
            assert!(text.parse::<Shard>().is_err(), "{text}");
        }
        assert_eq!("2/4".parse(), Ok(Shard { number: 2, of: 4 }));
    }
}

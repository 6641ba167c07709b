//! A checksum of what is written: FNV-1a, 64 bits.
//!
//! It detects changes made by accident or by hand. It does not detect a forger who changes rows and checksum together.

use std::fmt::{self, Display, Formatter};
use std::io::{self, Write};

use serde::{Deserialize, Serialize};

/// The checksum of the bytes so far. A record has it as 16 hexadecimal digits.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub struct Checksum(u64);

impl Checksum {
    /// Takes in the next bytes.
    pub fn add(&mut self, bytes: &[u8]) {
        const PRIME: u64 = 0x0100_0000_01b3;
        let step = |sum: u64, byte: &u8| (sum ^ u64::from(*byte)).wrapping_mul(PRIME);
        self.0 = bytes.iter().fold(self.0, step);
    }
}

/// The checksum of no bytes.
impl Default for Checksum {
    fn default() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }
}

impl Write for Checksum {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.add(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

impl Display for Checksum {
    fn fmt(&self, f: &mut Formatter) -> fmt::Result {
        write!(f, "{:016x}", self.0)
    }
}

impl TryFrom<String> for Checksum {
    type Error = String;

    fn try_from(text: String) -> Result<Self, String> {
        let digits = Some(text.as_str()).filter(|it| it.len() == 16);
        let sum = digits.and_then(|it| u64::from_str_radix(it, 16).ok());
        sum.map(Self).ok_or_else(|| "expected a checksum of 16 hexadecimal digits".to_owned())
    }
}

impl From<Checksum> for String {
    fn from(checksum: Checksum) -> Self {
        checksum.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The test vectors of the algorithm's authors.
    #[test]
    fn it_is_fnv_1a() {
        let cases =
            [("", "cbf29ce484222325"), ("a", "af63dc4c8601ec8c"), ("foobar", "85944171f73967e8")];
        for (text, expected) in cases {
            let mut checksum = Checksum::default();
            text.bytes().for_each(|byte| checksum.add(&[byte]));
            assert_eq!(checksum.to_string(), expected, "{text}");
            assert_eq!(Checksum::try_from(expected.to_owned()), Ok(checksum));
        }
        for text in ["", "0", "g0000000000000000", "cbf29ce48422232", "+bf29ce484222325x"] {
            assert!(Checksum::try_from(text.to_owned()).is_err(), "{text}");
        }
    }
}

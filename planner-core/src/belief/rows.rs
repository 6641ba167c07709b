//! Numbers in rows, which are written and read as one tuple: serde knows arrays of up to 32 entries alone.

/// `K` rows of `M` numbers.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Rows<T, const K: usize, const M: usize>(pub(crate) [[T; M]; K]);

#[cfg(feature = "serde")]
mod bytes {
    use core::fmt::{Formatter, Result as Written};
    use core::marker::PhantomData;

    use serde::de::{Error, SeqAccess, Visitor};
    use serde::ser::SerializeTuple as _;
    use serde::{Deserialize, Deserializer, Serialize, Serializer};

    use super::Rows;

    impl<T: Serialize, const K: usize, const M: usize> Serialize for Rows<T, K, M> {
        fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
            let mut tuple = serializer.serialize_tuple(K * M)?;
            for number in self.0.as_flattened() {
                tuple.serialize_element(number)?;
            }
            tuple.end()
        }
    }

    struct Numbers<T, const K: usize, const M: usize>(PhantomData<T>);

    impl<'de, T, const K: usize, const M: usize> Visitor<'de> for Numbers<T, K, M>
    where
        T: Copy + Default + Deserialize<'de>,
    {
        type Value = Rows<T, K, M>;

        fn expecting(&self, f: &mut Formatter<'_>) -> Written {
            write!(f, "{} numbers", K * M)
        }

        fn visit_seq<A: SeqAccess<'de>>(self, mut seq: A) -> Result<Self::Value, A::Error> {
            let mut rows = [[T::default(); M]; K];
            for (k, number) in rows.as_flattened_mut().iter_mut().enumerate() {
                *number = seq.next_element()?.ok_or_else(|| Error::invalid_length(k, &self))?;
            }
            Ok(Rows(rows))
        }
    }

    impl<'de, T, const K: usize, const M: usize> Deserialize<'de> for Rows<T, K, M>
    where
        T: Copy + Default + Deserialize<'de>,
    {
        fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
            deserializer.deserialize_tuple(K * M, Numbers(PhantomData))
        }
    }
}

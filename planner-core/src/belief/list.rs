//! A list in an array whose unused places are copies of one item.
//!
//! A `heapless::Vec` of the hypotheses would be stored in flash as an image of itself, all of it undefined: 12 kB for
//! 529 of them. This list is filled with copies of an item instead.

use core::mem::swap;
use core::ops::{Deref, DerefMut};

/// Up to `N` items; those beyond `len` are of no meaning.
#[derive(Clone)]
pub(crate) struct List<T, const N: usize> {
    items: [T; N],
    len: u16,
}

impl<T: Copy, const N: usize> List<T, N> {
    /// An empty list, its memory filled with an item.
    pub(crate) const fn filled(item: T) -> Self {
        const { assert!(N >= 1 && N <= u16::MAX as usize, "a list holds at least one item") };
        Self { items: [item; N], len: 0 }
    }

    pub(crate) fn clear(&mut self) {
        self.len = 0;
    }

    /// Adds an item at the end, or hands it back when there is no room.
    pub(crate) fn push(&mut self, item: T) -> Result<(), T> {
        let place = self.items.get_mut(usize::from(self.len)).ok_or(item)?;
        *place = item;
        self.len += 1;
        Ok(())
    }

    /// Removes an item, which the last one replaces.
    pub(crate) fn swap_remove(&mut self, k: usize) -> Option<T> {
        let (last, rest) = self.split_last_mut()?;
        if let Some(place) = rest.get_mut(k) {
            swap(place, last);
        }
        let gone = *last;
        self.len -= 1;
        Some(gone)
    }

    /// Keeps some of the items, in their order.
    pub(crate) fn retain(&mut self, keeps: impl Fn(&T) -> bool) {
        let mut kept = 0;
        for k in 0..self.len() {
            let Some((before, [item, ..])) = self.split_at_mut_checked(k) else { break };
            if keeps(item) {
                if let Some(gap) = before.get_mut(kept) {
                    swap(gap, item);
                }
                kept += 1;
            }
        }
        self.len = kept as u16;
    }
}

impl<T, const N: usize> Deref for List<T, N> {
    type Target = [T];

    fn deref(&self) -> &[T] {
        self.items.get(..usize::from(self.len)).unwrap_or(&[])
    }
}

impl<T, const N: usize> DerefMut for List<T, N> {
    fn deref_mut(&mut self) -> &mut [T] {
        self.items.get_mut(..usize::from(self.len)).unwrap_or(&mut [])
    }
}

impl<T: core::fmt::Debug, const N: usize> core::fmt::Debug for List<T, N> {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        f.debug_list().entries(self.iter()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_holds_as_many_as_it_should_and_keeps_their_order() {
        let mut list: List<i32, 5> = List::filled(7);
        assert!(list.is_empty());
        for n in 0..5 {
            assert_eq!(list.push(n), Ok(()));
        }
        assert_eq!(list.push(5), Err(5));
        list.retain(|n| n % 2 == 0);
        assert_eq!(*list, [0, 2, 4]);
        assert_eq!(list.swap_remove(0), Some(0));
        assert_eq!(*list, [4, 2]);
        assert_eq!(list.swap_remove(1), Some(2));
        list.retain(|_| false);
        assert!(list.is_empty());
        assert_eq!(list.swap_remove(0), None);
        assert_eq!(list.push(6), Ok(()));
        list.clear();
        assert!(list.is_empty());
    }
}

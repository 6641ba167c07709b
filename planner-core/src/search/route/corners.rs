//! What a route is made of, and how well labels along it hear a boundary.

use heapless::Vec;

/// Corners of a route, at most.
pub(super) const CORNERS: usize = 16;

/// The most detections a reading: a reading in a region is one at least, however sure labels are.
const MOST: f32 = 4.0;

/// The corners of a route, metres from the middle of the area.
pub(crate) type Corners = Vec<[f32; 2], CORNERS, u8>;

/// How well labels hear a boundary.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hears {
    /// What a label carries: the logarithm of its odds.
    pub(crate) odds: f32,
    /// Metres from one label to the next.
    pub(crate) apart: f32,
}

impl Hears {
    /// The bits of a label, nearly: twice its probability less one, times its odds; at most [`MOST`].
    pub(crate) fn label(self) -> f32 {
        let wrong = libm::expf(-self.odds);
        let bits = self.odds * (1.0 - wrong) / (1.0 + wrong);
        if bits < MOST { bits } else { MOST }
    }

    /// Detections a metre.
    pub(super) fn rate(self) -> f32 {
        self.label() / self.apart
    }
}

//! Random numbers for tests, and numbers that a fuzzer gives as bytes.

/// Where the bits come from.
pub(crate) trait Source {
    fn bits(&mut self) -> u64;
}

/// splitmix64
impl Source for u64 {
    fn bits(&mut self) -> u64 {
        *self = self.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = *self;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }
}

/// Two bytes a number, so that equal numbers and ends of ranges come often; zeros when there are no more.
impl Source for &[u8] {
    fn bits(&mut self) -> u64 {
        let (two, rest) = self.split_at(self.len().min(2));
        *self = rest;
        let number = two
            .iter()
            .fold(0, |number, byte| number << 8 | u64::from(*byte));
        number * 0x0001_0001_0001_0001
    }
}

/// Numbers of a source.
pub(crate) struct Draw<S = u64>(pub(crate) S);

impl<S: Source> Draw<S> {
    pub(crate) fn bits(&mut self) -> u64 {
        self.0.bits()
    }

    pub(crate) fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Sizes of every order of magnitude alike.
    pub(crate) fn size(&mut self, low: f64, high: f64) -> f64 {
        self.between(low.ln(), high.ln()).exp()
    }

    pub(crate) fn below(&mut self, count: usize) -> usize {
        (self.bits() % count as u64) as usize
    }

    pub(crate) fn chance(&mut self, share: f64) -> bool {
        self.between(0.0, 1.0) < share
    }
}

/// Number of cases of a test: `few` by default, `many` with `CRAWLER2D_SOAK`.
#[cfg(test)]
pub(crate) fn cases(few: usize, many: usize) -> usize {
    if std::env::var_os("CRAWLER2D_SOAK").is_some() {
        many
    } else {
        few
    }
}

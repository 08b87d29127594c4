//! The vector of unknowns, and rows over it: the directions in which constraints act.
//!
//! The equations: docs/physics.md, "The problem".

/// Index of the rate of the base among the unknowns, after its velocities along x and y.
pub(crate) const TURN: usize = 2;
/// Number of unknowns of the base, and of a link.
pub(super) const BASE: usize = 3;
/// Maximum number of entries of a row, not counting those of a link.
const WIDTH: usize = 5;

/// The order of the unknowns: three velocities of the base, the rate of each body that is hinged to it, of each that spins
/// on it, the speed of each ring's slide, the impulse of each ring's drive, and three velocities of each link.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Layout {
    pub joints: usize,
    pub spins: usize,
    pub rings: usize,
    pub links: usize,
}

impl Layout {
    /// [rad/s] Rate of a body hinged to the base.
    pub(crate) fn joint(self, k: usize) -> usize {
        debug_assert!(k < self.joints);
        BASE + k
    }

    /// [rad/s] Rate of a body that spins on the base, or on what is hinged to it.
    pub(crate) fn spin(self, k: usize) -> usize {
        debug_assert!(k < self.spins);
        BASE + self.joints + k
    }

    /// Number of unknowns of the base and of what is hinged to it or spins on it.
    pub(super) fn on_base(self) -> usize {
        BASE + self.joints + self.spins
    }

    /// [m/s] Speed of a ring's slide on the base.
    pub(crate) fn slide(self, ring: usize) -> usize {
        self.on_base() + ring
    }

    /// [N s] Impulse of a ring's drive, with the opposite sign.
    pub(super) fn drive(self, ring: usize) -> usize {
        self.on_base() + self.rings + ring
    }

    /// [m/s, m/s, rad/s] The first of the three velocities of a link.
    pub(crate) fn link(self, k: usize) -> usize {
        self.on_base() + 2 * self.rings + BASE * k
    }

    /// Number of all unknowns.
    pub(super) fn count(self) -> usize {
        self.link(self.links)
    }
}

/// A link of a ring.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Link {
    ring: u16,
    /// Index of its first velocity.
    at: u32,
}

impl Link {
    /// A link of a ring, by its number among the links of all rings.
    pub(crate) fn new(layout: Layout, ring: usize, number: usize) -> Self {
        Self {
            ring: ring as u16,
            at: layout.link(number) as u32,
        }
    }

    /// The ring.
    pub(super) fn ring(self) -> usize {
        usize::from(self.ring)
    }

    /// Index of its first velocity.
    pub(super) fn at(self) -> usize {
        self.at as usize
    }
}

/// A direction in which a constraint acts: the levers with which velocities add up to the speed along it. If it acts on the
/// base, three are for that, followed by those of what is hinged to it, spins or slides on it. A solve looks at all rows
/// many times, so a row is small.
#[derive(Clone, Copy, Debug, Default)]
pub(crate) struct Row {
    levers: [f64; WIDTH],
    /// The levers on a link, ...
    pub(super) on_link: [f64; BASE],
    /// [m/s] Constant part of the speed.
    pub offset: f64,
    /// ... and that link, if it acts on one.
    pub(super) link: Option<Link>,
    at: [u16; WIDTH],
    count: u16,
}

impl Row {
    /// A row on the base, by its levers for x, y and turn.
    pub(crate) fn on_base([x, y, turn]: [f64; BASE]) -> Self {
        Self {
            levers: [x, y, turn, 0.0, 0.0],
            at: [0, 1, TURN as u16, 0, 0],
            count: BASE as u16,
            ..Self::default()
        }
    }

    /// A row on a link alone.
    pub(crate) fn on_link(link: Link, levers: [f64; BASE]) -> Self {
        Self {
            link: Some(link),
            on_link: levers,
            ..Self::default()
        }
    }

    /// The same with the reaction on the base, which has these levers for x, y and turn.
    pub(crate) fn against_base(self, levers: [f64; BASE]) -> Self {
        Self {
            link: self.link,
            on_link: self.on_link,
            ..Self::on_base(levers.map(|lever| -lever))
        }
    }

    /// The rate of a body that spins on the base or is hinged to it, relative to the base, times a lever [m].
    pub(crate) fn over_base(at: usize, lever: f64) -> Self {
        Self::on_base([0.0, 0.0, -lever]).and(at, lever)
    }

    /// The same with the lever of a further unknown.
    pub(crate) fn and(mut self, at: usize, lever: f64) -> Self {
        self.push(at, lever);
        self
    }

    fn push(&mut self, at: usize, lever: f64) {
        let own = usize::from(self.count);
        (self.at[own], self.levers[own]) = (at as u16, lever);
        self.count += 1;
    }

    /// Its unknowns except those of a link, with their levers.
    pub(super) fn entries(&self) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        self.entries_from(0)
    }

    /// Whether it acts on the base.
    pub(super) fn is_on_base(&self) -> bool {
        self.count > 0
    }

    /// Its levers on the base, ...
    pub(super) fn of_base(&self) -> [f64; BASE] {
        [self.levers[0], self.levers[1], self.levers[2]]
    }

    /// ... and its other entries, except those of a link.
    pub(super) fn beside_base(&self) -> impl Iterator<Item = (usize, f64)> + '_ {
        self.entries_from(BASE)
    }

    /// Whether it acts on two bodies other than the base.
    pub(super) fn is_on_two_beside_base(&self) -> bool {
        usize::from(self.count) > BASE + 1
    }

    fn entries_from(&self, first: usize) -> impl Iterator<Item = (usize, f64)> + Clone + '_ {
        let count = usize::from(self.count).min(WIDTH);
        (first..count).map(|i| (usize::from(self.at[i]), self.levers[i]))
    }

    /// [m/s] The speed along it, without its offset.
    pub(crate) fn along(&self, unknowns: &[f64]) -> f64 {
        let mut speed = 0.0;
        if self.is_on_base() {
            let [x, y, turn] = self.of_base();
            speed += x * unknowns[0] + y * unknowns[1] + turn * unknowns[TURN];
        }
        for (at, lever) in self.beside_base() {
            speed += lever * unknowns[at];
        }
        if let Some(link) = self.link {
            let own = &unknowns[link.at()..][..BASE];
            speed += self.on_link[0] * own[0] + self.on_link[1] * own[1] + self.on_link[2] * own[2];
        }
        speed
    }

    /// [m/s] The speed along it.
    pub(super) fn speed(&self, unknowns: &[f64]) -> f64 {
        self.along(unknowns) + self.offset
    }

    /// The sum of this row and a multiple of another one on the same bodies; the offset stays.
    pub(super) fn plus(&self, other: &Self, share: f64) -> Self {
        debug_assert_eq!((self.at, self.link), (other.at, other.link));
        let mut sum = *self;
        for (lever, more) in sum.levers.iter_mut().zip(other.levers) {
            *lever += more * share;
        }
        for (lever, more) in sum.on_link.iter_mut().zip(other.on_link) {
            *lever += more * share;
        }
        sum
    }

    /// The same if some bodies turn with the base: `held` has their rates relative to it [rad/s].
    pub(super) fn tied(&self, held: &[Option<f64>]) -> Self {
        let mut tied = *self;
        tied.count = self.count.min(BASE as u16);
        for (at, lever) in self.beside_base() {
            match held[at] {
                None => tied.push(at, lever),
                Some(rate) => {
                    tied.levers[TURN] += lever;
                    tied.offset += lever * rate;
                }
            }
        }
        tied
    }
}

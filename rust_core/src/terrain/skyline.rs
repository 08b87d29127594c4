//! Ground of level tops and vertical faces.

/// Heights above level ground at 0: each [x, height] applies from its x [m] on; the last is level ground again.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Skyline {
    rises: Vec<[f64; 2]>,
}

impl Skyline {
    /// Blocks side by side from `start` [m], each `width` [m] wide.
    pub(super) fn of_blocks(start: f64, width: f64, heights: &[f64]) -> Self {
        let mut rises: Vec<[f64; 2]> = heights
            .iter()
            .enumerate()
            .map(|(i, height)| [start + i as f64 * width, *height])
            .collect();
        rises.push([start + heights.len() as f64 * width, 0.0]);
        Self { rises }
    }

    /// The higher of two skylines at every x.
    pub(super) fn higher(&self, other: &Self) -> Self {
        let mut places: Vec<f64> = self
            .rises
            .iter()
            .chain(&other.rises)
            .map(|r| r[0])
            .collect();
        places.sort_unstable_by(f64::total_cmp);
        places.dedup();
        let higher = |x: f64| [x, self.height(x).max(other.height(x))];
        Self {
            rises: places.into_iter().map(higher).collect(),
        }
    }

    /// [m] Height just behind an x.
    fn height(&self, x: f64) -> f64 {
        let next = self.rises.partition_point(|rise| rise[0] <= x);
        if next > 0 {
            self.rises[next - 1][1]
        } else {
            0.0
        }
    }

    /// [m] The x at which it ends.
    pub(super) fn end(&self) -> f64 {
        self.rises[self.rises.len() - 1][0]
    }

    /// [m] Its corners, from the first x of the ground to the last.
    pub(super) fn points(&self, from: f64, to: f64) -> Vec<[f64; 2]> {
        let mut points = vec![[from, 0.0]];
        let mut below = 0.0;
        for [x, height] in &self.rises {
            points.extend([[*x, below], [*x, *height]]);
            below = *height;
        }
        points.push([to, 0.0]);
        points
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_higher_of_two_is_as_high_as_either_everywhere() {
        let stairs = Skyline::of_blocks(0.0, 1.0, &[1.0, 3.0]);
        let block = Skyline::of_blocks(0.5, 1.0, &[2.0]);
        let both = stairs.higher(&block);
        for i in -10..40 {
            let x = 0.1 * f64::from(i);
            let higher = stairs.height(x).max(block.height(x));
            assert!((both.height(x) - higher).abs() < 1e-12, "at {x}");
        }
        assert!((both.end() - 2.0).abs() < 1e-12);
    }

    #[test]
    fn its_corners_go_up_and_down_its_faces() {
        let block = Skyline::of_blocks(0.0, 0.5, &[0.1]);
        let corners = [[0.0, 0.0], [0.0, 0.1], [0.5, 0.1], [0.5, 0.0]];
        let points = block.points(-1.0, 2.0);
        assert_eq!(points[1..5], corners);
        assert_eq!([points[0], points[5]], [[-1.0, 0.0], [2.0, 0.0]]);
    }
}

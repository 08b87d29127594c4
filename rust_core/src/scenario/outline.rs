//! The outline of a track in side view: the discs that it runs round.

use serde::ser::{Serialize, SerializeStruct, Serializer};
use serde_json::{Value, json};

use super::ScenarioError;
use super::fields::{COORDINATE, Checked, Fields, SIZE, SIZE_OR_ZERO, SMALLEST};
use super::objects::FromJson;

/// Fields of the short form of two discs in JSON.
const SHORT: [&str; 3] = ["axle_distance", "front_radius", "rear_radius"];
/// Largest number of discs.
const MOST: usize = 64;

/// The closed outline of the track: the taut belt round discs, at the grouser tips.
///
/// The rearmost and the foremost disc are those that reach farthest back and forwards. Their axles are the end axles;
/// the rear one is the sprocket's.
#[derive(Clone, Debug, PartialEq)]
pub struct TrackOutline {
    /// [m] Centre (x, y) in the chassis frame and radius, measured to the grouser tips, of each disc, in any order.
    pub discs: Vec<[f64; 3]>,
    /// [m] Height of the grousers above the belt.
    pub grouser_height: f64,
    /// [m] Spacing of the grousers along the belt.
    pub grouser_pitch: f64,
    /// [m] Thickness of a grouser along the belt.
    pub grouser_thickness: f64,
}

impl TrackOutline {
    /// [m] Two discs at an axle distance, the rear one first; the chassis frame is midway between them.
    pub fn two_discs(axle_distance: f64, [rear, front]: [f64; 2]) -> Vec<[f64; 3]> {
        let half = 0.5 * axle_distance;
        vec![[-half, 0.0, rear], [half, 0.0, front]]
    }

    /// Indices of the rearmost and the foremost disc; of two that reach equally far the higher one.
    fn ends(&self) -> [usize; 2] {
        let reach = |i: usize, sign: f64| {
            let [x, y, radius] = self.discs[i];
            (sign * x + radius, y)
        };
        [-1.0, 1.0].map(|sign| {
            (1..self.discs.len()).fold(0, |best, i| {
                if reach(i, sign) > reach(best, sign) {
                    i
                } else {
                    best
                }
            })
        })
    }

    /// [m] The rearmost and the foremost disc.
    pub fn end_discs(&self) -> [[f64; 3]; 2] {
        self.ends().map(|end| self.discs[end])
    }

    /// [m] The discs between these two, from the rear to the front.
    pub(crate) fn discs_between(&self) -> Vec<[f64; 3]> {
        let ends = self.ends();
        let between = (0..self.discs.len()).filter(|i| !ends.contains(i));
        let mut between: Vec<[f64; 3]> = between.map(|i| self.discs[i]).collect();
        // No two have the same centre, so their order does not depend on the one in which they are given.
        let from_the_rear =
            |a: &[f64; 3], b: &[f64; 3]| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1]));
        between.sort_by(from_the_rear);
        between
    }

    /// [m] Distance of the end axles along the chassis.
    pub fn axle_distance(&self) -> f64 {
        let [rear, front] = self.end_discs();
        front[0] - rear[0]
    }

    /// [m] Radius of the rearmost disc.
    pub fn rear_radius(&self) -> f64 {
        self.end_discs()[0][2]
    }

    /// [m] Radius of the foremost disc.
    pub fn front_radius(&self) -> f64 {
        self.end_discs()[1][2]
    }

    /// [m] Radius of the smallest disc.
    pub fn smallest_radius(&self) -> f64 {
        self.discs
            .iter()
            .map(|disc| disc[2])
            .fold(f64::INFINITY, f64::min)
    }

    /// [m] Radius of the largest disc.
    pub fn largest_radius(&self) -> f64 {
        self.discs.iter().map(|disc| disc[2]).fold(0.0, f64::max)
    }

    /// [m] Radius of the belt at the rear, where the sprocket's torque acts.
    pub fn belt_radius(&self) -> f64 {
        self.rear_radius() - self.grouser_height
    }

    /// Number of grousers that comes closest to the pitch on a belt of this length [m], at least `least`.
    ///
    /// # Errors
    /// The number would exceed `most`; the bounds are the same as for a given number.
    pub(crate) fn pitches_along(&self, length: f64, [least, most]: [u32; 2]) -> Checked<u32> {
        let count = (length / self.grouser_pitch).round();
        if count <= f64::from(most) {
            return Ok((count as u32).max(least));
        }
        let rule =
            format!("must be large enough for at most {most} grousers on a belt of {length:.4} m");
        let path = "robot.outline.grouser_pitch";
        Err(ScenarioError::new(path, self.grouser_pitch, rule))
    }

    /// Whether [`Self::two_discs`] describes all of its discs; then JSON has the short form.
    fn is_short(&self) -> bool {
        match self.discs[..] {
            [[rear, rear_y, _], [front, front_y, _]] => {
                rear < 0.0 && rear + front == 0.0 && rear_y == 0.0 && front_y == 0.0
            }
            _ => false,
        }
    }

    /// JSON with all discs, never in the short form.
    pub(crate) fn with_discs(&self) -> Value {
        json!({
            "discs": self.discs,
            "grouser_height": self.grouser_height,
            "grouser_pitch": self.grouser_pitch,
            "grouser_thickness": self.grouser_thickness,
        })
    }
}

impl Serialize for TrackOutline {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        let mut fields = serializer.serialize_struct("TrackOutline", 6)?;
        if self.is_short() {
            fields.serialize_field("axle_distance", &self.axle_distance())?;
            fields.serialize_field("front_radius", &self.discs[1][2])?;
            fields.serialize_field("rear_radius", &self.discs[0][2])?;
        } else {
            fields.serialize_field("discs", &self.discs)?;
        }
        fields.serialize_field("grouser_height", &self.grouser_height)?;
        fields.serialize_field("grouser_pitch", &self.grouser_pitch)?;
        fields.serialize_field("grouser_thickness", &self.grouser_thickness)?;
        fields.end()
    }
}

impl FromJson for TrackOutline {
    fn read(f: &mut Fields) -> Checked<Self> {
        let short = SHORT.into_iter().find(|name| f.has(name));
        let discs = match short {
            Some(name) if f.has("discs") => {
                let rule = "must not be given together with discs, which determine it";
                let value = f.value(name)?;
                return Err(f.error(name, value, rule));
            }
            Some(_) => read_ends(f)?,
            None => read_discs(f)?,
        };
        let outline = Self {
            discs,
            grouser_height: f.number("grouser_height", SIZE_OR_ZERO)?,
            grouser_pitch: f.number("grouser_pitch", SIZE)?,
            grouser_thickness: f.number("grouser_thickness", SIZE_OR_ZERO)?,
        };
        let smallest = outline.smallest_radius();
        if outline.grouser_height >= smallest {
            let rule =
                format!("must be less than the smaller radius, {smallest} m, to leave a belt");
            return Err(f.error("grouser_height", outline.grouser_height, rule));
        }
        if outline.grouser_thickness >= outline.grouser_pitch {
            let rule = format!(
                "must be less than the pitch, {} m, or grousers would overlap",
                outline.grouser_pitch
            );
            return Err(f.error("grouser_thickness", outline.grouser_thickness, rule));
        }
        match short {
            Some(_) => outline.check_enclosure(f)?,
            None => outline.check_ends(f)?,
        }
        Ok(outline)
    }
}

impl TrackOutline {
    /// Checks that neither of two ends encloses the other.
    fn check_enclosure(&self, f: &Fields) -> Checked<()> {
        let [rear, front] = [self.discs[0], self.discs[1]];
        if (front[2] - rear[2]).abs() >= front[0] - rear[0] {
            let rule = "must differ from rear_radius by less than the axle distance: otherwise one end would enclose the other";
            return Err(f.error("front_radius", front[2], rule));
        }
        Ok(())
    }

    /// Checks that it has two ends, with the origin of the chassis frame between them.
    fn check_ends(&self, f: &Fields) -> Checked<()> {
        let [rear, front] = self.end_discs().map(|disc| disc[0]);
        if self.axle_distance() < SMALLEST {
            let rule = format!(
                "must have its rearmost and foremost discs at least {SMALLEST} m apart along x"
            );
            let value = format!("discs at x = {rear} and {front} m");
            return Err(f.error("discs", value, rule));
        }
        if rear >= 0.0 || front <= 0.0 {
            let rule = "must have the origin of the chassis frame between its end axles: the rear one at x < 0, the front one at x > 0";
            let value = format!("end axles at x = {rear} and {front} m");
            return Err(f.error("discs", value, rule));
        }
        Ok(())
    }
}

/// Reads the short form of two discs.
fn read_ends(f: &mut Fields) -> Checked<Vec<[f64; 3]>> {
    let axle_distance = f.number("axle_distance", SIZE)?;
    let front = f.number("front_radius", SIZE)?;
    let rear = f.number("rear_radius", SIZE)?;
    Ok(TrackOutline::two_discs(axle_distance, [rear, front]))
}

/// Reads discs of which none lies in another.
fn read_discs(f: &mut Fields) -> Checked<Vec<[f64; 3]>> {
    let columns = [("x", COORDINATE), ("y", COORDINATE), ("radius", SIZE)];
    let discs = f.rows("discs", columns, MOST)?;
    if discs.len() < 2 {
        let value = format!("{} discs", discs.len());
        return Err(f.error("discs", value, "must have at least 2 discs"));
    }
    for (i, inner) in discs.iter().enumerate() {
        for (k, outer) in discs.iter().enumerate() {
            let apart = libm::hypot(inner[0] - outer[0], inner[1] - outer[1]);
            if i != k && apart <= outer[2] - inner[2] {
                let rule =
                    format!("must not lie in another disc, discs[{k}]: no track would touch it");
                return Err(f.error(&format!("discs[{i}]"), written(inner), rule));
            }
        }
    }
    Ok(discs)
}

/// A disc in JSON.
fn written([x, y, radius]: &[f64; 3]) -> String {
    format!("[{x}, {y}, {radius}]")
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outline(discs: &[[f64; 3]]) -> TrackOutline {
        TrackOutline {
            discs: discs.to_vec(),
            grouser_height: 0.01,
            grouser_pitch: 0.05,
            grouser_thickness: 0.005,
        }
    }

    /// An axle distance says where two discs are if the frame is midway between them.
    #[test]
    fn texts_have_an_axle_distance_if_that_says_where_both_discs_are() {
        let (rear, front) = ([-0.2, 0.0, 0.1], [0.2, 0.0, 0.08]);
        for (discs, is_short) in [
            (vec![rear, front], true),
            (vec![front, rear], false),
            (vec![rear, [0.3, 0.0, 0.08]], false),
            (vec![rear, [0.2, 0.01, 0.08]], false),
            (vec![[-0.2, 0.01, 0.1], front], false),
            (vec![rear, [0.0, 0.0, 0.1], front], false),
        ] {
            let text = serde_json::to_value(outline(&discs)).expect("it can be written");
            assert_eq!(text.get("axle_distance").is_some(), is_short, "{text}");
            assert_eq!(text.get("discs").is_some(), !is_short, "{text}");
        }
    }

    /// At either end, the axle of a small disc is farther out than that of a large one which reaches farther.
    #[test]
    fn the_end_discs_are_those_that_reach_farthest() {
        let (rear, front) = ([-0.2, 0.0, 0.1], [0.2, 0.0, 0.08]);
        let small = [[-0.22, 0.2, 0.02], [0.21, 0.2, 0.03]];
        let outline = outline(&[small[1], rear, small[0], front]);
        assert_eq!(outline.end_discs(), [rear, front]);
        assert_eq!(outline.discs_between(), small);
        let sizes = [
            (outline.axle_distance(), 0.4),
            (outline.rear_radius(), 0.1),
            (outline.front_radius(), 0.08),
            (outline.belt_radius(), 0.09),
            (outline.smallest_radius(), 0.02),
            (outline.largest_radius(), 0.1),
        ];
        for (found, expected) in sizes {
            // Rounding of numbers below 1.
            assert!((found - expected).abs() < 1e-15, "{found} m, {expected} m");
        }
    }

    #[test]
    fn of_two_discs_that_reach_equally_far_the_higher_one_is_an_end() {
        let discs = [
            [-0.25, 0.0, 0.0625],
            [-0.25, 0.25, 0.0625],
            [0.25, 0.25, 0.0625],
            [0.25, 0.0, 0.0625],
        ];
        assert_eq!(outline(&discs).end_discs(), [discs[1], discs[2]]);
    }
}

//! The higher of two lanes, which the belly between them meets.

use super::profile::Profile;
use crate::geometry::Vector;
use crate::scenario::ScenarioError;

/// The upper envelope of two profiles over their common stretch of x. Arcs become polylines as fine as theirs;
/// friction is the larger of the two.
///
/// # Errors
/// They have no common stretch of x.
pub(super) fn envelope(path: &str, a: &Profile, b: &Profile) -> Result<Profile, ScenarioError> {
    let ((a_low, a_high), (b_low, b_high)) = (a.extent(), b.extent());
    let (low, high) = (a_low.max(b_low), a_high.min(b_high));
    if low >= high {
        let value = format!("left {a_low} to {a_high} m, right {b_low} to {b_high} m");
        return Err(ScenarioError::new(
            path,
            value,
            "must have lanes with a common stretch of x",
        ));
    }
    let corners = a.points.iter().chain(&b.points).map(|p| p.x);
    let mut places: Vec<f64> = corners.filter(|x| (low..=high).contains(x)).collect();
    places.extend([low, high]);
    places.sort_unstable_by(f64::total_cmp);
    places.dedup();

    let mut points: Vec<[f64; 2]> = Vec::new();
    for (i, x) in places.iter().enumerate() {
        let sides = [a, b].map(|profile| heights_at(profile, *x));
        let [before, after] = [0, 1].map(|k| sides[0][k].max(sides[1][k]));
        points.extend([[*x, before], [*x, after]]);
        if let Some(next) = places.get(i + 1) {
            let ahead = [a, b].map(|profile| heights_at(profile, *next)[0]);
            let (here, there) = (sides[0][1] - sides[1][1], ahead[0] - ahead[1]);
            if here * there < 0.0 {
                let share = here / (here - there);
                let y = sides[0][1] + share * (ahead[0] - sides[0][1]);
                points.push([x + share * (next - x), y]);
            }
        }
    }
    // Before the first and behind the last there is no ground.
    points.remove(0);
    points.pop();
    Profile::new(path, &points, 0.0, a.friction.max(b.friction), true)
}

/// [m] Heights of a profile just before and just behind an x.
fn heights_at(profile: &Profile, x: f64) -> [f64; 2] {
    let points = &profile.points;
    let from = points.partition_point(|p| p.x < x);
    let to = points.partition_point(|p| p.x <= x);
    if from < to {
        return [points[from].y, points[to - 1].y];
    }
    let on = |a: Vector, b: Vector| a.y + (x - a.x) * (b.y - a.y) / (b.x - a.x);
    [on(points[from - 1], points[from]); 2]
}

#[cfg(test)]
mod tests {
    use super::*;

    fn profile(points: &[[f64; 2]]) -> Profile {
        Profile::new("terrain", points, 0.0, 0.5, true).expect("a profile")
    }

    fn points(profile: &Profile) -> Vec<[f64; 2]> {
        profile.points.iter().map(|p| [p.x, p.y]).collect()
    }

    #[test]
    fn the_higher_of_two_steps_is_a_stair() {
        let early = profile(&[[-1.0, 0.0], [0.0, 0.0], [0.0, 0.1], [2.0, 0.1]]);
        let late = profile(&[[-2.0, 0.0], [1.0, 0.0], [1.0, 0.3], [3.0, 0.3]]);
        let stair = envelope("terrain", &early, &late).expect("they overlap");
        let expected = [
            [-1.0, 0.0],
            [0.0, 0.0],
            [0.0, 0.1],
            [1.0, 0.1],
            [1.0, 0.3],
            [2.0, 0.3],
        ];
        assert_eq!(points(&stair), expected);
    }

    #[test]
    fn slopes_that_cross_make_a_valley_between_them() {
        let down = profile(&[[0.0, 1.0], [2.0, 0.0]]);
        let up = profile(&[[0.0, 0.0], [2.0, 1.0]]);
        let valley = envelope("terrain", &down, &up).expect("they overlap");
        assert_eq!(points(&valley), [[0.0, 1.0], [1.0, 0.5], [2.0, 1.0]]);
    }

    #[test]
    fn lanes_apart_are_refused() {
        let here = profile(&[[0.0, 0.0], [1.0, 0.0]]);
        let there = profile(&[[2.0, 0.0], [3.0, 0.0]]);
        let error = envelope("terrain", &here, &there).expect_err("nothing in common");
        assert!(error.to_string().contains("common stretch"));
    }
}

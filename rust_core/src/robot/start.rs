//! Position of the robot at time 0.

use super::{Model, Part, Shape};
use crate::geometry::{Disc, Envelope, Pose, Vector, lower_tangent, outline_discs, turned_by};
use crate::scenario::{Scenario, ScenarioError};
use crate::terrain::{Ground, Profile};

/// Position of the chassis frame at time 0: on the ground, `start.approach` before the first edge.
pub(crate) fn start_position(
    scenario: &Scenario,
    model: &Model,
    ground: &Ground,
) -> Result<Vector, ScenarioError> {
    let turned = turned_by(scenario.start.angle);
    let turned_disc = |d: Disc| Disc {
        center: turned(d.center),
        ..d
    };
    let running = model.running_at_start(scenario.start.track_phase);
    // The shapes above each lane: discs, and segments between points.
    let mut touching = vec![Touching::default(); ground.lanes.len()];
    for part in model.parts.iter().filter(|part| !part.kind.is_in_chain()) {
        let mount = running.mounted(part.mount, Pose::IDENTITY);
        let placed = |p: Vector| turned(mount.transform_point(p));
        touching[part.lane].add(part, part.run(&running), placed);
        touching[part.lane].add_runs(part, placed);
    }
    // The start depends on the outline, even if the model does not touch there.
    let outline = outline_discs(&scenario.robot.outline).into_iter();
    let tips = model.parts.iter().flat_map(|part| {
        let mount = running.mounted(part.mount, Pose::IDENTITY);
        part.discs().map(move |(tip, _)| Disc {
            center: mount.transform_point(tip.center),
            ..tip
        })
    });
    let of_discs = outline
        .chain(tips)
        .map(turned_disc)
        .map(|d| (d.center.x - d.radius, d.center.x + d.radius));
    let of_segments = touching
        .iter()
        .flat_map(|lane| lane.segments.iter().flatten())
        .map(|p| (p.x, p.x));
    let (rear, front) = of_discs
        .chain(of_segments)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), (a, b)| {
            (low.min(a), high.max(b))
        });
    let x = ground.first_edge - scenario.start.approach - front;
    let (low, high) = ground.extent();
    if x + rear < low || x + front > high {
        let rule = format!(
            "must reach under the whole robot at its start, from x = {:.4} m to {:.4} m",
            x + rear,
            x + front
        );
        return Err(ScenarioError::new(
            "terrain",
            format!("x from {low} to {high} m"),
            rule,
        ));
    }
    let heights = touching
        .iter()
        .zip(&ground.lanes)
        .map(|(touching, profile)| touching.lowest_height(profile, x));
    Ok(Vector::new(x, heights.fold(f64::NEG_INFINITY, f64::max)))
}

/// The shapes of a robot above one lane, in the chassis frame turned by its angle.
#[derive(Clone, Default)]
struct Touching {
    discs: Vec<Disc>,
    segments: Vec<[Vector; 2]>,
}

impl Touching {
    /// Adds a part whose surface has run by `run` [m]; `placed` transforms points of its mount's frame to this one.
    fn add(&mut self, part: &Part, run: f64, placed: impl Fn(Vector) -> Vector) {
        let Self { discs, segments } = self;
        discs.extend(part.discs().map(|(_, root)| Disc {
            center: placed(root.center),
            ..root
        }));
        match &part.shape {
            Shape::Disc { .. } => {}
            Shape::Hull { discs: round, .. } => {
                let placed = &discs[discs.len() - round.len()..];
                segments.extend(
                    placed
                        .windows(2)
                        .map(|pair| lower_tangent(pair[0], pair[1])),
                );
                // An arm that is folded back is upside down.
                if let [root, tip] = placed {
                    segments.push(lower_tangent(*tip, *root));
                }
            }
            Shape::Gear { center, gear } => {
                let start = -run / gear.radius;
                for direction in gear.directions() {
                    let corners = gear.corners(direction + start);
                    segments.extend(closed(&corners.map(|c| placed(*center + c))));
                }
            }
            Shape::Grouser(grouser) => {
                let place = grouser.place(run);
                let corners = grouser.corners().map(|c| placed(place.transform_point(c)));
                segments.extend(closed(&corners));
            }
            Shape::Polygon { corners } => {
                let corners: Vec<Vector> = corners.iter().map(|c| placed(*c)).collect();
                segments.extend(closed(&corners));
            }
        }
    }

    /// Adds the straight runs of a hull of more than two discs, which need not join neighbours in the list.
    fn add_runs(&mut self, part: &Part, placed: impl Fn(Vector) -> Vector) {
        match &part.shape {
            Shape::Hull { discs, .. } if discs.len() > 2 => {
                let hull = Envelope::new(discs);
                let runs = hull.runs().map(|run| run.map(&placed));
                self.segments.extend(runs);
            }
            _ => {}
        }
    }

    /// [m] Height of the chassis frame, placed at `x`, at which the robot just touches the ground.
    fn lowest_height(&self, profile: &Profile, x: f64) -> f64 {
        let shift = Vector::new(x, 0.0);
        let of_discs = self
            .discs
            .iter()
            .map(|d| profile.height_under_disc(x + d.center.x, d.radius) - d.center.y);
        let of_segments = self.segments.iter().map(|[a, b]| {
            let (a, b) = if a.x <= b.x { (*a, *b) } else { (*b, *a) };
            profile.rise_over_segment(a + shift, b + shift)
        });
        of_discs
            .chain(of_segments)
            .fold(f64::NEG_INFINITY, f64::max)
    }
}

/// The sides of a polygon.
fn closed(corners: &[Vector]) -> impl Iterator<Item = [Vector; 2]> {
    let n = corners.len();
    (0..n).map(move |i| [corners[i], corners[(i + 1) % n]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::robot::BodyKind;
    use crate::scenario::{Surface, Terrain, shared};

    /// Its discs are listed so that those at the ends of the lower run are no neighbours. Over a spike in the middle it stands as
    /// high as that, less how deep the run lies.
    #[test]
    fn a_hull_starts_on_a_spike_under_a_run_between_any_two_of_its_discs() {
        let disc = |x: f64, y: f64| Disc {
            center: Vector::new(x, y),
            radius: 0.05,
        };
        let hull = Shape::Hull {
            discs: vec![disc(-0.3, 0.0), disc(0.0, 0.3), disc(0.3, 0.0)],
            grouser_height: 0.0,
        };
        let part = Part::new(BodyKind::Guide, hull, None);
        let points = [
            [-1.0, 0.0],
            [-0.02, 0.0],
            [0.0, 0.2],
            [0.02, 0.0],
            [1.0, 0.0],
        ];
        let spike = Profile::new("terrain", &points, Surface::sharp(0.5), true).expect("a spike");
        let mut touching = Touching::default();
        touching.add(&part, 0.0, |p| p);
        touching.add_runs(&part, |p| p);
        let height = touching.lowest_height(&spike, 0.0);
        assert!((height - 0.25).abs() < 1e-12, "{height} m");
    }

    /// The Engineer on a belt, turned, on a ground from one x to another [m] with an edge at 0.
    fn start(angle: f64, [low, high]: [f64; 2]) -> (Scenario, Result<Vector, ScenarioError>) {
        let mut scenario = shared("engineer_belt_step");
        scenario.start.angle = angle;
        scenario.start.approach = 0.1;
        scenario.terrain = Terrain::Points {
            points: vec![[low, 0.0], [0.0, 0.0], [high, 0.01]],
            goal: 0.0,
            surface: Surface::sharp(0.5),
            segment_friction: None,
        };
        let ground = Ground::new(&scenario.terrain, scenario.robot.gauge).expect("a ground");
        let model = Model::on(&scenario.robot, &ground).expect("it can be built");
        let found = start_position(&scenario, &model, &ground);
        (scenario, found)
    }

    /// [m] How far a robot turned by an angle reaches behind its frame and before it.
    fn ends(scenario: &Scenario, angle: f64) -> [f64; 2] {
        let discs = outline_discs(&scenario.robot.outline);
        let reach = |sign: f64| {
            let of = |disc: &Disc| sign * turned_by(angle)(disc.center).x + disc.radius;
            discs.iter().map(of).fold(f64::NEG_INFINITY, f64::max)
        };
        [reach(-1.0), reach(1.0)]
    }

    #[test]
    fn a_robot_starts_with_its_front_so_far_before_the_first_edge() {
        for angle in [-0.4, 0.0, 0.7] {
            let (scenario, found) = start(angle, [-3.0, 3.0]);
            let [_, front] = ends(&scenario, angle);
            let x = found.expect("there is room").x;
            assert!((x + front + 0.1).abs() < 1e-12, "{angle} rad: {x} m");
        }
    }

    #[test]
    fn a_ground_that_ends_under_the_robot_is_refused_with_what_it_must_reach_under() {
        let (scenario, _) = start(0.0, [-3.0, 3.0]);
        let [rear, front] = ends(&scenario, 0.0);
        let length = rear + front;
        assert!(start(0.0, [-0.1 - length - 1e-9, 3.0]).1.is_ok());
        let (_, found) = start(0.0, [-0.1 - length + 1e-4, 3.0]);
        let error = found.expect_err("its rear is beyond the end");
        let ([from, to], low) = ([-0.1 - length, -0.1], -0.1 - length + 1e-4);
        let rule = format!("from x = {from:.4} m to {to:.4} m");
        assert!(error.rule.ends_with(&rule), "{}", error.rule);
        assert_eq!(error.value, format!("x from {low} to 3 m"));
    }
}

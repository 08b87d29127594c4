//! Certificates: where a layout cannot jam, no jam is found, and where it is only as a belt, the belt can.

use crawler2d_core::{
    Cancel, Certificate, ClosedSurface, ClosedTrack, ExcludedCell, Exclusion, Region, RegionStatus,
    Scenario, SearchEffort, Terrain, Track, ValidScenario, certify, find_jams,
};

use crate::common::*;

/// Least and greatest height \[m\] and friction.
type Ranges = [[f64; 2]; 2];

const EFFORT: SearchEffort = SearchEffort {
    depth: 1e-3,
    smallest: 0.25,
    cells: 50_000,
    keeps_cells: true,
};

fn at(scenario: &Scenario, height: f64, friction: f64) -> Scenario {
    let mut changed = scenario.clone();
    match &mut changed.terrain {
        Terrain::Step {
            height: h, surface, ..
        }
        | Terrain::Barrier {
            height: h, surface, ..
        } => {
            *h = height;
            surface.friction.coefficient = friction;
        }
        other => panic!("{other:?}"),
    }
    changed
}

/// The scenarios that a certificate is made from.
fn family(scenario: &Scenario, ranges: Ranges) -> Vec<ValidScenario> {
    let [[low, high], [smooth, rough]] = ranges;
    let middle = [0.5 * (low + high), 0.5 * (smooth + rough)];
    let all = [
        [low, smooth],
        [high, smooth],
        [low, rough],
        [high, rough],
        middle,
    ];
    let of = |[height, friction]: [f64; 2]| checked(&at(scenario, height, friction));
    all.into_iter().map(of).collect()
}

fn with_belt(scenario: &Scenario) -> Scenario {
    let mut changed = scenario.clone();
    changed.robot.track = Track::Closed(ClosedTrack {
        of: Box::new(scenario.robot.track.clone()),
        surface: ClosedSurface::Smooth,
    });
    changed
}

fn certificate(scenario: &Scenario, ranges: Ranges) -> Certificate {
    let names = ["terrain.height", "terrain.friction"].map(str::to_owned);
    let (wheels, belts) = (
        family(scenario, ranges),
        family(&with_belt(scenario), ranges),
    );
    certify(&wheels, &belts, &names, EFFORT, &Cancel::default()).expect("it can be searched")
}

/// A robot with a belly or without, on wheels in a row, all round or anywhere, and a range of heights and frictions.
fn drawn(draw: &mut Draw) -> (Scenario, Ranges) {
    let count = draw.between(3.0, 8.99) as u32;
    let mut scenario = engineer_on(drawn_wheels(draw, count));
    scenario.robot.center_of_mass = [draw.between(-0.06, 0.06), draw.between(0.0, 0.08)];
    scenario.robot.drivetrain.max_torque = 500.0;
    if draw.unit() < 0.5 {
        scenario.robot.belly = None;
    }
    scenario.terrain = step(0.1, 0.9);
    if draw.unit() < 0.5 {
        let Terrain::Step { surface, .. } = scenario.terrain else {
            unreachable!()
        };
        scenario.terrain = Terrain::Barrier {
            height: 0.1,
            thickness: draw.between(0.03, 0.3),
            surface,
        };
    }
    let (height, friction) = (draw.between(0.02, 0.13), draw.between(0.4, 1.0));
    (
        scenario,
        [[height, height + 0.02], [friction, friction + 0.2]],
    )
}

/// A height and a friction in a region.
fn within(region: &Region, ranges: Ranges, draw: &mut Draw) -> [f64; 2] {
    let value = |k: usize, unit: f64| {
        let share = region.low[k] + unit * (region.high[k] - region.low[k]);
        ranges[k][0] + share * (ranges[k][1] - ranges[k][0])
    };
    [value(0, draw.unit()), value(1, draw.unit())]
}

/// Three contacts can hold a robot; those on fewer do, rarely, and are tried by simulation.
#[test]
fn what_is_certified_has_no_jam_with_ground_inside_the_track() {
    let mut draw = Draw(99);
    let (mut regions, mut tipping) = (0, 0);
    for case in 0..few_or_many(8, 600) {
        let (scenario, ranges) = drawn(&mut draw);
        for region in certificate(&scenario, ranges).regions {
            if !matches!(region.status, RegionStatus::Certified(_)) {
                continue;
            }
            regions += 1;
            for _ in 0..3 {
                let [height, friction] = within(&region, ranges, &mut draw);
                let member = checked(&at(&scenario, height, friction));
                let found = find_jams(&member, &Cancel::default()).expect("its jams are known");
                for jam in found {
                    // The ground inside is measured from 0.1 mm within the belt.
                    let depth = jam.intrusion.as_ref().map_or(0.0, |inside| inside.depth);
                    if depth < EFFORT.depth + 2e-4 {
                        continue;
                    }
                    tipping += 1;
                    let bearing = jam.jam.contacts.iter().filter(|c| c.load > 1e-6).count();
                    assert!(bearing < 3 && !jam.stable, "case {case}: {jam:?}");
                }
            }
        }
    }
    println!("{regions} regions, {tipping} poses in which it tips");
    assert!(regions > few_or_many(5, 300), "{regions}");
    assert!(tipping > few_or_many(20, 1_500), "{tipping}");
}

#[test]
fn where_it_is_as_a_belt_a_belt_can_jam() {
    let scenario = engineer_on(line(5));
    let ranges = [[0.02, 0.15], [0.4, 1.2]];
    let mut draw = Draw(5);
    let mut regions = 0;
    for region in certificate(&scenario, ranges).regions {
        if !matches!(region.status, RegionStatus::AsBelt) {
            continue;
        }
        regions += 1;
        for _ in 0..4 {
            let [height, friction] = within(&region, ranges, &mut draw);
            let member = checked(&at(&with_belt(&scenario), height, friction));
            let found = find_jams(&member, &Cancel::default()).expect("its jams are known");
            assert!(found.iter().any(|jam| jam.jam.contacts.len() == 3));
        }
    }
    assert!(regions > 0);
}

#[test]
fn regions_and_their_cells_cover_everything_once() {
    let scenario = engineer_on(line(7));
    let found = certificate(&scenario, [[0.02, 0.15], [0.4, 1.2]]);
    let size = |low: &[f64], high: &[f64]| -> f64 {
        low.iter().zip(high).map(|(low, high)| high - low).product()
    };
    let all: f64 = found.regions.iter().map(|r| size(&r.low, &r.high)).sum();
    assert!((all - 1.0).abs() < 1e-12, "{all}");
    let mut cells = found.cells.iter();
    let mut poses = None;
    for region in &found.regions {
        let RegionStatus::Certified(count) = region.status else {
            continue;
        };
        let volume = |cell: &ExcludedCell| size(&cell.low[..5], &cell.high[..5]);
        let sum: f64 = cells.by_ref().take(count).map(volume).sum();
        let here = sum / size(&region.low, &region.high);
        let first = *poses.get_or_insert(here);
        assert!((here / first - 1.0).abs() < 1e-9, "{here} {first}");
    }
    assert!(cells.next().is_none() && poses.is_some());
}

/// Every kind of exclusion is needed, and used.
#[test]
fn cells_are_excluded_for_five_reasons() {
    let mut scenario = engineer_on(line(7));
    scenario.robot.belly = None;
    let found = certificate(&scenario, [[0.05, 0.06], [0.5, 0.9]]);
    for exclusion in [
        Exclusion::Apart,
        Exclusion::Overlap,
        Exclusion::Belt,
        Exclusion::Unbalanced,
        Exclusion::Tips,
    ] {
        let is_it = |cell: &&ExcludedCell| cell.exclusion == exclusion;
        assert!(found.cells.iter().any(|cell| is_it(&cell)), "{exclusion:?}");
    }
}

#[test]
fn what_changes_the_outline_is_no_parameter() {
    let wheels = |radius: f64| {
        let mut scenario = engineer_on(line(5));
        if let Track::Line(wheels) = &mut scenario.robot.track {
            wheels.wheel_radius = Some(radius);
        }
        checked(&scenario)
    };
    let all: Vec<ValidScenario> = [0.040, 0.042, 0.042, 0.041].map(wheels).into();
    let names = ["robot.track.wheel_radius".to_owned()];
    match certify(&all, &all, &names, EFFORT, &Cancel::default()) {
        Err(crawler2d_core::Error::Scenario(error)) => {
            assert_eq!(
                (error.path.as_str(), error.value.as_str()),
                ("over", "robot.track.wheel_radius")
            );
        }
        other => panic!("{other:?}"),
    }
}

//! Legal scenarios anywhere in the space of robots, track models, grounds and settings.

use crawler2d_core::{
    ChainMechanism, CircumferentialWheels, Climb, Drive, Ends, FieldPattern, Flippers, Friction,
    Gait, GearWheel, Ground, GrouserBeltTrack, Hold, HybridWheels, Robot, Scenario, SegmentalTrack,
    ShoeShape, Stepfield, Surface, Terrain, TorqueSharing, Track, TrackOutline, ValidScenario,
    Wheel,
};

use crate::common::*;

fn drawn_track(draw: &mut Draw, outline: &TrackOutline) -> Track {
    let smallest = outline.smallest_radius();
    let wheel = if draw.unit() < 0.5 {
        Wheel::Round
    } else {
        Wheel::Gear(GearWheel {
            grouser_count: Some(3 + (draw.unit() * 15.0) as u32),
            grouser_height: Some(draw.between(0.02, 0.09) * smallest),
            tip_thickness: Some(0.01 * smallest),
            // 17 grousers fit on the smallest root circle.
            base_thickness: Some(draw.between(0.01, 0.03) * smallest),
            phase_fraction: draw.unit(),
        })
    };
    match (draw.unit() * 10.0) as u32 {
        0 => belt(),
        1 => force(),
        2 => force_on_wheels(),
        8 => Track::GrouserBelt(GrouserBeltTrack {
            grouser_count: (draw.unit() < 0.5).then(|| 1 + (draw.unit() * 12.0) as u32),
        }),
        9 => drawn_chain(draw, outline),
        3 => Track::Circumferential(CircumferentialWheels {
            count: 3 + (draw.unit() * 30.0) as u32,
            wheel_radius: Some(draw.between(0.25, 0.9) * smallest),
            wheel,
        }),
        4 => {
            let mut placed = || {
                let (x, y) = (draw.between(-0.5, 0.5), draw.between(-0.3, 0.3));
                [
                    x * outline.axle_distance(),
                    y * smallest,
                    draw.between(0.25, 1.0) * smallest, // smaller ones turn too far in a step
                ]
            };
            let placements = (0..5).map(|_| placed()).collect();
            Track::Hybrid(HybridWheels { placements, wheel })
        }
        _ => line_of(2 + (draw.unit() * 10.0) as u32, wheel),
    }
}

/// A chain on a guide or on wheels, with shoes that are short enough to go round the smaller end.
fn drawn_chain(draw: &mut Draw, outline: &TrackOutline) -> Track {
    let radii = [outline.front_radius(), outline.rear_radius()].map(|r| r - outline.grouser_height);
    let [smaller, larger] = [radii[0].min(radii[1]), radii[0].max(radii[1])];
    let around = 2.0 * outline.axle_distance() + std::f64::consts::TAU * larger;
    let fewest = 1.2 * around / (2.0 * smaller).min(0.5 * outline.axle_distance());
    let mechanism = if draw.unit() < 0.5 {
        ChainMechanism::Guide
    } else {
        ChainMechanism::Sprocket
    };
    let mut wheels = || {
        let given = mechanism == ChainMechanism::Sprocket && draw.unit() < 0.3;
        given.then(|| (draw.unit() * 12.0) as u32)
    };
    let [road_wheel_count, return_roller_count] = [wheels(), wheels()];
    Track::Segmental(SegmentalTrack {
        shoe_count: Some(draw.between(fewest + 1.0, fewest + 25.0) as u32),
        mechanism,
        shoe_shape: if draw.unit() < 0.5 {
            ShoeShape::Rectangle
        } else {
            ShoeShape::Trapezoid
        },
        plate_thickness: None,
        pre_tension: None,
        tensioner_stiffness: None,
        tensioner_damping: None,
        pin_stiffness: 0.0,
        pin_damping: 0.0,
        road_wheel_count,
        return_roller_count,
    })
}

/// Arms that leave a chassis, with tracks of their own where the robot's do not suit every arm.
fn drawn_flippers(draw: &mut Draw, robot: &Robot) -> Flippers {
    let outline = &robot.outline;
    let smallest = outline.smallest_radius();
    let suits = !matches!(robot.track, Track::Circumferential(_) | Track::Hybrid(_));
    let own = !matches!(robot.track, Track::Force(_)) && (!suits || draw.unit() < 0.3);
    let kinds = match robot.drivetrain.torque_sharing {
        TorqueSharing::Wheel => 1.0,
        TorqueSharing::Track => 3.0,
    };
    Flippers {
        length: draw.between(0.3, 0.9) * outline.axle_distance(),
        root_radius: draw.between(0.6, 1.0) * smallest,
        tip_radius: draw.between(0.5, 1.0) * smallest,
        mass: draw.between(0.001, 0.03) * robot.mass,
        ends: [Ends::Front, Ends::Rear, Ends::Both][(draw.unit() * 3.0) as usize],
        angle: draw.between(-1.5, 3.0),
        rate_limit: libm::exp(draw.between(-2.0, 2.0)),
        // From a hundredth of what lifts the robot to ten times that.
        torque_limit: libm::exp(draw.between(-4.0, 2.0)) * robot.mass * G * outline.axle_distance(),
        rotor_inertia: 0.0,
        self_locking: false,
        track: own.then(|| match (draw.unit() * kinds) as u32 {
            0 => line_of(2 + (draw.unit() * 5.0) as u32, Wheel::Round),
            1 => belt(),
            _ => grouser_belt(),
        }),
    }
}

/// Commands by the clock, and for the flippers also by what the driver sees.
fn drawn_drive(draw: &mut Draw, has_flippers: bool) -> Drive {
    let mut later = |low, high| -> Option<Vec<[f64; 2]>> {
        let some = draw.unit() < 0.3;
        some.then(|| {
            let mut time = 0.0;
            let rows = 0..1 + (draw.unit() * 4.0) as u32;
            rows.map(|_| {
                time += draw.between(0.05, 0.8);
                [time, draw.between(low, high)]
            })
            .collect()
        })
    };
    let (speeds, angles) = (later(-1.3, 1.3), later(-1.5, 3.0));
    Drive {
        speed: draw.between(-1.3, 1.3),
        schedule: speeds,
        gait: (has_flippers && draw.unit() < 0.8).then(|| {
            if draw.unit() < 0.5 {
                Gait::Hold(Hold {
                    angle: draw.between(-1.5, 3.0),
                    schedule: angles,
                    front: None,
                    rear: None,
                })
            } else {
                Gait::Climb(Climb {
                    reach_angle: draw.between(-0.5, 2.0),
                    sweep_angle: draw.between(-1.0, 0.5),
                    push_angle: draw.between(-1.5, 0.5),
                    level_angle: draw.between(0.01, 0.5),
                })
            }
        }),
    }
}

/// The same ground under both tracks, or one under each.
fn drawn_terrain(draw: &mut Draw) -> Terrain {
    let seed = (draw.unit() * 1e6) as u32;
    match (draw.unit() * 8.0) as u32 {
        0 => Terrain::DiagonalBarrier {
            yaw: draw.between(-1.3, 1.3),
            height: draw.between(0.01, 0.3),
            thickness: draw.between(0.01, 0.3),
            surface: Surface::sharp(draw.between(0.0, 2.0)),
        },
        1 => Terrain::RandomStepfield(Stepfield {
            seed,
            pattern: [
                FieldPattern::Flat,
                FieldPattern::Hill,
                FieldPattern::Diagonal,
            ][seed as usize % 3],
            posts: 1 + seed % 12,
            post: draw.between(0.05, 0.4),
            rise: draw.between(0.005, 0.1),
            levels: 1 + seed % 5,
            barrier_height: draw.between(-0.2, 0.3).max(0.0),
            barrier_thickness: draw.between(0.01, 0.3),
            barrier_yaw: draw.between(-1.0, 1.0),
            surface: Surface::sharp(draw.between(0.0, 2.0)),
        }),
        2 => drawn_lanes(draw, seed.is_multiple_of(2)),
        _ => drawn_lane(draw),
    }
}

fn drawn_lanes(draw: &mut Draw, has_middle: bool) -> Terrain {
    loop {
        let lanes = Terrain::Lanes {
            left: Box::new(drawn_lane(draw)),
            right: Box::new(drawn_lane(draw)),
            middle: has_middle.then(|| Box::new(drawn_lane(draw))),
        };
        // The goal of one may be beyond the end of another.
        if Ground::new(&lanes, engineer().robot.gauge).is_ok() {
            return lanes;
        }
    }
}

fn drawn_lane(draw: &mut Draw) -> Terrain {
    let (friction, height, edge_radius) = (draw.between(0.0, 2.0), draw.between(0.01, 0.5), 0.0);
    match (draw.unit() * 10.0) as u32 {
        0 | 1 => step(height, friction),
        2 => Terrain::Ramp {
            angle: draw.between(-1.2, 1.2),
            length: draw.between(0.05, 2.0),
            surface: Surface::rounded(edge_radius, friction),
        },
        3 => Terrain::Barrier {
            height,
            thickness: draw.between(0.005, 0.5),
            surface: Surface::rounded(0.002, friction),
        },
        4 => Terrain::Ridge {
            height,
            edge_angle: draw.between(0.2, 3.0),
            surface: Surface::rounded(edge_radius, friction),
        },
        5 => Terrain::Gap {
            width: draw.between(0.02, 1.0),
            depth: height,
            surface: Surface::rounded(edge_radius, friction),
        },
        6 => Terrain::HalfRound {
            radius: height,
            friction: Friction::dry(friction),
        },
        _ => {
            let (mut x, mut points) = (0.0, vec![[-10.0, 0.0], [0.0, 0.0]]);
            for _ in 0..12 {
                let y = draw.between(-0.2, 0.2);
                points.push([x, y]);
                x += draw.between(0.02, 0.4);
                points.push([x, y]);
            }
            points.push([x + 10.0, 0.0]);
            Terrain::Points {
                points,
                goal: x,
                surface: Surface::rounded(edge_radius, friction),
                segment_friction: None,
            }
        }
    }
}

/// A legal scenario anywhere in the space of robots, grounds and settings, on two discs.
pub(crate) fn drawn(draw: &mut Draw) -> Scenario {
    drawn_round(draw, drawn_ends)
}

/// The same on three to six discs; the model is one that goes round them.
pub(crate) fn drawn_on_discs(draw: &mut Draw) -> Scenario {
    loop {
        let mut scenario = drawn_round(draw, drawn_discs);
        let track = &mut scenario.robot.track;
        match track {
            Track::Line(_) => *track = grouser_belt(),
            Track::Force(_) => *track = force(),
            Track::Segmental(chain) => {
                chain.mechanism = ChainMechanism::Guide;
                (chain.road_wheel_count, chain.return_roller_count) = (None, None);
            }
            _ => {}
        }
        if matches!(track, Track::GrouserBelt(_)) {
            scenario.robot.drivetrain.torque_sharing = TorqueSharing::Track;
        }
        // A disc may lie within the others, and a shoe be too long for a short run.
        if ValidScenario::new(&scenario).is_ok() {
            return scenario;
        }
    }
}

fn drawn_ends(draw: &mut Draw) -> Vec<[f64; 3]> {
    let axle_distance = draw.between(0.1, 1.5);
    let front_radius = draw.between(0.1, 0.45) * axle_distance;
    let rear_radius = if draw.unit() < 0.5 {
        front_radius
    } else {
        draw.between(0.1, 0.45) * axle_distance
    };
    TrackOutline::two_discs(axle_distance, [rear_radius, front_radius])
}

/// Ends at any height, discs between them below and perhaps one above, in any order.
fn drawn_discs(draw: &mut Draw) -> Vec<[f64; 3]> {
    let length = draw.between(0.1, 1.5);
    let mut disc = |x: [f64; 2], y: [f64; 2]| {
        let place = [draw.between(x[0], x[1]), draw.between(y[0], y[1])];
        [place[0], place[1], draw.between(0.08, 0.25)].map(|part| part * length)
    };
    let mut discs = vec![
        disc([-0.15, 0.0], [-0.25, 0.0]),
        disc([-0.6, -0.5], [-0.1, 0.4]),
        disc([0.5, 0.6], [-0.1, 0.4]),
        disc([0.1, 0.35], [-0.25, 0.0]),
        disc([-0.35, -0.2], [-0.2, 0.0]),
        disc([-0.2, 0.2], [0.4, 0.8]),
    ];
    discs.truncate(3 + (draw.unit() * 4.0) as usize);
    discs
}

fn drawn_round(draw: &mut Draw, discs: fn(&mut Draw) -> Vec<[f64; 3]>) -> Scenario {
    let mut s = engineer();
    let r = &mut s.robot;
    r.outline.discs = discs(draw);
    let (axle_distance, smallest) = (r.outline.axle_distance(), r.outline.smallest_radius());
    r.outline.grouser_height = draw.between(0.0, 0.3) * smallest;
    r.mass = libm::exp(draw.between(0.0, 6.0));
    r.track_mass = draw.between(0.01, 0.3) * r.mass;
    r.moment_of_inertia = draw.between(0.35, 1.0) * r.mass * axle_distance.powi(2);
    r.center_of_mass = [
        draw.between(-0.3, 0.3) * axle_distance,
        draw.between(-0.1, 0.3) * axle_distance,
    ];
    let (half, low) = (0.5 * axle_distance, -draw.between(0.0, 0.9) * smallest);
    r.belly = (draw.unit() < 0.5).then(|| {
        vec![
            [-half, low],
            [half, low],
            [half, smallest],
            [-half, smallest],
        ]
    });
    // From a hundredth of the weight to seven times the weight in traction.
    r.drivetrain.max_torque = libm::exp(draw.between(-4.0, 2.0)) * 0.5 * r.mass * G * smallest;
    r.drivetrain.max_acceleration = libm::exp(draw.between(-3.0, 3.0));
    r.track = drawn_track(draw, &r.outline);
    if matches!(r.track, Track::Segmental(_)) {
        // Of sixty shoes each is to weigh a three-thousandth of the rest.
        r.track_mass = r.track_mass.max(0.03 * r.mass);
    }
    let driven = !matches!(
        r.track,
        Track::Belt(_) | Track::GrouserBelt(_) | Track::Segmental(_) | Track::Force(_)
    );
    if driven && draw.unit() < 0.5 {
        r.drivetrain.torque_sharing = TorqueSharing::Wheel;
    }
    r.flippers = (draw.unit() < 0.4).then(|| drawn_flippers(draw, r));
    s.drive = drawn_drive(draw, s.robot.flippers.is_some());
    s.terrain = drawn_terrain(draw);
    s.gravity = if draw.unit() < 0.05 {
        0.0
    } else {
        draw.between(0.5, 20.0)
    };
    s.duration = 2.0;
    s
}

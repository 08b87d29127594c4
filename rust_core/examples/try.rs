use crawler2d_core::*;
fn main() {
    let text = std::fs::read_to_string("tests/scenarios/engineer_belt_step.json").unwrap();
    let s = Scenario::from_json(&text).unwrap();
    for (it, freq, dt, sp, ax) in [
        (8, 120., 1e-3, 0.005, 20.),
        (200, 120., 1e-3, 0.005, 20.),
        (200, 480., 1e-3, 0.005, 20.),
        (200, 120., 2.5e-4, 0.005, 20.),
        (200, 120., 1e-3, 0.002, 20.),
        (50, 120., 1e-3, 0.005, 90.),
    ] {
        let mu: f64 = 0.4;
        let e = 0.064 * (1. - 1. / (1. + mu * mu).sqrt());
        let (mut lo, mut hi) = (e * 0.8, e * 1.2);
        while hi - lo > 1e-6 {
            let m = 0.5 * (lo + hi);
            let mut c = s.clone();
            c.robot.belly = None;
            c.robot.drivetrain.max_torque = 100.;
            c.robot.drivetrain.max_acceleration = 1.0;
            c.robot.outline.axle_distance = ax;
            c.robot.outline.grouser_height = 0.;
            c.robot.drivetrain.torque_sharing = TorqueSharing::Wheel;
            c.robot.center_of_mass = [ax / 2., 0.];
            c.robot.moment_of_inertia = 100.;
            c.robot.track_mass = 0.1;
            c.terrain = Terrain::Step {
                height: m,
                edge_radius: 0.,
                friction: mu,
            };
            c.robot.track = Track::Line(LineOfWheels {
                count: 2,
                wheel_radius: None,
                wheel: Wheel::Round,
            });
            c.drive.speed = sp;
            c.start.approach = 0.0;
            c.duration = 20. * 0.005 / sp;
            c.solver.time_step = dt;
            c.solver.iterations = it;
            c.solver.contact_frequency = freq;
            if simulate(&c, Record::summary()).unwrap().metrics.final_y > 0.064 + 0.45 * m {
                lo = m
            } else {
                hi = m
            }
        }
        println!(
            "v it {it} freq {freq} dt {dt} sp {sp} ax {ax}: {:+.2} %",
            (lo / e - 1.) * 100.
        );
    }
}

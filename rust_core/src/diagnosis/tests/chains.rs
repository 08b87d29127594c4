//! Motion of shoes of a chain where they bear, and when they pinch the ground.

use super::*;
use crate::scenario::shared;

/// The same stage with the Engineer on a chain of shoes.
fn on_a_chain() -> Stage {
    let mut stage = Stage::new();
    stage.scenario = shared("engineer_chain_step");
    stage.model = Model::on(&stage.scenario.robot, &stage.ground).expect("it can be built");
    stage
}

/// The part that is the plate of a shoe.
fn plate(stage: &Stage, shoe: usize) -> usize {
    let is_plate = |part: &Part| part.kind == BodyKind::Shoe && part.mount == Mount::Shoe(shoe);
    let plate = stage.model.parts.iter().position(is_plate);
    plate.expect("each shoe has one")
}

/// Driving forwards, shoes run rearwards below and turn with the front end; a contact that now belongs to another shoe
/// moves like that one.
#[test]
fn a_shoe_moves_as_the_chain_runs_where_its_contact_is() {
    let stage = on_a_chain();
    let scene = stage.scene();
    let shoes = &scene.running.shoes;
    let chain = &stage.model.chains[0];
    let [_, front] = chain.ends;
    let (mut below, mut round) = (0, 0);
    for (shoe, pose) in shoes.iter().enumerate() {
        let at = pose.translation;
        let motion = scene.motion(plate(&stage, shoe), at).at(at);
        let arm = at - front.center;
        if at.y < 0.0 && at.x.abs() < 0.1 {
            below += 1;
            assert!(
                (motion - Vector::new(-1.0, 0.0)).length() < 1e-9,
                "{motion}"
            );
        } else if arm.x > 0.5 * front.radius {
            round += 1;
            // The chord over two pitches is a little shorter than the arc.
            let along = -crate::geometry::left_of(arm).normalize();
            assert!((motion - along).length() < 0.25, "{motion} for {along}");
        }
        let other = (shoe + 7) % shoes.len();
        assert_eq!(scene.motion(plate(&stage, other), at).at(at), motion);
    }
    assert!(below > 2 && round > 0);
}

/// Two shoes that bear at once on ground inside the track pinch it where the gap between them closes.
#[test]
fn neighbouring_shoes_pinch_at_the_leading_end() {
    let mut stage = on_a_chain();
    let shoes = stage.scene().running.shoes.clone();
    let count = shoes.len();
    let bend = |shoe: usize| {
        let next = shoes[(shoe + 1) % count];
        (shoes[shoe].rotation.inverse() * next.rotation)
            .angle()
            .abs()
    };
    let middle =
        |shoe: usize| 0.5 * (shoes[shoe].translation.x + shoes[(shoe + 1) % count].translation.x);
    let any = |is: &dyn Fn(usize) -> bool| (0..count).find(|shoe| is(*shoe)).expect("there is one");
    let front = any(&|shoe| bend(shoe) > 0.5 && middle(shoe) > 0.0);
    let rear = any(&|shoe| bend(shoe) > 0.5 && middle(shoe) < 0.0);
    let straight = any(&|shoe| bend(shoe) < 1e-3 && middle(shoe) > 0.05);
    for (shoe, speed, durations, pinched) in [
        (front, 0.4, [0.6, 0.6], true),
        (rear, -0.4, [0.6, 0.6], true),
        (front, -0.4, [0.6, 0.6], false),
        (rear, 0.4, [0.6, 0.6], false),
        (straight, 0.4, [0.6, 0.6], false),
        (front, 0.4, [0.6, 0.4], false),
    ] {
        stage.scenario.drive.speed = speed;
        let mut stance = stage.stance([0.5, 0.5]);
        let both = [shoe, (shoe + 1) % count];
        for (i, bearing) in stance.bearings.iter_mut().enumerate() {
            bearing.contact.part = plate(&stage, both[i]);
            bearing.duration = durations[i];
        }
        let scene = stage.scene();
        let mut contacts = scene.facts(&stance, None).contacts;
        assert!(!scene.pinches(&stance, &contacts));
        for contact in &mut contacts {
            contact.in_pocket = true;
        }
        assert_eq!(
            scene.pinches(&stance, &contacts),
            pinched,
            "{both:?}, {speed} m/s"
        );
    }
}
